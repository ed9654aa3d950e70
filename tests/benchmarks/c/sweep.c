/* The limit for a curve: RK4 in w with a fixed step, WIDTH scenes per register, BLOCKS registers side by side.
 *
 * Every lane is one drive frequency with its own step and number of steps. A lane that has run its periods takes the
 * next frequency, the longest period first. HARD of the N + 1 contacts use the square-root unit, and the others an
 * approximate inverse root with Newton steps on the multipliers, so that both units are busy at once.
 * Compiled with -DWIDTH=… (8: AVX-512, 4: AVX2) -DN=… -DBLOCKS=… -DHARD=…
 */
#include <immintrin.h>
#include <math.h>
#include <string.h>

#if WIDTH == 8
typedef __m512d V;
#define OP(name) _mm512_##name##_pd
#define NEWTON_STEPS 1
#define LEAST 1e-100 /* 0 has no inverse root; this adds 1e-150 to a force */
static inline V inverse_root(V x) { return _mm512_rsqrt14_pd(x); }
static inline unsigned greater(V a, V b) { return _mm512_cmp_pd_mask(a, b, _CMP_GT_OQ); }
static inline unsigned not_less(V a, V b) { return _mm512_cmp_pd_mask(a, b, _CMP_GE_OQ); }
#else
typedef __m256d V;
#define OP(name) _mm256_##name##_pd
#define NEWTON_STEPS 2 /* starting from 12 bits */
#define LEAST 1e-30    /* within the range of a float; this adds 1e-45 to a force */
static inline V inverse_root(V x) { return _mm256_cvtps_pd(_mm_rsqrt_ps(_mm256_cvtpd_ps(x))); }
static inline unsigned greater(V a, V b) { return _mm256_movemask_pd(_mm256_cmp_pd(a, b, _CMP_GT_OQ)); }
static inline unsigned not_less(V a, V b) { return _mm256_movemask_pd(_mm256_cmp_pd(a, b, _CMP_GE_OQ)); }
#endif
#define V1(x) OP(set1)(x)
#define FMA(a, b, c) OP(fmadd)(a, b, c)
#define FNMA(a, b, c) OP(fnmadd)(a, b, c)

/* State of one register of scenes; u[N] is the wall. */
typedef struct {
    V u[N + 1], w[N], sine, cosine, turn_c, turn_s, h;
    V e4[5], top; /* the last five output forces, newest first, and the largest */
} Block;

static inline __attribute__((always_inline)) V power(V d, int hard) {
    if (hard) return OP(mul)(d, OP(sqrt)(d));
    V x = OP(max)(d, V1(LEAST)), r = inverse_root(x);
    for (int i = 0; i + 1 < NEWTON_STEPS; i++)
        r = OP(mul)(r, FNMA(OP(mul)(OP(mul)(V1(0.5), x), r), r, V1(1.5)));
    V a = OP(mul)(x, r); /* the last Newton step is done on the root itself */
    return OP(mul)(OP(mul)(x, a), FNMA(OP(mul)(V1(0.5), a), r, V1(1.5)));
}

/* One stage: slope at (u, w). The first stage sets acc = s + share·slope, later ones add to acc; out = s + ahead·slope
 * unless it is the last. */
static inline __attribute__((always_inline)) V stage(const V *restrict u, const V *restrict w, const V *su,
                                                     const V *sw, V *restrict ou, V *restrict ow, V *restrict au,
                                                     V *restrict aw, V driver, V lambda, V ahead, V share,
                                                     const int number) {
    const V zero = OP(setzero)();
    V here = u[0];
    V d_left = OP(max)(OP(sub)(driver, here), zero);
    V e_left = power(d_left, HARD > 0);
#pragma GCC unroll 64
    for (int i = 0; i < N; i++) {
        V right = i + 1 < N ? u[i + 1] : zero;
        V d = OP(max)(OP(sub)(here, right), zero);
        /* spread the contacts with the square-root unit evenly */
        V e = power(d, ((i + 1) * HARD) / (N + 1) != ((i + 2) * HARD) / (N + 1));
        V du = FMA(lambda, OP(sub)(d_left, d), w[i]);
        V dw = OP(sub)(e_left, e);
        if (number == 0) {
            au[i] = FMA(share, du, su[i]), aw[i] = FMA(share, dw, sw[i]);
        } else {
            au[i] = FMA(share, du, au[i]), aw[i] = FMA(share, dw, aw[i]);
        }
        if (number < 3) ou[i] = FMA(ahead, du, su[i]), ow[i] = FMA(ahead, dw, sw[i]);
        here = right, d_left = d, e_left = e;
    }
    return e_left;
}

static inline __attribute__((always_inline)) void advance(Block *b, V lambda, V *e_out) {
    V mu[N], mw[N], nu[N], nw[N], au[N], aw[N];
    const V half = OP(mul)(b->h, V1(0.5)), sixth = OP(mul)(b->h, V1(1.0 / 6.0));
    const V third = OP(mul)(b->h, V1(1.0 / 3.0));
    V s = b->sine, c = b->cosine;
    V sm = FMA(s, b->turn_c, OP(mul)(c, b->turn_s)), cm = FNMA(s, b->turn_s, OP(mul)(c, b->turn_c));
    V se = FMA(sm, b->turn_c, OP(mul)(cm, b->turn_s)), ce = FNMA(sm, b->turn_s, OP(mul)(cm, b->turn_c));
    *e_out = stage(b->u, b->w, b->u, b->w, mu, mw, au, aw, s, lambda, half, sixth, 0);
    stage(mu, mw, b->u, b->w, nu, nw, au, aw, sm, lambda, half, third, 1);
    stage(nu, nw, b->u, b->w, mu, mw, au, aw, sm, lambda, b->h, third, 2);
    stage(mu, mw, b->u, b->w, nu, nw, au, aw, se, lambda, b->h, sixth, 3);
#pragma GCC unroll 64
    for (int i = 0; i < N; i++) b->u[i] = au[i], b->w[i] = aw[i];
    b->sine = se, b->cosine = ce;
}

/* The top of the quartic through five values around a maximum c > b, c >= d, after two Newton steps. */
static inline V quartic(V a, V b, V c, V d, V e) {
    V first = OP(mul)(FMA(V1(8.0), OP(sub)(d, b), OP(sub)(a, e)), V1(1.0 / 12.0));
    V second = OP(mul)(FMA(V1(16.0), OP(add)(b, d), FNMA(V1(30.0), c, -(a + e))), V1(1.0 / 12.0));
    V third = FMA(V1(0.5), e - a, b - d), fourth = a + e + 6.0 * c - 4.0 * (b + d);
    V x = -first / second;
    x -= (first + x * (second + x * (0.5 * third + x * fourth * (1.0 / 6.0)))) /
         (second + x * (third + x * 0.5 * fourth));
    return c + x * (first + x * (0.5 * second + x * (third * (1.0 / 6.0) + x * fourth * (1.0 / 24.0))));
}

static inline __attribute__((always_inline)) void watch(Block *b, V e) {
    V a0 = b->e4[3], b0 = b->e4[2], c0 = b->e4[1], d0 = b->e4[0];
    unsigned top = greater(c0, b0) & not_less(c0, d0) & greater(c0, b->top);
    if (top) { /* rare: the top is needed only for a new largest value */
        V best = OP(max)(quartic(a0, b0, c0, d0, e), c0);
        for (int k = 0; k < WIDTH; k++)
            if (top >> k & 1) b->top[k] = best[k] > b->top[k] ? best[k] : b->top[k];
    }
    b->e4[3] = b0, b->e4[2] = c0, b->e4[1] = d0, b->e4[0] = e;
}

/* Peaks of `count` scenes, each with its beta and steps per period: `passed` periods are run, then `watched` more over
 * which the peak is found. Scenes must be sorted, longest first. Returns the number of register steps. */
long sweep(int count, const double *beta, const long *steps, int passed, int watched, double lambda, double *peak) {
    enum { LANES = WIDTH * BLOCKS };
    static Block block[BLOCKS];
    long left[LANES], taken = 0;
    int scene[LANES], watching[LANES], next = 0, running = 0;
    unsigned before = _mm_getcsr();
    _mm_setcsr(before | 0x8040); /* flush subnormals: the wave front ahead of the first pulse consists of them */
    memset(block, 0, sizeof block);
    const V lam = V1(lambda);
    for (int l = 0; l < LANES; l++) scene[l] = -1, left[l] = 0, watching[l] = 1;
    for (;;) {
        for (int l = 0; l < LANES; l++) {
            if (left[l] > 0) continue;
            Block *b = &block[l / WIDTH];
            int k = l % WIDTH;
            if (scene[l] >= 0 && !watching[l]) {
                watching[l] = 1, left[l] = (long)watched * steps[scene[l]], ((double *)&b->top)[k] = 0.0;
                continue;
            }
            if (scene[l] >= 0) peak[scene[l]] = ((double *)&b->top)[k], running--;
            scene[l] = next < count ? next++ : -1;
            for (int i = 0; i < N; i++) ((double *)&b->u[i])[k] = ((double *)&b->w[i])[k] = 0.0;
            for (int i = 0; i < 5; i++) ((double *)&b->e4[i])[k] = 0.0;
            int on = scene[l] >= 0;
            double n = on ? (double)steps[scene[l]] : 1.0, rate = on ? beta[scene[l]] : 1.0;
            ((double *)&b->sine)[k] = 0.0, ((double *)&b->cosine)[k] = 1.0;
            ((double *)&b->turn_c)[k] = cos(M_PI / n), ((double *)&b->turn_s)[k] = sin(M_PI / n);
            ((double *)&b->h)[k] = on ? 2.0 * M_PI / (rate * n) : 0.0;
            ((double *)&b->top)[k] = on ? 1e300 : 0.0; /* no peak is found before the watched periods */
            watching[l] = !on, left[l] = on ? (long)passed * steps[scene[l]] : 1L << 60;
            running += on;
        }
        if (!running) break;
        long least = left[0];
        for (int l = 1; l < LANES; l++) least = left[l] < least ? left[l] : least;
        for (long s = 0; s < least; s++) {
            V e[BLOCKS];
#pragma GCC unroll 4
            for (int q = 0; q < BLOCKS; q++) advance(&block[q], lam, &e[q]);
#pragma GCC unroll 4
            for (int q = 0; q < BLOCKS; q++) watch(&block[q], e[q]);
        }
        for (int l = 0; l < LANES; l++) left[l] -= least;
        taken += least;
    }
    _mm_setcsr(before);
    return taken * BLOCKS;
}

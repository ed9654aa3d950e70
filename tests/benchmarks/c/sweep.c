/* The limit for a curve: RK4 in w with a fixed step, eight scenes a register, BLOCKS registers side by side.
 *
 * Every lane is one drive frequency with its own step and number of steps; a lane that has run its periods is filled
 * with the next frequency, the longest first. HARD of the N + 1 contacts take the square root of the square-root
 * unit, the others rsqrt14 with one Newton step on the multipliers, so that both are busy at once.
 * Compiled with -DN=… -DBLOCKS=… -DHARD=…
 */
#include <immintrin.h>
#include <math.h>
#include <string.h>

typedef __m512d V;
#define V1(x) _mm512_set1_pd(x)
#define FMA(a, b, c) _mm512_fmadd_pd(a, b, c)
#define FNMA(a, b, c) _mm512_fnmadd_pd(a, b, c)

/* State of one register of scenes; u[N] is the wall. */
typedef struct {
    V u[N + 1], w[N], sine, cosine, turn_c, turn_s, h;
    V e4[5], top; /* the last five output forces, newest first, and the largest */
} Block;

static inline __attribute__((always_inline)) V power(V d, int hard) {
    if (hard) return _mm512_mul_pd(d, _mm512_sqrt_pd(d));
    V x = _mm512_max_pd(d, V1(1e-100)); /* 0 has no inverse root; what this adds is 1e-150 */
    V r = _mm512_rsqrt14_pd(x);
    V a = _mm512_mul_pd(x, r);
    return _mm512_mul_pd(_mm512_mul_pd(x, a), FNMA(_mm512_mul_pd(V1(0.5), a), r, V1(1.5)));
}

/* One stage: slope at (u, w); first: acc = s + share·slope; else acc += …; out = s + ahead·slope unless last. */
static inline __attribute__((always_inline)) V stage(const V *restrict u, const V *restrict w, const V *su,
                                                     const V *sw, V *restrict ou, V *restrict ow, V *restrict au,
                                                     V *restrict aw, V driver, V lambda, V ahead, V share,
                                                     const int number) {
    const V zero = _mm512_setzero_pd();
    V here = u[0];
    V d_left = _mm512_max_pd(_mm512_sub_pd(driver, here), zero);
    V e_left = power(d_left, HARD > 0);
#pragma GCC unroll 64
    for (int i = 0; i < N; i++) {
        V right = i + 1 < N ? u[i + 1] : zero;
        V d = _mm512_max_pd(_mm512_sub_pd(here, right), zero);
        /* spread the hard ones evenly */
        V e = power(d, ((i + 1) * HARD) / (N + 1) != ((i + 2) * HARD) / (N + 1));
        V du = FMA(lambda, _mm512_sub_pd(d_left, d), w[i]);
        V dw = _mm512_sub_pd(e_left, e);
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
    const V half = _mm512_mul_pd(b->h, V1(0.5)), sixth = _mm512_mul_pd(b->h, V1(1.0 / 6.0));
    const V third = _mm512_mul_pd(b->h, V1(1.0 / 3.0));
    V s = b->sine, c = b->cosine;
    V sm = FMA(s, b->turn_c, _mm512_mul_pd(c, b->turn_s)), cm = FNMA(s, b->turn_s, _mm512_mul_pd(c, b->turn_c));
    V se = FMA(sm, b->turn_c, _mm512_mul_pd(cm, b->turn_s)), ce = FNMA(sm, b->turn_s, _mm512_mul_pd(cm, b->turn_c));
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
    V first = _mm512_mul_pd(FMA(V1(8.0), _mm512_sub_pd(d, b), _mm512_sub_pd(a, e)), V1(1.0 / 12.0));
    V second = _mm512_mul_pd(FMA(V1(16.0), _mm512_add_pd(b, d), FNMA(V1(30.0), c, -(a + e))), V1(1.0 / 12.0));
    V third = FMA(V1(0.5), e - a, b - d), fourth = a + e + 6.0 * c - 4.0 * (b + d);
    V x = -first / second;
    x -= (first + x * (second + x * (0.5 * third + x * fourth * (1.0 / 6.0)))) /
         (second + x * (third + x * 0.5 * fourth));
    return c + x * (first + x * (0.5 * second + x * (third * (1.0 / 6.0) + x * fourth * (1.0 / 24.0))));
}

static inline __attribute__((always_inline)) void watch(Block *b, V e) {
    V a0 = b->e4[3], b0 = b->e4[2], c0 = b->e4[1], d0 = b->e4[0];
    __mmask8 top = _mm512_cmp_pd_mask(c0, b0, _CMP_GT_OQ) & _mm512_cmp_pd_mask(c0, d0, _CMP_GE_OQ) &
                   _mm512_cmp_pd_mask(c0, b->top, _CMP_GT_OQ);
    if (top) { /* rare: only a maximum that is a new largest value needs its top */
        V best = quartic(a0, b0, c0, d0, e);
        b->top = _mm512_mask_max_pd(b->top, top, b->top, _mm512_max_pd(best, c0));
    }
    b->e4[3] = b0, b->e4[2] = c0, b->e4[1] = d0, b->e4[0] = e;
}

/* Peaks of `count` scenes: beta, steps a period; `passed` periods are run, then `watched` more with the peak taken.
 * Scenes are expected longest first. Returns the number of register steps taken. */
long sweep(int count, const double *beta, const long *steps, int passed, int watched, double lambda, double *peak) {
    enum { LANES = 8 * BLOCKS };
    static Block block[BLOCKS];
    long left[LANES], taken = 0;
    int scene[LANES], watching[LANES], next = 0, running = 0;
    unsigned before = _mm_getcsr();
    _mm_setcsr(before | 0x8040); /* flush subnormals: the wave front ahead of the first pulse is nothing but them */
    memset(block, 0, sizeof block);
    const V lam = V1(lambda);
    for (int l = 0; l < LANES; l++) scene[l] = -1, left[l] = 0, watching[l] = 1;
    for (;;) {
        for (int l = 0; l < LANES; l++) {
            if (left[l] > 0) continue;
            Block *b = &block[l / 8];
            int k = l % 8;
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
            ((double *)&b->top)[k] = on ? 1e300 : 0.0; /* nothing is looked for before the watched periods */
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

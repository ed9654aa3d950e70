/* The limit for one trajectory at a fixed step: RK4 in w, eleven beads in two registers, twelve contacts in two. */
#include <immintrin.h>
#include <math.h>

typedef __m512d V;
#define V1(x) _mm512_set1_pd(x)

typedef struct { V a, b; } P; /* lanes 0…7 and 8…15 */

/* d^{3/2} from the square root if -DEXACT is given, otherwise from rsqrt14 and two Newton steps. */
static inline V power(V d) {
#ifdef EXACT
    return d * _mm512_sqrt_pd(d);
#else
    V x = _mm512_max_pd(d, V1(1e-100)), r = _mm512_rsqrt14_pd(x), hx = 0.5 * x;
    r = r * _mm512_fnmadd_pd(hx * r, r, V1(1.5));
    V a = x * r;
    return x * _mm512_fmadd_pd(_mm512_fnmadd_pd(a, a, x), 0.5 * r, a);
#endif
}

/* Slope at (u, w) with the driver at `drive`: contact i joins beads i − 1 and i. Lanes from 11 on of u stay 0. */
static inline __attribute__((always_inline)) void slope(P u, P w, double drive, V lambda, P *du, P *dw) {
    const V zero = _mm512_setzero_pd();
    const __mmask8 upper = 0x07; /* beads 8, 9, 10 */
    V left_a = _mm512_castsi512_pd(_mm512_alignr_epi64(_mm512_castpd_si512(u.a), _mm512_castpd_si512(V1(drive)), 7));
    V left_b = _mm512_castsi512_pd(_mm512_alignr_epi64(_mm512_castpd_si512(u.b), _mm512_castpd_si512(u.a), 7));
    V d_a = _mm512_max_pd(left_a - u.a, zero), d_b = _mm512_max_pd(left_b - u.b, zero);
    V e_a = power(d_a), e_b = power(d_b);
    V d_next = _mm512_castsi512_pd(_mm512_alignr_epi64(_mm512_castpd_si512(d_b), _mm512_castpd_si512(d_a), 1));
    V e_next = _mm512_castsi512_pd(_mm512_alignr_epi64(_mm512_castpd_si512(e_b), _mm512_castpd_si512(e_a), 1));
    V d_last = _mm512_castsi512_pd(_mm512_alignr_epi64(_mm512_castpd_si512(zero), _mm512_castpd_si512(d_b), 1));
    V e_last = _mm512_castsi512_pd(_mm512_alignr_epi64(_mm512_castpd_si512(zero), _mm512_castpd_si512(e_b), 1));
    du->a = _mm512_fmadd_pd(lambda, d_a - d_next, w.a);
    dw->a = e_a - e_next;
    du->b = _mm512_maskz_fmadd_pd(upper, lambda, d_b - d_last, w.b);
    dw->b = _mm512_maskz_sub_pd(upper, e_b, e_last);
}

/* `samples` rows of 11 displacements after the first (at rest), `every` steps apart, with `steps` steps per period. */
void trajectory(double beta, double lambda, long steps, long every, long samples, const double *table, double *out) {
    unsigned before = _mm_getcsr();
    _mm_setcsr(before | 0x8040);
    const double h = 2.0 * M_PI / (beta * steps);
    const V lam = V1(lambda), half = V1(0.5 * h), whole = V1(h), sixth = V1(h / 6.0);
    const V two = V1(2.0);
    P u = {_mm512_setzero_pd(), _mm512_setzero_pd()}, w = u;
    long phase = 0;
    for (int i = 0; i < 11; i++) out[i] = 0.0;
    for (long row = 1; row <= samples; row++) {
        for (long s = 0; s < every; s++) {
            const double *drive = table + 2 * phase;
            P k, l, su, sw, x, y;
            slope(u, w, drive[0], lam, &k, &l);
            su = k, sw = l;
            x.a = u.a + half * k.a, x.b = u.b + half * k.b, y.a = w.a + half * l.a, y.b = w.b + half * l.b;
            slope(x, y, drive[1], lam, &k, &l);
            su.a += two * k.a, su.b += two * k.b, sw.a += two * l.a, sw.b += two * l.b;
            x.a = u.a + half * k.a, x.b = u.b + half * k.b, y.a = w.a + half * l.a, y.b = w.b + half * l.b;
            slope(x, y, drive[1], lam, &k, &l);
            su.a += two * k.a, su.b += two * k.b, sw.a += two * l.a, sw.b += two * l.b;
            x.a = u.a + whole * k.a, x.b = u.b + whole * k.b, y.a = w.a + whole * l.a, y.b = w.b + whole * l.b;
            slope(x, y, drive[2], lam, &k, &l);
            u.a += sixth * (su.a + k.a), u.b += sixth * (su.b + k.b);
            w.a += sixth * (sw.a + l.a), w.b += sixth * (sw.b + l.b);
            if (++phase == steps) phase = 0;
        }
        _mm512_storeu_pd(out + 11 * row, u.a);
        _mm512_mask_storeu_pd(out + 11 * row + 8, 0x07, u.b);
    }
    _mm_setcsr(before);
}

/* oracle_turning_balls.h - numbers with a radius, and functions of time with two
 * derivatives; included by what has said what a REAL is, if it is no double.
 *
 * The number meant is within r of m. Every operation rounds r up by more than the
 * rounding of r and m together: r's own is a few REAL_UNIT of it, m's at most
 * REAL_UNIT |m|. Where something is not a number, or too large, no comparison that
 * claims something is true.
 */
#ifndef ORACLE_TURNING_BALLS_H
#define ORACLE_TURNING_BALLS_H

#include <math.h>

#ifndef REAL
#define REAL        double
#define REAL_UNIT   0x1p-52
#define REAL_CUT    0x1p-64 /* more than what is left out of a sum */
#define REAL_TERMS  9       /* of such sums */
#define REAL_SERIES 16
#endif

#define REAL_TINY ((REAL)0x1p-1060) /* more than what is lost where numbers are tiny */

struct ball {
    REAL m;
    REAL r;
};

static inline REAL real_abs(REAL x)
{
    return x < 0 ? -x : x;
}

/* Round up x, which is 0 or more. */
static inline REAL real_up(REAL x)
{
    return x * (1 + 16 * REAL_UNIT) + REAL_TINY;
}

static inline struct ball ball_of(REAL m, REAL r)
{
    return (struct ball){m, real_up(r + REAL_UNIT * real_abs(m))};
}

static inline struct ball ball_exact(REAL m)
{
    return (struct ball){m, 0};
}

/* Return a bound of the magnitude. */
static inline REAL ball_size(struct ball a)
{
    return real_up(real_abs(a.m) + a.r);
}

static inline REAL ball_high(struct ball a)
{
    return a.m + a.r + 4 * REAL_UNIT * (real_abs(a.m) + a.r) + REAL_TINY;
}

static inline REAL ball_low(struct ball a)
{
    return a.m - a.r - 4 * REAL_UNIT * (real_abs(a.m) + a.r) - REAL_TINY;
}

static inline struct ball ball_add(struct ball a, struct ball b)
{
    return ball_of(a.m + b.m, a.r + b.r);
}

static inline struct ball ball_sub(struct ball a, struct ball b)
{
    return ball_of(a.m - b.m, a.r + b.r);
}

static inline struct ball ball_negative(struct ball a)
{
    return (struct ball){-a.m, a.r};
}

static inline struct ball ball_mul(struct ball a, struct ball b)
{
    return ball_of(a.m * b.m, real_abs(a.m) * b.r + a.r * (real_abs(b.m) + b.r));
}

/* Multiply by a power of two, exactly but for tiny numbers. */
static inline struct ball ball_scale(struct ball a, REAL power)
{
    return (struct ball){a.m * power, real_up(a.r * real_abs(power))};
}

/* Return 1 / a, or a ball without bounds if that may be 0. */
static inline struct ball ball_inverse(struct ball a)
{
    REAL size = real_abs(a.m);
    if (!(size * (1 - 4 * REAL_UNIT) > a.r)) {
        return (struct ball){0, (REAL)INFINITY};
    }
    return ball_of(1 / a.m, a.r / (size * (size - a.r)));
}

/* Return the root of a number that is 0 or more, whatever its ball says. */
static inline struct ball ball_sqrt(struct ball a)
{
    REAL high = ball_high(a);
    REAL low = ball_low(a);
    REAL root = (REAL)sqrt((double)high);
    if (!(low > 0) || !(root > 0)) {
        REAL half = (root * (1 + (REAL)0x1p-50) + (REAL)0x1p-500) / 2;
        return ball_of(half, half);
    }
    root = (REAL)sqrt((double)a.m);
    for (int i = 0; i < 2; i++) {
        root = (root + a.m / root) / 2;
    }
    /* |sqrt(x) - root| = |x - root^2| / (sqrt(x) + root) */
    struct ball rest = ball_sub(a, ball_mul(ball_exact(root), ball_exact(root)));
    return ball_of(root, ball_size(rest) / root);
}

/* Return what is known of a number of which also |x| <= size is. */
static inline struct ball ball_clamp(struct ball a, struct ball size)
{
    REAL high = ball_high(size);
    return a.r < high ? a : (struct ball){0, high};
}

/* Set sine and cosine, of an angle of magnitude up to 2^24. */
static inline void ball_turn(struct ball a, struct ball *sine, struct ball *cosine)
{
    /* pi / 2 in parts of 28 bits, of which k times each is exact, and what is left. */
    static const double half_pi[5] = {0x1.921fb54p+0, 0x1.10b461p-30, 0x1.a62633p-58,
                                      0x1.45c06ep-86, 0x1.cd129024e088ap-115};
#define PAIR(i)                                                                          \
    {                                                                                    \
        (REAL)1 / ((i) * ((i)-1)), (REAL)1 / ((i) * ((i) + 1))                           \
    }
    static const REAL over[15][2] = {PAIR(2),  PAIR(4),  PAIR(6),  PAIR(8),  PAIR(10),
                                     PAIR(12), PAIR(14), PAIR(16), PAIR(18), PAIR(20),
                                     PAIR(22), PAIR(24), PAIR(26), PAIR(28), PAIR(30)};
#undef PAIR
    if (!(a.r < 1) || !(real_abs(a.m) < 0x1p24)) {
        *sine = *cosine = (struct ball){0, 1};
        return;
    }
    REAL k = (REAL)rint((double)a.m * 0.6366197723675814);
    struct ball y = a;
    for (int i = 0; i < 4; i++) {
        y = ball_sub(y, ball_exact(k * (REAL)half_pi[i]));
    }
    struct ball rest = {(REAL)half_pi[4], (REAL)(half_pi[4] * 0x1p-50)};
    y = ball_sub(y, ball_mul(ball_exact(k), rest));
    /* The middle alone; the rest goes by the slope, which is at most 1. */
    struct ball x = ball_exact(y.m);
    struct ball square = ball_negative(ball_mul(x, x));
    struct ball s = ball_exact(1), c = ball_exact(1);
    for (int i = REAL_TERMS - 1; i >= 0; i--) { /* what follows is below REAL_CUT */
        c = ball_add(ball_exact(1),
                     ball_mul(c, ball_mul(square, ball_of(over[i][0], 0))));
        s = ball_add(ball_exact(1),
                     ball_mul(s, ball_mul(square, ball_of(over[i][1], 0))));
    }
    s = ball_mul(s, x);
    s.r = real_up(s.r + y.r + REAL_CUT);
    c.r = real_up(c.r + y.r + REAL_CUT);
    int quarter = (int)((long)k & 3);
    *sine = quarter % 2 == 0 ? s : c;
    *cosine = quarter % 2 == 0 ? c : s;
    if (quarter >= 2) {
        *sine = ball_negative(*sine);
    }
    if (quarter == 1 || quarter == 2) {
        *cosine = ball_negative(*cosine);
    }
}

/* ---- functions of time: value, first and second derivative ------------------------- */

struct jet {
    struct ball c[3];
};

static inline struct jet jet_of(struct ball value)
{
    return (struct jet){{value, {0, 0}, {0, 0}}};
}

static inline struct jet jet_add(struct jet a, struct jet b)
{
    for (int i = 0; i < 3; i++) {
        a.c[i] = ball_add(a.c[i], b.c[i]);
    }
    return a;
}

static inline struct jet jet_sub(struct jet a, struct jet b)
{
    for (int i = 0; i < 3; i++) {
        a.c[i] = ball_sub(a.c[i], b.c[i]);
    }
    return a;
}

static inline struct jet jet_scale(struct jet a, struct ball by)
{
    for (int i = 0; i < 3; i++) {
        a.c[i] = ball_mul(a.c[i], by);
    }
    return a;
}

static inline struct jet jet_mul(struct jet a, struct jet b)
{
    struct ball cross = ball_scale(ball_mul(a.c[1], b.c[1]), 2);
    struct jet product;
    product.c[0] = ball_mul(a.c[0], b.c[0]);
    product.c[1] = ball_add(ball_mul(a.c[1], b.c[0]), ball_mul(a.c[0], b.c[1]));
    product.c[2] = ball_add(ball_mul(a.c[2], b.c[0]), ball_mul(a.c[0], b.c[2]));
    product.c[2] = ball_add(product.c[2], cross);
    return product;
}

/* Return f(y(t)), by f and its derivatives at y. */
static inline struct jet jet_chain(const struct ball f[3], struct jet y)
{
    struct ball square = ball_mul(y.c[1], y.c[1]);
    struct jet z;
    z.c[0] = f[0];
    z.c[1] = ball_mul(f[1], y.c[1]);
    z.c[2] = ball_add(ball_mul(f[2], square), ball_mul(f[1], y.c[2]));
    return z;
}

static inline struct jet jet_dot(const struct jet a[3], const struct jet b[3])
{
    return jet_add(jet_add(jet_mul(a[0], b[0]), jet_mul(a[1], b[1])),
                   jet_mul(a[2], b[2]));
}

/* Set r, which is neither a nor b. */
static inline void jet_cross(struct jet r[3], const struct jet a[3],
                             const struct jet b[3])
{
    for (int k = 0; k < 3; k++) {
        int i = (k + 1) % 3, j = (k + 2) % 3;
        r[k] = jet_sub(jet_mul(a[i], b[j]), jet_mul(a[j], b[i]));
    }
}

/* Set value and derivatives at y >= 0 of sin(z) / z and (1 - cos z) / y, z = sqrt(y):
 * integrals over u of cos(u z) and (1 - u) cos(u z), so each derivative is at most what
 * it is at y = 0. With f, f' and f'' of the first: 4 y f'' + 6 f' + f = 0. */
static inline void ball_turn_of_square(struct ball y, struct ball f[3], struct ball g[3])
{
    static const double bounds[2][3] = {{1, 6, 60}, {2, 24, 360}};
    if (ball_size(y) <= 4) {
        for (int which = 0; which < 2; which++) {
            struct ball *p = which == 0 ? f : g;
            struct ball c[REAL_SERIES]; /* 1 / (2 k + 1 + which)!, by turns below 0 */
            c[0] = ball_exact(which == 0 ? 1 : (REAL)0.5);
            for (int k = 1; k < REAL_SERIES; k++) {
                int n = 2 * k + 1 + which;
                c[k] = ball_mul(c[k - 1], ball_inverse(ball_exact((REAL)(-n * (n - 1)))));
            }
            p[0] = p[1] = p[2] = ball_exact(0);
            for (int k = REAL_SERIES - 1; k >= 0; k--) { /* .. is below REAL_CUT */
                p[2] = ball_add(ball_mul(p[2], y), p[1]);
                p[1] = ball_add(ball_mul(p[1], y), p[0]);
                p[0] = ball_add(ball_mul(p[0], y), c[k]);
            }
            p[2] = ball_scale(p[2], 2);
            for (int i = 0; i < 3; i++) {
                p[i].r = real_up(p[i].r + REAL_CUT);
            }
        }
    } else {
        struct ball z = ball_sqrt(y);
        struct ball sine, cosine;
        struct ball over = ball_inverse(y);
        ball_turn(z, &sine, &cosine);
        f[0] = ball_mul(sine, ball_inverse(z));
        f[1] = ball_mul(ball_scale(ball_sub(cosine, f[0]), (REAL)0.5), over);
        f[2] = ball_add(f[0], ball_mul(ball_exact(6), f[1]));
        f[2] = ball_negative(ball_mul(ball_scale(f[2], (REAL)0.25), over));
        g[0] = ball_mul(ball_sub(ball_exact(1), cosine), over);
        g[1] = ball_mul(ball_sub(ball_scale(f[0], (REAL)0.5), g[0]), over);
        g[2] = ball_sub(ball_scale(f[1], (REAL)0.5), ball_scale(g[1], 2));
        g[2] = ball_mul(g[2], over);
    }
    for (int i = 0; i < 3; i++) {
        f[i] = ball_clamp(f[i], ball_inverse(ball_exact((REAL)bounds[0][i])));
        g[i] = ball_clamp(g[i], ball_inverse(ball_exact((REAL)bounds[1][i])));
    }
}

#endif

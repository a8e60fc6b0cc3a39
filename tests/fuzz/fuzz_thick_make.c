/* fuzz_thick_make.c - pairs of thick features that are hard for one reason each. */
#include <math.h>
#include <string.h>

#include "motion.h"
#include "fuzz_thick.h"

int fuzz_thick_points(const struct fuzz_thick_case *made, int side)
{
    return (int)common_kinds[(uint32_t)made->query.query.kind].points[side];
}

bool fuzz_thick_is_of_b(const struct fuzz_thick_case *made, int point)
{
    return point >= fuzz_thick_points(made, 0);
}

typedef double (*points_t)[4][3];

/* -bound .. bound */
static double integer(struct prng *prng, uint64_t bound)
{
    return (double)prng_below(prng, 2 * bound + 1) - (double)bound;
}

/* ---- families ---------------------------------------------------------------------- */

static void make_random(struct prng *prng, struct fuzz_thick_case *made)
{
    points_t x = made->query.query.x;
    double apart = ldexp(1, 1 - (int)prng_below(prng, 8));
    for (int i = 0; i < 24; i++) {
        x[i / 12][i / 3 % 4][i % 3] = prng_between(prng, -1, 1);
    }
    double shift = prng_below(prng, 3) == 0 ? 1 : 0;
    for (int k = 0; k < 4; k++) {
        x[0][k][2] = x[0][k][2] * apart + (fuzz_thick_is_of_b(made, k) ? shift : 0);
        x[1][k][2] = x[1][k][2] * apart + (fuzz_thick_is_of_b(made, k) ? shift : 0);
    }
    made->query.radius[0] = prng_between(prng, 0, 1) * apart * 0.5;
    made->query.radius[1] = prng_below(prng, 2) ? prng_between(prng, 0, 0.1) : 0;
    made->query.radius[2] = prng_below(prng, 2) ? prng_between(prng, 0, 0.1) : 0;
}

static void make_grid(struct prng *prng, struct fuzz_thick_case *made)
{
    points_t x = made->query.query.x;
    uint64_t bound = 1 + prng_below(prng, 5);
    for (int i = 0; i < 24; i++) {
        double *at = &x[i / 12][i / 3 % 4][i % 3];
        *at = integer(prng, bound);
        if (i >= 12 && prng_below(prng, 3) == 0) {
            *at = x[0][i / 3 % 4][i % 3];
        }
    }
    for (int i = 0; i < 3; i++) {
        made->query.radius[i] = (double)prng_below(prng, 5) / 4;
    }
}

/* Features in two planes across (2, 3, 6), which is 7 long: 7 height apart, where they
 * overlap. */
static void make_tangent(struct prng *prng, struct fuzz_thick_case *made)
{
    static const double across[3][3] = {{3, -2, 0}, {6, 2, -3}, {3, -6, 2}};
    static const double normal[3] = {2, 3, 6};
    double height = (double)(1 + prng_below(prng, 3));
    double dip = prng_below(prng, 2) ? 0 : integer(prng, 1); /* a corner comes nearer */
    for (int i = 0; i < 8; i++) {
        double a = integer(prng, 3);
        double b = integer(prng, 3);
        uint64_t other = 1 + prng_below(prng, 2);
        double up = fuzz_thick_is_of_b(made, i % 4) ? 0 : height;
        up += i == 5 ? dip : 0;
        for (int k = 0; k < 3; k++) {
            made->query.query.x[i / 4][i % 4][k] =
                a * across[0][k] + b * across[other][k] + up * normal[k];
        }
    }
    made->query.radius[0] = 7 * height;
    if (prng_below(prng, 3) == 0) {
        made->query.radius[prng_below(prng, 2)] += prng_below(prng, 2) ? 0x1p-48 : -0;
        made->query.radius[0] -= prng_below(prng, 2) ? 0x1p-48 : 0;
    }
}

/* About the way from feature b to a at time t, of a query whose points are all looked at:
 * coordinates are near 1. */
static double way_at(const struct fuzz_thick_case *made, double t, double gap[3])
{
    const struct eng_query *query = &made->query.query;
    struct eng_pose pose;
    struct eng_closest closest;
    uint32_t kind = (uint32_t)query->kind;
    bool is_ee = kind == PCCD_EE;
    for (int k = 0; k < 3; k++) {
        double x[4];
        for (int i = 0; i < 4; i++) {
            x[i] = (1 - t) * query->x[0][i][k] + t * query->x[1][i][k];
        }
        pose.p[k] = is_ee ? x[2] - x[0] : x[0] - x[1];
        pose.b[k] = is_ee ? x[1] - x[0] : kind == PCCD_VV ? 0 : x[2] - x[1];
        pose.c[k] = is_ee ? x[2] - x[3] : kind == PCCD_VF ? x[3] - x[1] : 0;
    }
    eng_closest_to_origin(is_ee ? PCCD_EE : PCCD_VF, &pose, &closest);
    for (int k = 0; k < 3; k++) {
        gap[k] = is_ee ? -closest.gap[k] : closest.gap[k];
    }
    return sqrt(gap[0] * gap[0] + gap[1] * gap[1] + gap[2] * gap[2]);
}

/* When the distance is about least; one of several such times, if there are some. */
static double find_least(const struct fuzz_thick_case *made, double gap[3])
{
    double best = 0;
    for (int i = 1; i <= 16; i++) {
        best = way_at(made, i / 16.0, gap) < way_at(made, best, gap) ? i / 16.0 : best;
    }
    double l = fmax(best - 1 / 16.0, 0);
    double r = fmin(best + 1 / 16.0, 1);
    for (int i = 0; i < 60; i++) {
        double a = l + (r - l) * 0.382;
        double b = l + (r - l) * 0.618;
        if (way_at(made, a, gap) < way_at(made, b, gap)) {
            r = b;
        } else {
            l = a;
        }
    }
    return way_at(made, l, gap);
}

/* Doubles cannot tell whether the least distance is r. */
static void make_minimum(struct prng *prng, struct fuzz_thick_case *made)
{
    double gap[3];
    make_random(prng, made);
    find_least(made, gap);
    double share = 1 - ldexp(1, -(int)prng_below(prng, 16)); /* a comes nearer by that */
    for (int i = 0; i < 24; i++) {
        if (!fuzz_thick_is_of_b(made, i / 3 % 4)) {
            made->query.query.x[i / 12][i / 3 % 4][i % 3] -= share * gap[i % 3];
        }
    }
    double least = find_least(made, gap);
    double unit = ENG_U * (prng_below(prng, 2) ? 1 : least);
    memset(made->query.radius, 0, sizeof made->query.radius);
    made->query.radius[0] = fmax(0, least + integer(prng, 8) * unit);
}

/* Both move alike, or along each other, with 3 4 5 between them. */
static void make_throughout(struct prng *prng, struct fuzz_thick_case *made)
{
    points_t x = made->query.query.x;
    double by[3] = {integer(prng, 8), integer(prng, 8), integer(prng, 8)};
    double slide = prng_below(prng, 2) ? integer(prng, 9) : 0;
    make_grid(prng, made);
    for (int i = 0; i < 4; i++) {
        x[0][i][2] = 0;
        if (!fuzz_thick_is_of_b(made, i)) {
            x[0][i][1] = 0;
        } else if (prng_below(prng, 2)) {
            x[0][i][1] = 3;
            x[0][i][2] = 4;
        }
        for (int k = 0; k < 3; k++) {
            x[1][i][k] =
                x[0][i][k] + by[k] + (k == 0 && fuzz_thick_is_of_b(made, i) ? slide : 0);
        }
    }
    memset(made->query.radius, 0, sizeof made->query.radius);
    made->query.radius[0] = (double)(2 + prng_below(prng, 4));
}

static void put_near_line(struct prng *prng, points_t x, int end, const int points[3],
                          double width)
{
    double share = prng_between(prng, -1, 2);
    double *from = x[end][points[1]];
    const double *on = x[end][points[2]];
    for (int k = 0; k < 3; k++) {
        x[end][points[0]][k] =
            from[k] + share * (on[k] - from[k]) + width * prng_between(prng, -1, 1);
    }
}

static void make_sliver(struct prng *prng, struct fuzz_thick_case *made)
{
    points_t x = made->query.query.x;
    double width = ldexp(1, -(int)prng_below(prng, 55));
    make_random(prng, made);
    for (int end = 0; end < 2; end++) {
        if (prng_below(prng, 3) == 0) {
            continue;
        }
        static const int thin[3] = {3, 1, 2};
        put_near_line(prng, x, end, thin, width);
        for (int k = 0; k < 3 && made->query.query.kind == PCCD_EE; k++) {
            x[end][3][k] = x[end][2][k] + 1.5 * (x[end][1][k] - x[end][0][k]) +
                           width * prng_between(prng, -1, 1);
        }
    }
}

/* At one time the corners lie on a line, or are one point; or the edges are parallel. */
static void make_collapse(struct prng *prng, struct fuzz_thick_case *made)
{
    points_t x = made->query.query.x;
    double before = (double)(1 + prng_below(prng, 3));
    double behind = (double)(1 + prng_below(prng, 3));
    uint64_t what = prng_below(prng, 3);
    make_grid(prng, made);
    /* Points i at m + before v and m - behind v meet m at the same time. */
    for (int i = 1; i < 4; i++) {
        for (int k = 0; k < 3; k++) {
            double m = what == 0 ? 0 : what == 1 ? (k == 0 ? (double)i : 0) : x[0][1][k];
            double v = integer(prng, 2);
            x[0][i][k] = m + before * v;
            x[1][i][k] = m - behind * v;
        }
    }
    if (prng_below(prng, 2)) { /* the other one is somewhere else */
        double away = integer(prng, 9);
        for (int i = 0; i < 2; i++) {
            x[i][0][2] += away;
            if (made->query.query.kind == PCCD_EE) {
                x[i][1][2] += away;
            }
        }
    }
}

/* Noise of 1e-6 to 1e-16; one in four of any size down to 2^-1000. */
static double noise(struct prng *prng, uint64_t size)
{
    double least = ldexp(1, -20 - (int)prng_below(prng, size));
    return least * prng_between(prng, -1, 1);
}

/* At one end some points are where the first of them is, and others nearly; elsewhere
 * they are at thousandths or whole numbers, with noise or without. */
static void make_shrink(struct prng *prng, struct fuzz_thick_case *made)
{
    points_t x = made->query.query.x;
    uint64_t size = prng_below(prng, 4) ? 33 : 980;
    uint64_t at_end = prng_below(prng, 2);
    double unit = prng_below(prng, 2) ? 1 : 0.001;
    for (int i = 0; i < 24; i++) {
        double value = integer(prng, unit == 1 ? 2 : 2000) * unit;
        x[i / 12][i / 3 % 4][i % 3] =
            value + (prng_below(prng, 2) ? noise(prng, size) : 0);
    }
    for (int i = 1; i < 4; i++) {
        if (prng_below(prng, 3) == 0) {
            continue;
        }
        bool is_near = prng_below(prng, 3) == 0;
        for (int k = 0; k < 3; k++) {
            x[at_end][i][k] = x[at_end][0][k] + (is_near ? noise(prng, size) : 0);
        }
    }
    made->query.radius[0] = prng_below(prng, 2) ? 0.25 : prng_between(prng, 0, 1);
    made->query.radius[1] = prng_below(prng, 2) ? 0.25 : 0;
    made->query.approach = prng_below(prng, 3) ? 0 : 0.3;
}

static void make_degenerate(struct prng *prng, struct fuzz_thick_case *made)
{
    points_t x = made->query.query.x;
    make_grid(prng, made);
    double share = integer(prng, 4) / 2;
    for (int i = 0; i < 6; i++) {
        x[i / 3][3][i % 3] =
            x[i / 3][2][i % 3] + share * (x[i / 3][1][i % 3] - x[i / 3][2][i % 3]);
    }
    if (prng_below(prng, 3) == 0) {
        uint64_t to = prng_below(prng, 4);
        uint64_t from = prng_below(prng, 4);
        memcpy(x[0][to], x[0][from], sizeof x[0][0]);
        memcpy(x[1][to], x[1][from], sizeof x[0][0]);
    }
}

static void make_flat(struct prng *prng, struct fuzz_thick_case *made)
{
    points_t x = made->query.query.x;
    make_grid(prng, made);
    double height = prng_below(prng, 2) ? (double)prng_below(prng, 3) : 0;
    for (int i = 0; i < 8; i++) {
        x[i / 4][i % 4][2] = fuzz_thick_is_of_b(made, i % 4) ? 0 : height;
    }
}

static void make_far(struct prng *prng, struct fuzz_thick_case *made)
{
    double base[3];
    for (int k = 0; k < 3; k++) {
        base[k] = prng_between(prng, -0.99e18, 0.99e18);
    }
    for (int i = 0; i < 24; i++) {
        made->query.query.x[i / 12][i / 3 % 4][i % 3] =
            base[i % 3] + 128 * integer(prng, prng_below(prng, 2) ? 50 : 1 << 20);
    }
    made->query.radius[0] = 32 * (double)prng_below(prng, 400);
    made->query.radius[1] = ldexp(1, (int)prng_below(prng, 60));
}

static void make_powers(struct prng *prng, struct fuzz_thick_case *made)
{
    points_t x = made->query.query.x;
    int least = prng_below(prng, 4) == 0 ? -1074 : prng_below(prng, 2) ? -300 : -60;
    bool is_small = prng_below(prng, 2);
    uint64_t span = (uint64_t)(59 - least);
    for (int i = 0; i < 26; i++) {
        uint64_t above = prng_below(prng, span);
        double mantissa = is_small ? integer(prng, 4) / 8 : prng_between(prng, -1, 1);
        double value = ldexp(mantissa, least + (int)above);
        if (i >= 24) {
            made->query.radius[i - 24] = fabs(value);
        } else if (prng_below(prng, 4) == 0) {
            x[i / 12][i / 3 % 4][i % 3] = x[0][prng_below(prng, 4)][i % 3];
        } else {
            x[i / 12][i / 3 % 4][i % 3] = value;
        }
    }
}

static void make_denormal(struct prng *prng, struct fuzz_thick_case *made)
{
    uint64_t bound = prng_below(prng, 2) ? 5 : 1 << 20;
    for (int i = 0; i < 24; i++) {
        made->query.query.x[i / 12][i / 3 % 4][i % 3] =
            ldexp(integer(prng, bound), -1074);
    }
    made->query.radius[0] = ldexp((double)prng_below(prng, bound), -1074);
}

static void make_zero(struct prng *prng, struct fuzz_thick_case *made)
{
    made->family = (enum fuzz_thick_family)prng_below(prng, FUZZ_THICK_INSIDE);
    if (made->family == FUZZ_THICK_RANDOM) {
        make_random(prng, made);
    } else if (made->family == FUZZ_THICK_FLAT) {
        make_flat(prng, made);
    } else {
        make_grid(prng, made);
    }
    made->family = FUZZ_THICK_ZERO;
    memset(made->query.radius, 0, sizeof made->query.radius);
    made->query.radius[1] = prng_below(prng, 3) == 0 ? 0x1p-1000 : 0;
}

static void make_inside(struct prng *prng, struct fuzz_thick_case *made)
{
    if (prng_below(prng, 2)) {
        make_grid(prng, made);
    } else {
        make_random(prng, made);
    }
    made->query.radius[2] = 1 + (double)prng_below(prng, 8);
    made->query.approach = prng_below(prng, 2) ? 0.5 : prng_between(prng, 0.01, 1);
}

typedef void (*make_fn)(struct prng *prng, struct fuzz_thick_case *made);

static const make_fn makers[FUZZ_THICK_FAMILIES] = {
    make_random, make_grid,     make_tangent, make_minimum,    make_throughout,
    make_sliver, make_collapse, make_shrink,  make_degenerate, make_flat,
    make_inside, make_zero,     make_far,     make_powers,     make_denormal};

/* ---- changes that leave a case in its family --------------------------------------- */

/* All lengths with a power of two: r too may become one. */
static void scale(struct fuzz_thick_case *made, int exponent)
{
    for (int i = 0; i < 24; i++) {
        double *x = &made->query.query.x[i / 12][i / 3 % 4][i % 3];
        *x = ldexp(*x, exponent);
    }
    for (int i = 0; i < 3; i++) {
        made->query.radius[i] = ldexp(made->query.radius[i], exponent);
    }
}

static void nudge(struct prng *prng, struct fuzz_thick_case *made)
{
    double toward = prng_below(prng, 2) ? 1e18 : -1e18;
    if (prng_below(prng, 2)) {
        double *r = &made->query.radius[0];
        *r = nextafter(*r, *r > 0 ? toward : 1e18);
    } else {
        uint64_t i = prng_below(prng, 24);
        double *x = &made->query.query.x[i / 12][i / 3 % 4][i % 3];
        *x = nextafter(*x, toward);
    }
}

static void cut(double *x, double most)
{
    *x = *x > most ? most : *x < -most ? -most : *x;
}

void fuzz_thick_make(struct prng *prng, uint32_t least_kind, struct fuzz_thick_case *made)
{
    static const double tolerances[4] = {1e-6, 1e-6, 1e-12, 0.5};
    memset(made, 0, sizeof *made);
    made->family = (enum fuzz_thick_family)prng_below(prng, FUZZ_THICK_FAMILIES);
    made->query.query.kind =
        (enum pccd_kind)(least_kind + prng_below(prng, 4 - least_kind));
    made->tolerance = tolerances[prng_below(prng, 4)];
    makers[made->family](prng, made);
    bool fits = made->family < FUZZ_THICK_FAR && made->family != FUZZ_THICK_ZERO;
    if (fits && prng_below(prng, 4) == 0) {
        scale(made, 20 - (int)prng_below(prng, 1000));
    }
    if (prng_below(prng, 4) == 0 && made->family != FUZZ_THICK_ZERO) {
        nudge(prng, made);
    }
    if (made->family != FUZZ_THICK_ZERO && prng_below(prng, 8) == 0) {
        made->query.approach = 0.75;
    }
    for (int i = 0; i < 27; i++) {
        cut(i < 24 ? &made->query.query.x[i / 12][i / 3 % 4][i % 3]
                   : &made->query.radius[i - 24],
            1e18);
    }
    int last = fuzz_thick_points(made, 0) + fuzz_thick_points(made, 1) - 1;
    for (int i = last + 1; i < 4; i++) { /* as query.h says */
        memcpy(made->query.query.x[0][i], made->query.query.x[0][last],
               sizeof made->query.query.x[0][i]);
        memcpy(made->query.query.x[1][i], made->query.query.x[1][last],
               sizeof made->query.query.x[1][i]);
    }
}

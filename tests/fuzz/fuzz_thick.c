/* fuzz_thick.c - the engine's test of thick features against the oracle's.
 *
 * Room:     tests/fuzz.
 * Does:     see fuzz_thick.h.
 * Threads:  one for one run.
 */
#include "fuzz_thick.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "closest.h"
#include "kinds.h"
#include "oracle_thick.h"

#define FAILURES_MAX 10

static const char *const names[FUZZ_THICK_FAMILIES] = {
    "random",     "grid", "tangent", "minimum", "throughout", "sliver", "collapse",
    "degenerate", "flat", "inside",  "zero",    "far",        "powers", "denormal"};

const char *fuzz_thick_name(enum fuzz_thick_family family)
{
    return names[family];
}

typedef double (*points_t)[4][3];

/* -bound .. bound */
static double integer(struct prng *prng, uint64_t bound)
{
    return (double)prng_below(prng, 2 * bound + 1) - (double)bound;
}

static int points_of(const struct fuzz_thick_case *made, int side)
{
    return (int)common_kinds[(uint32_t)made->query.query.kind].points[side];
}

static bool is_of_b(const struct fuzz_thick_case *made, int point)
{
    return point >= points_of(made, 0);
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
        x[0][k][2] = x[0][k][2] * apart + (is_of_b(made, k) ? shift : 0);
        x[1][k][2] = x[1][k][2] * apart + (is_of_b(made, k) ? shift : 0);
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
        double up = is_of_b(made, i % 4) ? 0 : height;
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
        if (!is_of_b(made, i / 3 % 4)) {
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
        if (!is_of_b(made, i)) {
            x[0][i][1] = 0;
        } else if (prng_below(prng, 2)) {
            x[0][i][1] = 3;
            x[0][i][2] = 4;
        }
        for (int k = 0; k < 3; k++) {
            x[1][i][k] = x[0][i][k] + by[k] + (k == 0 && is_of_b(made, i) ? slide : 0);
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

/* At `at` of the step the corners lie on a line, or are one; or the edges are parallel. */
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
        x[i / 4][i % 4][2] = is_of_b(made, i % 4) ? 0 : height;
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
    make_random, make_grid,     make_tangent,    make_minimum, make_throughout,
    make_sliver, make_collapse, make_degenerate, make_flat,    make_inside,
    make_zero,   make_far,      make_powers,     make_denormal};

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

void fuzz_thick_make(struct prng *prng, struct fuzz_thick_case *made)
{
    static const double tolerances[4] = {1e-6, 1e-6, 1e-12, 0.5};
    memset(made, 0, sizeof *made);
    made->family = (enum fuzz_thick_family)prng_below(prng, FUZZ_THICK_FAMILIES);
    made->query.query.kind = (enum pccd_kind)prng_below(prng, 4);
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
    int last = points_of(made, 0) + points_of(made, 1) - 1;
    for (int i = last + 1; i < 4; i++) { /* as query.h says */
        memcpy(made->query.query.x[0][i], made->query.query.x[0][last],
               sizeof made->query.query.x[0][i]);
        memcpy(made->query.query.x[1][i], made->query.query.x[1][last],
               sizeof made->query.query.x[1][i]);
    }
}

/* ---- judgement --------------------------------------------------------------------- */

void fuzz_thick_init(struct fuzz_thick_run *run, uint64_t seed, FILE *log)
{
    memset(run, 0, sizeof *run);
    run->prng.state = seed;
    run->log = log;
    run->oracle_each = 1;
    if (eng_thick_init(&run->thick) != PCCD_OK ||
        eng_exact_init(&run->contacts) != PCCD_OK) {
        abort();
    }
}

void fuzz_thick_deinit(struct fuzz_thick_run *run)
{
    eng_thick_deinit(&run->thick);
    eng_exact_deinit(&run->contacts);
}

/* What the oracle says of a case. */
struct truth {
    bool is_inside;
    struct oracle_first *first; /* NULL: none */
};

static struct truth find_truth(const struct fuzz_thick_case *made)
{
    const struct oracle_thick thick = {
        .points_a = points_of(made, 0),
        .points_b = points_of(made, 1),
        .p = (const double(*)[3])made->query.query.x,
        .radius = {made->query.radius[0], made->query.radius[1], made->query.radius[2]},
        .approach = made->query.approach};
    return (struct truth){oracle_thick_is_inside(&thick), oracle_thick_first_new(&thick)};
}

static bool is_contact(const struct fuzz_thick_case *made)
{
    uint32_t kind = (uint32_t)made->query.query.kind;
    const double *r = made->query.radius;
    return r[0] + r[1] + r[2] == 0 && (kind == PCCD_VF || kind == PCCD_EE);
}

/* A hit against the truth. */
static const char *judge_hit(const struct fuzz_thick_case *made,
                             const struct truth *truth, const struct eng_hit *hit)
{
    bool is_inside = made->query.approach > 0 && truth->is_inside;
    if (((hit->flags & ENG_THICK_INSIDE) != 0) != is_inside && !is_contact(made)) {
        return "INSIDE";
    }
    if (truth->first && oracle_first_compare(truth->first, hit->toi) < 0) {
        return "toi is late";
    }
    if ((hit->flags & PCCD_PROVED) == 0) {
        return NULL;
    }
    if (!truth->first) {
        return "invented";
    }
    bool is_initial = oracle_first_compare(truth->first, 0) == 0;
    if (((hit->flags & PCCD_INITIAL) != 0) != is_initial) {
        return "INITIAL";
    }
    int side = oracle_first_compare(truth->first, hit->toi_hi);
    if (side > 0 || !(hit->toi_hi - hit->toi <= made->tolerance)) {
        return "toi_hi";
    }
    if (!is_contact(made) && !is_initial && side == 0 && hit->toi_hi < 1) {
        return "the cell before that of the first time";
    }
    double length = hypot(hypot((double)hit->normal[0], (double)hit->normal[1]),
                          (double)hit->normal[2]);
    return length != 0 && fabs(length - 1) > 1e-6 ? "normal" : NULL;
}

static const char *judge(struct fuzz_thick_run *run, const struct fuzz_thick_case *made,
                         enum eng_thick_stage first, const struct truth *truth,
                         struct eng_hit *hit)
{
    run->thick.first = first;
    memset(hit, 0, sizeof *hit);
    bool hits = eng_thick_solve(&run->thick, &run->contacts, &made->query,
                                made->tolerance, 1, hit);
    if (!hits) {
        return truth->first ? "missed" : NULL;
    }
    const char *what = judge_hit(made, truth, hit);
    if (what) {
        return what;
    }
    /* Asked only for what begins until some time, it says the same or nothing. */
    struct eng_hit same;
    double t_end = prng_below(&run->prng, 2) ? hit->toi : nextafter(hit->toi, -1);
    if (t_end >= 0 && hits &&
        eng_thick_solve(&run->thick, &run->contacts, &made->query, made->tolerance, t_end,
                        &same) != (hit->toi <= t_end)) {
        return "t_end";
    }
    return NULL;
}

const char *fuzz_thick_judge(struct fuzz_thick_run *run,
                             const struct fuzz_thick_case *made,
                             enum eng_thick_stage first)
{
    struct eng_hit hit;
    struct truth truth = find_truth(made);
    const char *what = judge(run, made, first, &truth, &hit);
    oracle_first_free(truth.first);
    return what;
}

static bool same_hit(const struct eng_hit *a, const struct eng_hit *b)
{
    return a->flags == b->flags && memcmp(&a->toi, &b->toi, sizeof a->toi) == 0 &&
           memcmp(&a->toi_hi, &b->toi_hi, sizeof a->toi_hi) == 0 &&
           memcmp(a->param, b->param, sizeof a->param) == 0 &&
           memcmp(a->normal, b->normal, sizeof a->normal) == 0;
}

static void print_case(FILE *log, const struct fuzz_thick_case *made,
                       const struct eng_hit *hit, const char *what)
{
    const struct eng_thick_query *query = &made->query;
    fprintf(log, "# wrong: %s, family %s; flags %u, %a .. %a\n", what,
            names[made->family], hit->flags, hit->toi, hit->toi_hi);
    fprintf(log, "%s tolerance %a r %a %a %a approach %a\n",
            common_kinds[(uint32_t)query->query.kind].name, made->tolerance,
            query->radius[0], query->radius[1], query->radius[2], query->approach);
    for (int i = 0; i < 8; i++) {
        const double *x = query->query.x[i / 4][i % 4];
        fprintf(log, "    {%a, %a, %a},\n", x[0], x[1], x[2]);
    }
}

/* Does no axis keep them farther apart than r, in one order at both ends? */
static bool is_inseparable(const struct fuzz_thick_case *made)
{
    const double *radius = made->query.radius;
    double r = radius[0] + radius[1] + radius[2];
    int used = points_of(made, 0) + points_of(made, 1);
    for (int axis = 0; axis < 6; axis++) {
        double least = INFINITY;
        for (int n = 0; n < 2 * used * used; n++) {
            int i = n / 2 / used;
            int j = n / 2 % used;
            if (!is_of_b(made, i) && is_of_b(made, j)) {
                double gap = made->query.query.x[n % 2][i][axis / 2] -
                             made->query.query.x[n % 2][j][axis / 2];
                least = fmin(least, axis % 2 ? gap : -gap);
            }
        }
        if (least > r) {
            return false;
        }
    }
    return true;
}

static void fail(struct fuzz_thick_run *run, const struct fuzz_thick_case *made,
                 const struct eng_hit *hit, const char *what)
{
    run->failures++;
    print_case(run->log, made, hit, what);
}

/* By doubles first, then by integers alone; hits[i] has no flags where there is none. */
static void solve_both(struct fuzz_thick_run *run, const struct fuzz_thick_case *made,
                       bool found[ENG_THICK_STAGES],
                       struct eng_hit hits[ENG_THICK_STAGES])
{
    struct fuzz_thick_counts *counts = &run->counts[made->family];
    uint64_t by_integers = run->thick.decided[ENG_THICK_BY_INTEGERS];
    uint64_t possible = run->thick.possible;
    for (int i = 0; i < ENG_THICK_STAGES; i++) {
        memset(&hits[i], 0, sizeof hits[i]);
        run->thick.first = (enum eng_thick_stage)i;
        found[i] = eng_thick_solve(&run->thick, &run->contacts, &made->query,
                                   made->tolerance, 1, &hits[i]);
        if (i == 0) {
            counts->by_integers +=
                run->thick.decided[ENG_THICK_BY_INTEGERS] > by_integers;
            counts->possible += run->thick.possible > possible;
        }
    }
}

/* What is proved by both has the same bytes, and nothing is proved by one and denied by
 * the other. */
static bool agree(const bool found[ENG_THICK_STAGES],
                  const struct eng_hit hits[ENG_THICK_STAGES])
{
    for (int i = 0; i < ENG_THICK_STAGES; i++) {
        if (found[i] && (hits[i].flags & PCCD_PROVED) == 0) {
            return true;
        }
    }
    return found[0] == found[1] && (!found[0] || same_hit(&hits[0], &hits[1]));
}

static void run_case(struct fuzz_thick_run *run, const struct fuzz_thick_case *made)
{
    struct fuzz_thick_counts *counts = &run->counts[made->family];
    bool found[ENG_THICK_STAGES];
    struct eng_hit hits[ENG_THICK_STAGES];
    solve_both(run, made, found, hits);
    if (!agree(found, hits)) {
        fail(run, made, &hits[0], "integers say otherwise");
        print_case(run->log, made, &hits[1], "this is what they say");
    }
    if (prng_below(&run->prng, run->oracle_each) == 0) {
        struct truth truth = find_truth(made);
        for (int i = 0; i < ENG_THICK_STAGES; i++) {
            const char *what =
                judge(run, made, (enum eng_thick_stage)i, &truth, &hits[i]);
            if (what) {
                fail(run, made, &hits[i], what);
            }
        }
        oracle_first_free(truth.first);
        run->judged++;
    }
    run->kinds[(uint32_t)made->query.query.kind]++;
    counts->cases++;
    counts->hits += found[0];
    counts->initial += found[0] && (hits[0].flags & PCCD_INITIAL) != 0;
    counts->inside += found[0] && (hits[0].flags & ENG_THICK_INSIDE) != 0;
    counts->inseparable += is_inseparable(made);
}

void fuzz_thick_more(struct fuzz_thick_run *run, uint64_t count)
{
    for (uint64_t i = 0; i < count && run->failures < FAILURES_MAX; i++) {
        struct fuzz_thick_case made;
        fuzz_thick_make(&run->prng, &made);
        run_case(run, &made);
    }
}

struct fuzz_thick_counts fuzz_thick_total(const struct fuzz_thick_run *run)
{
    struct fuzz_thick_counts total = {0};
    for (int i = 0; i < FUZZ_THICK_FAMILIES; i++) {
        const struct fuzz_thick_counts *own = &run->counts[i];
        total.cases += own->cases;
        total.hits += own->hits;
        total.initial += own->initial;
        total.inside += own->inside;
        total.inseparable += own->inseparable;
        total.by_integers += own->by_integers;
        total.possible += own->possible;
    }
    return total;
}

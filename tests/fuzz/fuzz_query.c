/* fuzz_query.c - queries that are hard for an elementary test. */
#include "fuzz_query.h"

#include <math.h>
#include <string.h>

#define LIMIT 1e18

static double between(struct prng *prng, double lo, double hi)
{
    return prng_between(prng, lo, hi);
}

/* -bound .. bound */
static double integer(struct prng *prng, uint64_t bound)
{
    return (double)prng_below(prng, 2 * bound + 1) - (double)bound;
}

/* A size that is as often 2^-1 as 2^-50. */
static double small(struct prng *prng)
{
    return ldexp(between(prng, -1, 1), -(int)prng_below(prng, 54));
}

static void make_random(struct prng *prng, struct eng_query *query)
{
    double motion = ldexp(1, 1 - (int)prng_below(prng, 30));
    for (int i = 0; i < 12; i++) {
        double x = between(prng, -1, 1);
        query->x[0][i / 3][i % 3] = x;
        query->x[1][i / 3][i % 3] = x + between(prng, -motion, motion);
    }
}

static void make_snapped(struct prng *prng, struct eng_query *query)
{
    uint64_t bound = 1 + prng_below(prng, 4);
    bool flat = prng_below(prng, 4) == 0;
    for (int i = 0; i < 24; i++) {
        bool is_z = i % 3 == 2;
        query->x[i / 12][i / 3 % 4][i % 3] = flat && is_z ? 0 : integer(prng, bound);
    }
}

/* z is made of x and y: of integers exactly, of others up to rounding. */
static void make_coplanar(struct prng *prng, struct eng_query *query)
{
    bool exact = prng_below(prng, 2);
    for (int end = 0; end < 2; end++) {
        double slope_x = integer(prng, 3);
        double slope_y = exact ? integer(prng, 3) : between(prng, -1, 1);
        for (int point = 0; point < 4; point++) {
            double *x = query->x[end][point];
            x[0] = exact ? integer(prng, 9) : between(prng, -1, 1);
            x[1] = exact ? integer(prng, 9) : between(prng, -1, 1);
            x[2] = slope_x * x[0] + slope_y * x[1];
        }
    }
}

static void make_sliver(struct prng *prng, struct eng_query *query)
{
    make_random(prng, query);
    int from = query->kind == PCCD_VF ? 1 : 2;
    for (int end = 0; end < 2; end++) {
        double(*x)[3] = query->x[end];
        double share = between(prng, -1, 2);
        for (int k = 0; k < 3; k++) {
            if (query->kind == PCCD_VF) {
                x[3][k] = x[1][k] + share * (x[2][k] - x[1][k]) + small(prng);
            } else { /* along the other edge, or hardly longer than nothing */
                x[3][k] = x[from][k] + share * (x[1][k] - x[0][k]) + small(prng);
            }
        }
    }
}

/* The points at the time of a contact at `beta`, `gamma`; the rest is by chance. `step`
 * is what coordinates are multiples of: 0 for any. */
static void place_contact(struct prng *prng, enum pccd_kind kind, double beta,
                          double gamma, double step, double x[4][3])
{
    for (int k = 0; k < 3; k++) {
        for (int point = 0; point < 4; point++) {
            x[point][k] = step > 0 ? step * integer(prng, 8) : between(prng, -1, 1);
        }
        if (kind == PCCD_VF) {
            x[0][k] = x[1][k] + beta * (x[2][k] - x[1][k]) + gamma * (x[3][k] - x[1][k]);
        } else { /* b0 such that the edges meet */
            double at_a = x[0][k] + beta * (x[1][k] - x[0][k]);
            double along = x[3][k] - x[2][k];
            x[2][k] = at_a - gamma * along;
            x[3][k] = x[2][k] + along;
        }
    }
}

/* Each point's straight way through `x` at time t. */
static void move_through(struct prng *prng, const double x[4][3], double t, double step,
                         struct eng_query *query)
{
    for (int i = 0; i < 12; i++) {
        double way = step > 0 ? step * integer(prng, 8) : between(prng, -1, 1);
        query->x[0][i / 3][i % 3] = x[i / 3][i % 3] - t * way;
        query->x[1][i / 3][i % 3] = x[i / 3][i % 3] + (1 - t) * way;
    }
}

/* Multiples of 1/64 times multiples of 1/8: no operation rounds. */
static void make_planted(struct prng *prng, struct eng_query *query)
{
    double x[4][3];
    double t = (double)prng_below(prng, 9) / 8;
    double beta = (double)prng_below(prng, 9) / 8;
    double rest = query->kind == PCCD_VF ? 1 - beta : 1;
    double gamma = rest * (double)prng_below(prng, 9) / 8;
    place_contact(prng, query->kind, beta, gamma, 1, x);
    move_through(prng, (const double(*)[3])x, t, 1, query);
}

static void make_near(struct prng *prng, struct eng_query *query)
{
    make_planted(prng, query);
    double *x = &query->x[prng_below(prng, 2)][prng_below(prng, 4)][prng_below(prng, 3)];
    uint64_t steps = 1 + prng_below(prng, 3);
    double direction = prng_below(prng, 2) ? 1e300 : -1e300;
    for (uint64_t i = 0; i < steps; i++) {
        *x = nextafter(*x, direction);
    }
    if (fabs(*x) < 1e-300) {
        *x = direction > 0 ? 0x1p-60 : -0x1p-60;
    }
}

static void make_crossing(struct prng *prng, bool on_rim, struct eng_query *query)
{
    double x[4][3];
    double beta = between(prng, 0, 1);
    double rest = query->kind == PCCD_VF ? 1 - beta : 1;
    double gamma = rest * between(prng, 0, 1);
    if (on_rim) {
        switch (prng_below(prng, 4)) {
        case 0:
            beta = 0;
            break;
        case 1:
            gamma = 0;
            break;
        case 2:
            gamma = query->kind == PCCD_VF ? 1 - beta : 1;
            break;
        default:
            beta = 1;
            gamma = query->kind == PCCD_VF ? 0 : 1;
        }
        beta += prng_below(prng, 3) == 0 ? small(prng) : 0;
    }
    double t = prng_below(prng, 16) ? between(prng, 0, 1) : (double)prng_below(prng, 2);
    place_contact(prng, query->kind, beta, gamma, 0, x);
    move_through(prng, (const double(*)[3])x, t, 0, query);
}

/* Height of the vertex over a face that turns, or of one edge over another: a parabola
 * with its least value near 0. (t, y, 1/4 + c - t) and a face with corners 0, (1, 0, -t),
 * (0, 1, 0). */
static void make_grazing(struct prng *prng, struct eng_query *query)
{
    double c = prng_below(prng, 3) ? small(prng) : 0;
    double y0 = between(prng, -0.25, 0.75);
    double y1 = between(prng, -0.25, 0.75);
    const double v[2][3] = {{0, y0, 0.25 + c}, {1, y1, -0.75 + c}};
    for (int end = 0; end < 2; end++) {
        double(*x)[3] = query->x[end];
        int face = query->kind == PCCD_VF ? 1 : 0;
        int vertex = query->kind == PCCD_VF ? 0 : 2;
        memset(x, 0, sizeof query->x[end]);
        memcpy(x[vertex], v[end], sizeof x[vertex]);
        x[face + 1][0] = 1;
        x[face + 1][2] = -end;
        if (query->kind == PCCD_VF) {
            x[3][1] = 1;
        } else {
            memcpy(x[3], v[end], sizeof x[3]);
            x[3][1] -= 1;
        }
    }
}

static void make_resting(struct prng *prng, struct eng_query *query)
{
    double x[4][3];
    double way[3] = {between(prng, -2, 2), between(prng, -2, 2), between(prng, -2, 2)};
    double amount = (double)prng_below(prng, 2);
    double shiver = prng_below(prng, 2) ? small(prng) : 0;
    place_contact(prng, query->kind, between(prng, -0.2, 1.2), between(prng, -0.2, 1.2),
                  prng_below(prng, 2) ? 0.125 : 0, x);
    for (int i = 0; i < 12; i++) {
        query->x[0][i / 3][i % 3] = x[i / 3][i % 3];
        query->x[1][i / 3][i % 3] =
            x[i / 3][i % 3] + amount * way[i % 3] + shiver * between(prng, -1, 1);
    }
}

/* The powers belong to the axes, to the points, or to single coordinates. */
static void make_spread(struct prng *prng, struct eng_query *query)
{
    int exponents[3];
    uint64_t how = prng_below(prng, 3);
    int least = prng_below(prng, 8) == 0 ? -1070 : -300;
    make_snapped(prng, query);
    for (int k = 0; k < 3; k++) {
        exponents[k] = least + (int)prng_below(prng, (uint64_t)(56 - least));
    }
    for (int i = 0; i < 24; i++) {
        double *x = &query->x[i / 12][i / 3 % 4][i % 3];
        int which = how == 0 ? i % 3 : how == 1 ? i / 3 % 3 : (int)prng_below(prng, 3);
        *x = ldexp(*x, exponents[which]);
    }
}

static void make_family(struct prng *prng, enum fuzz_family family,
                        struct eng_query *query)
{
    switch (family) {
    case FUZZ_SNAPPED:
        make_snapped(prng, query);
        break;
    case FUZZ_COPLANAR:
        make_coplanar(prng, query);
        break;
    case FUZZ_SLIVER:
        make_sliver(prng, query);
        break;
    case FUZZ_PLANTED:
        make_planted(prng, query);
        break;
    case FUZZ_NEAR:
        make_near(prng, query);
        break;
    case FUZZ_CROSSING:
    case FUZZ_RIM:
        make_crossing(prng, family == FUZZ_RIM, query);
        break;
    case FUZZ_GRAZING:
        make_grazing(prng, query);
        break;
    case FUZZ_RESTING:
        make_resting(prng, query);
        break;
    case FUZZ_SPREAD:
        make_spread(prng, query);
        break;
    default:
        make_random(prng, query);
    }
}

/* The sums are rounded: what was exact may be so no longer. */
static void move_away(struct prng *prng, struct eng_query *query)
{
    double offset[3];
    for (int k = 0; k < 3; k++) {
        offset[k] = ldexp(integer(prng, 7), (int)prng_below(prng, 50));
    }
    for (int i = 0; i < 24; i++) {
        query->x[i / 12][i / 3 % 4][i % 3] += offset[i % 3];
    }
}

static void turn(struct prng *prng, struct eng_query *query)
{
    uint64_t by = prng_below(prng, 3);
    double sign = prng_below(prng, 2) ? 1 : -1;
    struct eng_query from = *query;
    for (int i = 0; i < 24; i++) {
        query->x[i / 12][i / 3 % 4][((uint64_t)i + by) % 3] =
            sign * from.x[i / 12][i / 3 % 4][i % 3];
    }
}

/* Magnitudes of the largest and of the smallest coordinate that is not 0. */
static void magnitudes(const struct eng_query *query, int *high, int *low)
{
    *high = -2000;
    *low = 2000;
    for (int i = 0; i < 24; i++) {
        double x = query->x[i / 12][i / 3 % 4][i % 3];
        int exponent;
        if (x != 0) {
            frexp(x, &exponent);
            *high = exponent > *high ? exponent : *high;
            *low = exponent < *low ? exponent : *low;
        }
    }
}

void fuzz_query_scale(struct prng *prng, struct eng_query *query)
{
    int high;
    int low;
    magnitudes(query, &high, &low);
    /* 2^59 < 1e18; 53 bits above the last denormal. */
    int most = 59 - high;
    int least = -1074 + 54 - low;
    if (prng_below(prng, 8) != 0) { /* seldom as far as it goes */
        most = most < 30 ? most : 30;
        least = least > -60 ? least : -60;
    }
    if (high < low || least > most) {
        return;
    }
    int exponent = least + (int)prng_below(prng, (uint64_t)(most - least + 1));
    for (int i = 0; i < 24; i++) {
        double *x = &query->x[i / 12][i / 3 % 4][i % 3];
        *x = ldexp(*x, exponent);
    }
}

static void swap(struct eng_query *query, int a, int b)
{
    double keep[3];
    for (int end = 0; end < 2; end++) {
        memcpy(keep, query->x[end][a], sizeof keep);
        memcpy(query->x[end][a], query->x[end][b], sizeof keep);
        memcpy(query->x[end][b], keep, sizeof keep);
    }
}

void fuzz_query_reorder(struct prng *prng, struct eng_query *query)
{
    bool is_vf = query->kind == PCCD_VF;
    if (prng_below(prng, 2)) {
        swap(query, is_vf ? 1 : 0, is_vf ? 2 : 1);
    }
    if (prng_below(prng, 2)) {
        swap(query, 2, 3);
    }
    if (prng_below(prng, 2)) {
        swap(query, is_vf ? 1 : 0, is_vf ? 3 : 2);
        if (!is_vf) {
            swap(query, 1, 3);
        }
    }
}

void fuzz_query_reverse(struct eng_query *query)
{
    double keep[4][3];
    memcpy(keep, query->x[0], sizeof keep);
    memcpy(query->x[0], query->x[1], sizeof keep);
    memcpy(query->x[1], keep, sizeof keep);
}

void fuzz_query_make(struct prng *prng, enum fuzz_family family, enum pccd_kind kind,
                     struct eng_query *query)
{
    query->kind = kind;
    make_family(prng, family, query);
    if (prng_below(prng, 4) == 0) {
        move_away(prng, query);
    }
    if (prng_below(prng, 2)) {
        turn(prng, query);
    }
    if (prng_below(prng, 4) == 0) {
        fuzz_query_scale(prng, query);
    }
    if (prng_below(prng, 2)) {
        fuzz_query_reorder(prng, query);
    }
    if (prng_below(prng, 2)) {
        fuzz_query_reverse(query);
    }
    for (int i = 0; i < 24; i++) {
        double *x = &query->x[i / 12][i / 3 % 4][i % 3];
        *x = fmax(-LIMIT, fmin(LIMIT, *x));
    }
}

const char *fuzz_family_name(enum fuzz_family family)
{
    static const char *const names[FUZZ_FAMILIES] = {
        "random",   "snapped", "coplanar", "sliver",  "planted", "near",
        "crossing", "rim",     "grazing",  "resting", "spread"};
    return names[family];
}

enum fuzz_family fuzz_family_some(struct prng *prng)
{
    /* A thousand; where most queries take exact arithmetic, of the engine or of the
     * judge, a query takes up to a hundred times as long as a random one. */
    static const unsigned weights[FUZZ_FAMILIES] = {
        [FUZZ_RANDOM] = 312,   [FUZZ_SNAPPED] = 50, [FUZZ_COPLANAR] = 30,
        [FUZZ_SLIVER] = 310,   [FUZZ_PLANTED] = 50, [FUZZ_NEAR] = 15,
        [FUZZ_CROSSING] = 212, [FUZZ_RIM] = 6,      [FUZZ_GRAZING] = 6,
        [FUZZ_RESTING] = 6,    [FUZZ_SPREAD] = 3};
    uint64_t left = prng_below(prng, 1000);
    int family = 0;
    while (family < FUZZ_FAMILIES - 1 && left >= weights[family]) {
        left -= weights[family++];
    }
    return (enum fuzz_family)family;
}

void fuzz_query_write(FILE *file, const struct eng_query *query, double tolerance,
                      double t_end)
{
    fprintf(file, "%s %a %a", query->kind == PCCD_VF ? "vf" : "ee", tolerance, t_end);
    for (int i = 0; i < 24; i++) {
        fprintf(file, " %a", query->x[i / 12][i / 3 % 4][i % 3]);
    }
    fputc('\n', file);
}

bool fuzz_query_read(FILE *file, struct eng_query *query, double *tolerance,
                     double *t_end)
{
    char kind[3];
    if (fscanf(file, "%2s %la %la", kind, tolerance, t_end) != 3) {
        return false;
    }
    query->kind = strcmp(kind, "vf") == 0 ? PCCD_VF : PCCD_EE;
    for (int i = 0; i < 24; i++) {
        if (fscanf(file, "%la", &query->x[i / 12][i / 3 % 4][i % 3]) != 1) {
            return false;
        }
    }
    return true;
}

/* eng_case.c - elementary tests with known answers, from many sides. */
#include "eng_case.h"

struct eng_exact *case_exact(void)
{
    static struct eng_exact exact;
    static bool ready;
    if (!ready) {
        assert_ok(eng_exact_init(&exact));
        ready = true;
    }
    return &exact;
}

int case_end(void **state)
{
    (void)state;
    eng_exact_deinit(case_exact());
    return 0;
}

struct eng_query case_query(enum pccd_kind kind, const double x0[4][3],
                            const double x1[4][3])
{
    struct eng_query query = {.kind = kind};
    memcpy(query.x[0], x0, sizeof query.x[0]);
    memcpy(query.x[1], x1, sizeof query.x[1]);
    return query;
}

unsigned case_order_count(enum pccd_kind kind)
{
    return kind == PCCD_VF ? 6 : 8;
}

struct eng_query case_order(const struct eng_query *query, unsigned order)
{
    static const int faces[6][4] = {{0, 1, 2, 3}, {0, 2, 3, 1}, {0, 3, 1, 2},
                                    {0, 1, 3, 2}, {0, 3, 2, 1}, {0, 2, 1, 3}};
    int points[4];
    if (query->kind == PCCD_VF) {
        memcpy(points, faces[order], sizeof points);
    } else {
        for (int i = 0; i < 4; i++) {
            int edge = (i / 2) ^ (order & 1 ? 1 : 0);
            int end = (i % 2) ^ (order >> (1 + i / 2) & 1 ? 1 : 0);
            points[i] = 2 * edge + end;
        }
    }
    struct eng_query out = {.kind = query->kind};
    for (int i = 0; i < 8; i++) {
        memcpy(out.x[i / 4][i % 4], query->x[i / 4][points[i % 4]], sizeof out.x[0][0]);
    }
    return out;
}

struct eng_query case_reversed(const struct eng_query *query)
{
    return case_query(query->kind, query->x[1], query->x[0]);
}

/* Point `i` at time t. */
static void point_at(const struct eng_query *query, int i, double t, double out[3])
{
    for (int k = 0; k < 3; k++) {
        out[k] = (1 - t) * query->x[0][i][k] + t * query->x[1][i][k];
    }
}

/* Largest distance that any two points have or travel: what errors are measured by. */
static double extent(const struct eng_query *query)
{
    double extent = 0;
    for (int i = 0; i < 64; i++) {
        for (int k = 0; k < 3; k++) {
            double d = query->x[i / 32][i / 8 % 4][k] - query->x[i / 4 % 2][i % 4][k];
            extent = fmax(extent, fabs(d));
        }
    }
    return extent;
}

static void check_params(const struct eng_query *query, const struct eng_hit *hit)
{
    double x[4][3];
    double u = (double)hit->param[0];
    double v = (double)hit->param[1];
    bool is_vf = query->kind == PCCD_VF;
    assert_true(u >= -1e-6 && v >= -1e-6);
    assert_true(is_vf ? u + v <= 1 + 1e-6 : u <= 1 + 1e-6 && v <= 1 + 1e-6);
    for (int i = 0; i < 4; i++) {
        point_at(query, i, 0.5 * (hit->toi + hit->toi_hi), x[i]);
    }
    for (int k = 0; k < 3; k++) {
        double first = is_vf ? x[0][k] : x[0][k] + u * (x[1][k] - x[0][k]);
        double second = is_vf
                            ? x[1][k] + u * (x[2][k] - x[1][k]) + v * (x[3][k] - x[1][k])
                            : x[2][k] + v * (x[3][k] - x[2][k]);
        double allowed = 4 * (hit->toi_hi - hit->toi) + 4e-7;
        assert_true(fabs(first - second) <= allowed * extent(query));
    }
}

void case_check_form(const struct eng_query *query, double tolerance,
                     const struct eng_hit *hit)
{
    assert_true(hit->flags & PCCD_PROVED);
    assert_int_equal(hit->flags & ~(unsigned)(PCCD_PROVED | PCCD_INITIAL), 0);
    assert_true(0 <= hit->toi && hit->toi <= hit->toi_hi && hit->toi_hi <= 1);
    assert_true(hit->toi_hi - hit->toi <= tolerance);
    bool initial = eng_exact_moment(case_exact(), query, 0).touching;
    assert_int_equal((hit->flags & PCCD_INITIAL) != 0, initial);
    assert_true(!initial || hit->toi_hi == 0);
    double length2 = 0;
    for (int k = 0; k < 3; k++) {
        length2 += (double)hit->normal[k] * (double)hit->normal[k];
    }
    assert_true(length2 == 0 || fabs(length2 - 1) < 1e-6);
    check_params(query, hit);
}

static void check_one(const struct eng_query *query, double tolerance, double t)
{
    struct eng_hit hit;
    bool found = eng_solve(query, tolerance, 1, case_exact(), &hit);
    assert_int_equal(found, t <= 1);
    if (found) {
        case_check_form(query, tolerance, &hit);
        assert_true(hit.toi <= t && t <= hit.toi_hi);
    }
}

/* Axes turned, then mirrored: a different order of operations for the same shape. */
static struct eng_query turned(const struct eng_query *query, int turn)
{
    struct eng_query out = *query;
    for (int i = 0; i < 24; i++) {
        double x = query->x[i / 12][i / 3 % 4][i % 3];
        out.x[i / 12][i / 3 % 4][(i + turn) % 3] = turn & 4 ? -x : x;
    }
    return out;
}

void case_check(const struct eng_query *query, double t)
{
    static const int exponents[] = {-900, -400, -149, -20, 3, 50};
    static const double tolerances[] = {1e-12, 1e-9, 1e-3, 0.3, 1};
    for (unsigned order = 0; order < case_order_count(query->kind); order++) {
        struct eng_query same = case_order(query, order);
        for (int turn = 0; turn < 6; turn++) {
            struct eng_query other = turned(&same, turn);
            check_one(&other, 1e-6, t);
        }
        for (size_t i = 0; i < sizeof exponents / sizeof *exponents; i++) {
            struct eng_query other = same;
            kit_place(&other, ldexp(1, exponents[i]), 0);
            check_one(&other, 1e-6, t);
        }
        for (size_t i = 0; i < sizeof tolerances / sizeof *tolerances; i++) {
            check_one(&same, tolerances[i], t);
        }
        struct eng_query back = case_reversed(&same);
        struct eng_hit hit;
        assert_int_equal(eng_solve(&back, 1e-6, 1, case_exact(), &hit), t <= 1);
    }
}

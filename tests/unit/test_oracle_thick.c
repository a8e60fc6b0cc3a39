/* test_oracle_thick.c - the oracle of thick features. */
#include "cases.h"
#include "oracle_distance.h"
#include "oracle_thick.h"
#include "prng.h"
#include "thick_cases.h"

static struct oracle_thick thick_of(const struct thick_case *made)
{
    return (struct oracle_thick){.points_a = made->points_a,
                                 .points_b = made->points_b,
                                 .p = made->p,
                                 .radius = {made->radius},
                                 .approach = made->approach};
}

/* If it failed, the oracle would be no truth to compare the engine with. */
CASE(thick__first_times_are_those_worked_out_by_hand)
{
    for (size_t i = 0; i < thick_case_count; i++) {
        const struct thick_case *made = &thick_cases[i];
        struct oracle_thick thick = thick_of(made);
        struct oracle_first *first = oracle_thick_first_new(&thick);
        if (oracle_thick_is_inside(&thick) != made->is_inside ||
            (first != NULL) != made->hits) {
            fail_msg("%s", made->name);
        }
        if (first) {
            mpq_t lo;
            mpq_t hi;
            mpq_t due;
            mpq_inits(lo, hi, due, NULL);
            mpq_set_si(due, made->num, made->den);
            oracle_first_bracket(first, 80, lo, hi);
            if (mpq_cmp(lo, due) > 0 || mpq_cmp(due, hi) > 0) {
                fail_msg("%s: between %g and %g", made->name, mpq_get_d(lo),
                         mpq_get_d(hi));
            }
            mpq_clears(lo, hi, due, NULL);
        }
        oracle_first_free(first);
    }
}

/* If it failed, three radii would not be added exactly. */
CASE(thick__radius_is_an_exact_sum)
{
    static const double p[8][3] = {{0, 0, 0}, {4, 0, 0}, {0}, {0}, {0, 0, 0}, {1, 0, 0}};
    struct oracle_thick thick = {
        .points_a = 1, .points_b = 1, .p = p, .radius = {0x1p-300, 1, 0}};
    struct oracle_first *first = oracle_thick_first_new(&thick);
    assert_non_null(first);
    assert_int_equal(oracle_first_compare(first, 1), -1);
    oracle_first_free(first);
}

#define STEPS 16

/* The features at time i / STEPS, as a pair of four points. */
static enum oracle_kind at_time(const struct oracle_thick *thick, int i, double x[4][3])
{
    static const int as_face[2][4] = {{0, 1, 1, 1}, {0, 1, 2, 2}};
    for (int k = 0; k < 12; k++) {
        int point = k / 3;
        if (thick->points_a == 1 && thick->points_b < 3) {
            point = as_face[thick->points_b - 1][k / 3];
        }
        x[k / 3][k % 3] = thick->p[point][k % 3] * (STEPS - i) / STEPS +
                          thick->p[4 + point][k % 3] * i / STEPS;
    }
    return thick->points_a == 1 ? ORACLE_VF : ORACLE_EE;
}

static void make_grid(struct prng *prng, struct oracle_thick *thick, double p[8][3])
{
    static const int points[4][2] = {{1, 1}, {1, 2}, {1, 3}, {2, 2}};
    uint64_t kind = prng_below(prng, 4);
    uint64_t size = 1 + prng_below(prng, 5);
    for (int i = 0; i < 24; i++) {
        p[i / 3][i % 3] = (double)prng_below(prng, 2 * size + 1) - (double)size;
        if (i >= 12 && prng_below(prng, 3) == 0) {
            p[i / 3][i % 3] = p[i / 3 - 4][i % 3];
        }
    }
    *thick = (struct oracle_thick){
        .points_a = points[kind][0], .points_b = points[kind][1], .p = (void *)p};
    for (int i = 0; i < 3; i++) {
        thick->radius[i] = (double)prng_below(prng, 5) / 4;
    }
}

/* If it failed, a first time would be too late, too early, or missing: on a grid, places
 * at sixteenths of the step are numbers, so another definition of the distance can be
 * asked there. */
CASE(thick__first_time_is_where_the_distance_is_r)
{
    struct prng prng = {prng_seed()};
    int hits = 0;
    for (int i = 0; i < 3000; i++) {
        double p[8][3];
        struct oracle_thick thick;
        make_grid(&prng, &thick, p);
        struct oracle_first *first = oracle_thick_first_new(&thick);
        double r = thick.radius[0] + thick.radius[1] + thick.radius[2];
        for (int k = 0; k <= STEPS; k++) {
            double x[4][3];
            enum oracle_kind kind = at_time(&thick, k, x);
            bool is_within = oracle_distance_within(kind, (const double(*)[3])x, r);
            int side =
                first ? oracle_first_compare(first, (double)k / STEPS) : 1; /* later */
            assert_true(is_within ? side <= 0 : side != 0);
            if (k == 0) {
                assert_int_equal(is_within, oracle_thick_is_inside(&thick));
                assert_int_equal(is_within, side <= 0);
            }
        }
        hits += first != NULL;
        oracle_first_free(first);
    }
    assert_in_range(hits, 1000, 2900);
}

/* If it failed, features without thickness would meet at other times than contacts. */
CASE(thick__without_radius_is_contact)
{
    struct prng prng = {prng_seed() + 1};
    int hits = 0;
    for (int i = 0; i < 2000; i++) {
        double p[8][3];
        struct oracle_thick thick;
        make_grid(&prng, &thick, p);
        if (thick.points_a + thick.points_b < 4) {
            continue;
        }
        memset(thick.radius, 0, sizeof thick.radius);
        enum oracle_kind kind = thick.points_a == 1 ? ORACLE_VF : ORACLE_EE;
        struct oracle_first *first = oracle_thick_first_new(&thick);
        struct oracle_first *due = oracle_first_new(kind, (const double(*)[3])p);
        assert_int_equal(first != NULL, due != NULL);
        for (int k = 0; first && k <= 8; k++) {
            assert_int_equal(oracle_first_compare(first, k / 8.0),
                             oracle_first_compare(due, k / 8.0));
        }
        hits += first != NULL;
        oracle_first_free(first);
        oracle_first_free(due);
    }
    assert_in_range(hits, 100, 1900);
}

/* If it failed, a pair that begins inside would have another threshold than s times its
 * distance. */
CASE(thick__approach_is_to_a_part_of_the_first_distance)
{
    struct prng prng = {prng_seed() + 2};
    for (int i = 0; i < 500; i++) {
        /* At t = 0 all is in two planes, `height` apart and as near as that. */
        double p[8][3];
        struct oracle_thick thick;
        make_grid(&prng, &thick, p);
        int points = thick.points_a + thick.points_b;
        double height = (double)(1 + prng_below(&prng, 5));
        for (int k = 0; k < points; k++) {
            p[k][2] = k < thick.points_a ? height : 0;
        }
        p[0][0] = p[thick.points_a][0];
        p[0][1] = p[thick.points_a][1];
        memset(thick.radius, 0, sizeof thick.radius);
        thick.radius[0] = height;
        thick.approach = 0.75;
        assert_true(oracle_thick_is_inside(&thick));
        struct oracle_first *first = oracle_thick_first_new(&thick);
        thick.approach = 0;
        thick.radius[0] = 0.75 * height;
        struct oracle_first *due = oracle_thick_first_new(&thick);
        assert_int_equal(first != NULL, due != NULL);
        for (int k = 0; first && k <= 8; k++) {
            assert_int_equal(oracle_first_compare(first, k / 8.0),
                             oracle_first_compare(due, k / 8.0));
        }
        oracle_first_free(first);
        oracle_first_free(due);
    }
}

/* test_eng_thick.c - the elementary test of thick features. */
#include "eng_case.h"
#include "memory.h"
#include "thick.h"
#include "thick_cases.h"

#define TOLERANCE 1e-6

static struct eng_thick *thick_scratch(void)
{
    static struct eng_thick thick;
    if (thick.exact.block == NULL) {
        assert_ok(eng_thick_init(&thick));
    }
    return &thick;
}

static uint32_t kind_of(int points_a, int points_b)
{
    return points_a == 2   ? PCCD_EE
           : points_b == 3 ? PCCD_VF
           : points_b == 2 ? (uint32_t)PCCD_VE
                           : (uint32_t)PCCD_VV;
}

static struct eng_thick_query query_of(const struct thick_case *made)
{
    struct eng_thick_query query = {.radius = {made->radius}, .approach = made->approach};
    int used = made->points_a + made->points_b;
    query.query.kind = (enum pccd_kind)kind_of(made->points_a, made->points_b);
    for (int i = 0; i < 8; i++) {
        int point = i % 4 < used ? i % 4 : used - 1;
        memcpy(query.query.x[i / 4][i % 4], made->p[i / 4 * 4 + point],
               sizeof made->p[0]);
    }
    return query;
}

static bool solve(const struct eng_thick_query *query, double tolerance, double t_end,
                  struct eng_hit *hit)
{
    return eng_thick_solve(thick_scratch(), case_exact(), query, tolerance, t_end, hit);
}

/* Check that the verdict is the one that is due, and that the times are around the first
 * one. */
static void check(const struct thick_case *made, const struct eng_thick_query *query,
                  double tolerance)
{
    struct eng_hit hit;
    bool hits = solve(query, tolerance, 1, &hit);
    double due = (double)made->num / (double)made->den;
    if (hits != made->hits) {
        fail_msg("%s: %s", made->name, hits ? "invented" : "missed");
    }
    if (!hits) {
        return;
    }
    bool is_initial = made->is_inside && due == 0;
    if (((hit.flags & PCCD_INITIAL) != 0) != is_initial ||
        (hit.flags & PCCD_PROVED) == 0 ||
        (((hit.flags & PCCD_INSIDE) != 0) != (made->is_inside && query->approach > 0))) {
        fail_msg("%s: flags %u", made->name, hit.flags);
    }
    if (!(hit.toi <= due && due <= hit.toi_hi && hit.toi_hi - hit.toi <= tolerance)) {
        fail_msg("%s: %a .. %a", made->name, hit.toi, hit.toi_hi);
    }
    assert_false(hit.toi > 0 && solve(query, tolerance, nextafter(hit.toi, 0), &hit));
}

static void swap_points(struct eng_thick_query *query, int i, int j)
{
    for (int end = 0; end < 2; end++) {
        double kept[3];
        memcpy(kept, query->query.x[end][i], sizeof kept);
        memcpy(query->query.x[end][i], query->query.x[end][j], sizeof kept);
        memcpy(query->query.x[end][j], kept, sizeof kept);
    }
}

static void scale(struct eng_thick_query *query, double factor)
{
    for (int i = 0; i < 24; i++) {
        query->query.x[i / 12][i / 3 % 4][i % 3] *= factor;
    }
    for (int i = 0; i < 3; i++) {
        query->radius[i] *= factor;
    }
}

/* If it failed: a pair would come within r unseen, or at another time, or that would
 * depend on the order of its points, on units, or on who decides. */
CASE(thick__times_are_those_worked_out_by_hand)
{
    static const double scales[] = {1, 0x1p-60, 0x1p-1};
    static const double tolerances[] = {TOLERANCE, 1e-12, 1};
    for (size_t i = 0; i < thick_case_count; i++) {
        const struct thick_case *made = &thick_cases[i];
        for (int n = 0; n < 18; n++) {
            struct eng_thick_query query = query_of(made);
            thick_scratch()->first = n % 2 ? ENG_THICK_BY_INTEGERS : ENG_THICK_BY_DOUBLES;
            scale(&query, scales[n / 2 % 3]);
            if (n / 6 > 0 && made->points_b > 1) {
                int first = made->points_a;
                swap_points(&query, first, first + n / 6 % made->points_b);
                if (made->points_b == 2) {
                    memcpy(query.query.x[0][first + 2 < 4 ? first + 2 : 3],
                           query.query.x[0][first + 1], sizeof query.query.x[0][0]);
                    memcpy(query.query.x[1][first + 2 < 4 ? first + 2 : 3],
                           query.query.x[1][first + 1], sizeof query.query.x[1][0]);
                }
            }
            check(made, &query, tolerances[n / 6]);
        }
    }
    thick_scratch()->first = ENG_THICK_BY_DOUBLES;
}

/* If it failed: objects without thickness would get other bytes than they do today. */
CASE(thick__without_radius_has_the_bytes_of_contact)
{
    int hits = 0;
    for (size_t i = 0; i < thick_case_count; i++) {
        struct eng_thick_query query = query_of(&thick_cases[i]);
        if (thick_cases[i].points_a + thick_cases[i].points_b < 4) {
            continue;
        }
        for (double shift = -2; shift <= 2; shift += 0.5) {
            struct eng_hit hit;
            struct eng_hit due;
            memset(query.radius, 0, sizeof query.radius);
            query.query.x[1][0][2] = query.query.x[0][0][2] * shift;
            bool meets = eng_solve(&query.query, TOLERANCE, 1, case_exact(), &due);
            assert_int_equal(solve(&query, TOLERANCE, 1, &hit), meets);
            if (meets) {
                assert_int_equal(hit.flags, due.flags);
                assert_memory_equal(&hit.toi, &due.toi, sizeof hit.toi);
                assert_memory_equal(&hit.toi_hi, &due.toi_hi, sizeof hit.toi_hi);
                assert_memory_equal(hit.param, due.param, sizeof hit.param);
                assert_memory_equal(hit.normal, due.normal, sizeof hit.normal);
                hits++;
            }
        }
    }
    assert_in_range(hits, 20, 1000);
}

/* Points meet at t = 1, or are there as far apart as the noise that others have. The
 * first time, of those that meet, is in the bracket, as the oracle says. */
static const struct {
    uint32_t kind;
    double x[2][4][3];
    double radius[2];
    double approach;
    bool hits;
    double lo;
    double hi;
} noisy[] = {
    {PCCD_EE,
     {{{0, 0, -.706}, {-1, 7.04e-7, -8e-7}, {0, -6e-7, -.36}, {-1.8, -9.476e-7, 0}},
      {{-1, 0, 0}, {-1, 7.04e-7, -8e-7}, {-1, 0, 0}, {-1, 0, 0}}},
     {.25, .25},
     .3,
     true,
     .9999989469,
     .999998948},
    {PCCD_EE,
     {{{8e-8, 0, 1},
       {-1, 1e-8, -1.00000006},
       {-2e-8, 1.00000006, -7e-8},
       {-1.00000001, -1e-8, -1}},
      {{-1, 8e-8, 1},
       {-.99999994, 8e-8, 1},
       {-1.00000007, 8e-8, 1},
       {-.99999999, 8e-8, 1}}},
     {.25, .25},
     .3,
     true,
     .9999999956,
     .9999999966},
    {.kind = PCCD_VF,
     .x = {{{0, -.99999996, 0},
            {-1.00000009, 0, 1},
            {-7e-8, -1, 1e-8},
            {.99999998, -9e-8, 0}},
           {{-9e-8, -8e-8, 1}, {1, -1, -1}, {1, 0, 1.00000003}, {1, -1, -1}}},
     .radius = {.25, .5},
     .approach = .3},
    {.kind = PCCD_EE,
     .x = {{{1.00000009, 0, -.99999995},
            {0, 6e-8, .99999996},
            {1.00000007, 0, 1},
            {0, 0, 0}},
           {{-2e-8, 0, 0}, {-2e-8, 0, 0}, {0, 2e-8, -8e-8}, {0, -2e-8, 0}}},
     .radius = {.25, .1},
     .approach = 0x1.031e1881b8116p-3},
};

/* If it failed: where edges shrink to a point, or nearly, a contact would be said that
 * is none, or nobody would know. */
CASE(thick__what_shrinks_to_a_point_is_decided)
{
    for (size_t i = 0; i < 2 * (sizeof noisy / sizeof *noisy); i++) {
        struct eng_thick_query query = {.approach = noisy[i / 2].approach};
        struct eng_hit hit;
        query.query.kind = (enum pccd_kind)noisy[i / 2].kind;
        memcpy(query.query.x, noisy[i / 2].x, sizeof query.query.x);
        memcpy(query.radius, noisy[i / 2].radius, sizeof noisy[i / 2].radius);
        thick_scratch()->first = (enum eng_thick_stage)(i % 2);
        assert_int_equal(solve(&query, TOLERANCE, 1, &hit), noisy[i / 2].hits);
        if (noisy[i / 2].hits) {
            assert_int_equal(hit.flags, PCCD_PROVED | PCCD_INSIDE);
            assert_true(hit.toi >= noisy[i / 2].lo && hit.toi_hi <= noisy[i / 2].hi);
        }
    }
    thick_scratch()->first = ENG_THICK_BY_DOUBLES;
}

static void assert_direction(const struct eng_hit *hit, double x, double y, double z)
{
    assert_true(fabs((double)hit->normal[0] - x) < 1e-5);
    assert_true(fabs((double)hit->normal[1] - y) < 1e-5);
    assert_true(fabs((double)hit->normal[2] - z) < 1e-5);
}

static const struct thick_case *case_named(const char *name)
{
    for (size_t i = 0; i < thick_case_count; i++) {
        if (strcmp(thick_cases[i].name, name) == 0) {
            return &thick_cases[i];
        }
    }
    fail_msg("no case %s", name);
    return NULL;
}

/* If it failed: a response would push features apart in another direction. */
CASE(thick__nearest_points_are_described)
{
    struct eng_hit hit;
    struct eng_thick_query query = query_of(case_named("vertex above a face"));
    assert_true(solve(&query, TOLERANCE, 1, &hit));
    assert_direction(&hit, 0, 0, 1);
    assert_true(hit.param[0] == 0.25f && hit.param[1] == 0.25f);
    query = query_of(case_named("edges that cross, at a distance"));
    assert_true(solve(&query, TOLERANCE, 1, &hit));
    assert_direction(&hit, 0, 0, 1);
    assert_true(hit.param[0] == 0.5f && hit.param[1] == 0.5f);
    query = query_of(case_named("vertex above the middle of an edge"));
    assert_true(solve(&query, TOLERANCE, 1, &hit));
    assert_direction(&hit, 0, 0, 1);
    assert_true(hit.param[0] == 0 && hit.param[1] == 0.5f);
    query = query_of(case_named("vertices, head on"));
    assert_true(solve(&query, TOLERANCE, 1, &hit));
    assert_direction(&hit, -1, 0, 0);
    query = query_of(case_named("vertices, begin inside at distance 0"));
    assert_true(solve(&query, TOLERANCE, 1, &hit));
    assert_direction(&hit, 0, 0, 0);
}

/* If it failed: times would not be cells, whose bytes depend on the first time alone. */
CASE(thick__cells_follow_each_other)
{
    for (int depth = 30; depth <= 40; depth++) {
        int64_t last = INT64_C(1) << depth;
        for (int64_t i = -1; i < 5; i++) {
            int64_t cell = i < 2 ? i : last - 5 + i;
            double begin = eng_thick_cell_begin(cell, depth);
            double end = eng_thick_cell_begin(cell + 1, depth);
            if (begin < 1) {
                assert_true(begin < end && end - begin <= ldexp(1, -depth));
                assert_int_equal(eng_thick_cell_of(begin, depth), cell);
                assert_int_equal(eng_thick_cell_of(nextafter(end, 0), depth), cell);
            }
        }
        assert_true(eng_thick_cell_begin(-1, depth) == 0);
        assert_true(eng_thick_cell_begin(last, depth) == 1);
    }
}

static uint64_t gmp_calls;

static void *count_alloc(size_t bytes)
{
    gmp_calls++;
    return malloc(bytes);
}

static void *count_realloc(void *block, size_t old_bytes, size_t bytes)
{
    (void)old_bytes;
    gmp_calls++;
    return realloc(block, bytes);
}

static void count_free(void *block, size_t bytes)
{
    (void)bytes;
    free(block);
}

/* Return a number of any exponent that there is. */
static double extreme(struct prng *random)
{
    double mantissa = prng_u32(random, 2) ? prng_between(random, -1, 1)
                                          : (double)prng_u32(random, 9) - 4;
    return ldexp(mantissa, (int)prng_u32(random, 1130) - 1074);
}

static void extreme_query(struct prng *random, struct eng_thick_query *query)
{
    memset(query, 0, sizeof *query);
    query->query.kind = (enum pccd_kind)prng_u32(random, 4);
    for (int i = 0; i < 24; i++) {
        double *x = &query->query.x[i / 12][i / 3 % 4][i % 3];
        *x = prng_u32(random, 4) ? extreme(random)
                                 : query->query.x[0][prng_u32(random, 4)][i % 3];
    }
    for (int i = 0; i < 2; i++) {
        query->radius[i] = fabs(extreme(random));
    }
    query->approach = prng_u32(random, 4) ? 0 : 0x1p-1022 + prng_between(random, 0, 1);
}

/* If it failed: GMP would end the process where there is no memory, or write beyond what
 * it was given. */
CASE(thick__decisions_allocate_nothing)
{
    struct eng_thick thick;
    struct prng random = {77};
    eng_alloc_set_ceiling(1);
    assert_int_equal(eng_thick_init(&thick), PCCD_E_NOMEM);
    eng_alloc_set_ceiling(UINT64_MAX);
    assert_ok(eng_thick_init(&thick));
    mp_set_memory_functions(count_alloc, count_realloc, count_free);
    gmp_calls = 0;
    thick.first = ENG_THICK_BY_INTEGERS;
    uint64_t count = eng_alloc_count();
    for (int i = 0; i < 3000; i++) {
        struct eng_thick_query query;
        struct eng_hit hit;
        extreme_query(&random, &query);
        (void)eng_thick_solve(&thick, case_exact(), &query, TOLERANCE, 1, &hit);
    }
    assert_int_equal(gmp_calls, 0);
    mp_set_memory_functions(NULL, NULL, NULL);
    assert_int_equal(eng_alloc_count(), count);
    eng_thick_deinit(&thick);
}

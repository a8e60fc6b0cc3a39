/* test_eng_plane.c - contacts within the plane of two axes. */
#include "eng_case.h"
#include "solve.h"

/* Points `first` to 3 but `odd` (4: none) get the coordinate of the others along a random
 * axis at both ends; `odd` lies on one side of them, or `crosses` over to the other.
 * `grid` 0: any numbers; else integers up to it. */
static struct eng_query plane_query(struct prng *random, enum pccd_kind kind,
                                    unsigned odd, bool crosses, uint32_t grid)
{
    struct eng_query query = {.kind = kind};
    unsigned axis = prng_u32(random, 3);
    for (unsigned end = 0; end < 2; end++) {
        double shared = prng_between(random, -3, 3);
        for (unsigned i = 0; i < 12; i++) {
            double x =
                grid > 0 ? prng_integer(random, grid) : prng_between(random, -1, 1);
            bool in_plane = i % 3 == axis && i / 3 != odd;
            query.x[end][i / 3][i % 3] = in_plane ? shared : x;
        }
        if (odd < 4) {
            double gap = prng_between(random, 0.1, 1);
            query.x[end][odd][axis] = shared + (crosses && end == 1 ? -gap : gap);
        }
    }
    return query;
}

/* Decide by the plane alone, compare with the truth, and count it in decided[]. */
static void decide(const struct eng_query *query, int decided[3])
{
    double l;
    double r;
    if (eng_exact_moment(case_exact(), query, 0).touching) {
        return;
    }
    enum eng_plane plane = eng_plane_first(query, 1e-6, &l, &r);
    decided[plane]++;
    if (plane == ENG_PLANE_MISS) {
        assert_false(eng_exact_meets(case_exact(), query, 0, 1));
    } else if (plane == ENG_PLANE_MEET) {
        assert_true(eng_exact_meets(case_exact(), query, l, r));
        assert_true(l == 0 || !eng_exact_meets(case_exact(), query, 0, l));
    }
}

/* Check that what the solver says of the query is the exact truth. Return whether it is a
 * contact. */
static bool check(const struct eng_query *query)
{
    struct eng_hit hit;
    bool found = eng_solve(query, 1e-6, 1, case_exact(), &hit);
    assert_int_equal(found, eng_exact_meets(case_exact(), query, 0, 1));
    if (!found) {
        return false;
    }
    case_check_form(query, 1e-6, &hit);
    if (hit.toi > 0) {
        assert_false(eng_exact_meets(case_exact(), query, 0, nextafter(hit.toi, 0)));
    }
    if (hit.toi < hit.toi_hi) {
        assert_true(eng_exact_meets(case_exact(), query, hit.toi, hit.toi_hi));
    }
    return true;
}

/* If it failed: meshes cut along an axis would have contacts missed, made up or late
 * where a point meets an edge in the plane of the cut. */
CASE(plane__rims_are_decided_exactly)
{
    struct prng random = {611};
    int hits = 0;
    uint64_t exact_before = case_exact()->queries;
    uint64_t exact_here = 0;
    int decided[3] = {0, 0, 0};
    enum { ROUNDS = 12000 };
    for (int round = 0; round < ROUNDS; round++) {
        enum pccd_kind kind = round % 2 ? PCCD_EE : PCCD_VF;
        unsigned odd = kind == PCCD_VF ? 1 + prng_u32(&random, 3) : prng_u32(&random, 4);
        struct eng_query query = plane_query(&random, kind, odd, false,
                                             round % 8 < 2 ? 1 + (uint32_t)round % 3 : 0);
        struct eng_hit hit;
        exact_before = case_exact()->queries;
        eng_solve(&query, 1e-6, 1, case_exact(), &hit);
        exact_here += round % 8 < 2 ? 0 : case_exact()->queries - exact_before;
        hits += check(&query);
        decide(&query, decided);
    }
    assert_in_range(hits, ROUNDS / 10, ROUNDS * 9 / 10);
    assert_true(decided[ENG_PLANE_MEET] > ROUNDS / 10);
    assert_true(decided[ENG_PLANE_MISS] > ROUNDS / 20);
    assert_in_range(exact_here, 0, ROUNDS / 50); /* in general position */
}

/* If it failed: a pair would be said to miss, or to meet at another time, that meets
 * where all of both features are in the plane for a moment. */
CASE(plane__a_point_that_crosses_it_decides_nothing)
{
    struct prng random = {614};
    for (int round = 0; round < 4000; round++) {
        enum pccd_kind kind = round % 2 ? PCCD_EE : PCCD_VF;
        unsigned odd = prng_u32(&random, 4);
        struct eng_query query =
            plane_query(&random, kind, odd, true, round % 8 < 2 ? 2 : 0);
        double l;
        double r;
        check(&query);
        if (round % 8 >= 2) {
            assert_int_equal(eng_plane_first(&query, 1e-6, &l, &r), ENG_PLANE_UNSURE);
        }
    }
}

/* If it failed: sheets that slide on a table would have contacts missed, made up or
 * late. */
CASE(plane__motion_within_the_plane_is_decided_exactly)
{
    struct prng random = {612};
    int hits = 0;
    int decided[3] = {0, 0, 0};
    enum { ROUNDS = 12000 };
    for (int round = 0; round < ROUNDS; round++) {
        enum pccd_kind kind = round % 2 ? PCCD_EE : PCCD_VF;
        uint32_t grid = round % 8 < 2 ? 1 + (uint32_t)round % 3 : 0;
        struct eng_query query = plane_query(&random, kind, 4, false, grid);
        hits += check(&query);
        decide(&query, decided);
    }
    assert_in_range(hits, ROUNDS / 10, ROUNDS * 9 / 10);
    assert_true(decided[ENG_PLANE_MEET] > ROUNDS / 10);
    assert_true(decided[ENG_PLANE_MISS] > ROUNDS / 20);
}

/* If it failed: a plane would be seen where coordinates differ in the last bit. */
CASE(plane__a_bit_beside_is_no_plane)
{
    struct prng random = {613};
    for (int round = 0; round < 2000; round++) {
        struct eng_query query =
            plane_query(&random, round % 2 ? PCCD_EE : PCCD_VF, 4, false, 0);
        double *x = query.x[round % 4 / 2][prng_u32(&random, 4)];
        double l;
        double r;
        for (int k = 0; k < 3; k++) {
            x[k] = nextafter(x[k], 4);
        }
        assert_int_equal(eng_plane_first(&query, 1e-6, &l, &r), ENG_PLANE_UNSURE);
        check(&query);
    }
}

CASES_WITH(NULL, case_end);

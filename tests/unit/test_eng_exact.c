/* test_eng_exact.c - exact answers about a moment and about a span. */
#include "eng_case.h"

#define ULP 0x1p-52

/* The configuration x at one end, in every order of its points, at several scales and at
 * both ends; the other end is somewhere else. */
static void check(enum pccd_kind kind, bool touching, const double x[4][3])
{
    static const double away[4][3] = {{9, 0, 1}, {-5, 2, 7}, {3, 3, 3}, {0, 8, -6}};
    static const int exponents[] = {-960, -300, 0, 50};
    for (int end = 0; end < 2; end++) {
        struct eng_query query = case_query(kind, end ? away : x, end ? x : away);
        for (unsigned order = 0; order < case_order_count(kind); order++) {
            for (size_t i = 0; i < sizeof exponents / sizeof *exponents; i++) {
                struct eng_query same = case_order(&query, order);
                kit_place(&same, ldexp(1, exponents[i]), 0);
                struct eng_moment moment = eng_exact_moment(case_exact(), &same, end);
                assert_int_equal(moment.touching, touching);
                assert_true(!touching || moment.side == 0);
            }
        }
    }
}

#define VF(touching, x, y, z)                                                            \
    check(PCCD_VF, touching,                                                             \
          (const double[4][3]){{x, y, z}, {0, 0, 0}, {1, 0, 0}, {0, 1, 0}})

/* If it failed: a vertex on a face would not touch it, or one beside it would. */
CASE(exact__vertex_on_face_to_one_ulp)
{
    VF(true, 0.25, 0.25, 0);
    VF(true, 0.1, 0.2, 0);
    VF(false, 0.25, 0.25, 0x1p-110); /* scaled down it is still there */
    VF(false, 0.25, 0.25, -0x1p-52);
    VF(true, 0, 0, 0);
    VF(true, 1, 0, 0);
    VF(true, 0.5, 0.5, 0);
    VF(true, 0.75, 0.25, 0);
    VF(false, 0.5, 0.5 + ULP / 2, 0);
    VF(true, 0.5, 0.5 - ULP / 4, 0);
    VF(true, 0.5, 0, 0);
    VF(false, 0.5, -0x1p-100, 0);
    VF(false, 1 + ULP, 0, 0);
}

/* If it failed: a face without area would be passed through by what lies on it. */
CASE(exact__collapsed_face_is_its_segment_or_point)
{
    check(PCCD_VF, true,
          (const double[4][3]){{1.5, 3, 0}, {0, 0, 0}, {1, 2, 0}, {2, 4, 0}});
    check(PCCD_VF, true,
          (const double[4][3]){{2, 4, 0}, {0, 0, 0}, {1, 2, 0}, {2, 4, 0}});
    check(PCCD_VF, true,
          (const double[4][3]){{1.5, 3, 0}, {1, 2, 0}, {1, 2, 0}, {2, 4, 0}});
    check(PCCD_VF, false,
          (const double[4][3]){
              {2 + 2 * ULP, 4 + 4 * ULP, 0}, {0, 0, 0}, {1, 2, 0}, {2, 4, 0}});
    check(PCCD_VF, false,
          (const double[4][3]){{1.5, 3 + 2 * ULP, 0}, {0, 0, 0}, {1, 2, 0}, {2, 4, 0}});
    check(PCCD_VF, true,
          (const double[4][3]){{1, 2, 3}, {1, 2, 3}, {1, 2, 3}, {1, 2, 3}});
    check(PCCD_VF, false,
          (const double[4][3]){{1, 2, 3 + 2 * ULP}, {1, 2, 3}, {1, 2, 3}, {1, 2, 3}});
}

#define EE(touching, ...)                                                                \
    check(PCCD_EE, touching, (const double[4][3]){{0, 0, 0}, {2, 0, 0}, __VA_ARGS__})

/* If it failed: edges that cross or meet end to end would not touch, or near ones
 * would. */
CASE(exact__edges_to_one_ulp)
{
    EE(true, {1, -1, 0}, {1, 1, 0});
    EE(true, {1, -1, -1}, {1, 2, 2});
    EE(true, {1, 0, 0}, {1, 1, 3});
    EE(true, {2, 0, 0}, {2, 1, 3});
    EE(false, {1, -1, 0}, {1, 1, 0x1p-52});
    EE(false, {1, 0x1p-100, 0}, {1, 1, 0});
    EE(false, {2 + 2 * ULP, -1, 0}, {2 + 2 * ULP, 1, 0});
    EE(false, {2 + 2 * ULP, 0, 0}, {3, 1, 1});
}

/* If it failed: parallel edges or points would be undecided. */
CASE(exact__parallel_and_collapsed_edges)
{
    EE(true, {1, 0, 0}, {3, 0, 0});
    EE(true, {-1, 0, 0}, {3, 0, 0});
    EE(true, {2, 0, 0}, {3, 0, 0});
    EE(false, {2 + 2 * ULP, 0, 0}, {3, 0, 0});
    EE(false, {1, 0x1p-60, 0}, {3, 0x1p-60, 0});
    EE(true, {0.5, 0, 0}, {0.5, 0, 0});
    EE(false, {0.5, 0x1p-60, 0}, {0.5, 0x1p-60, 0});
    check(PCCD_EE, true,
          (const double[4][3]){{3, 3, 3}, {3, 3, 3}, {3, 3, 3}, {3, 3, 3}});
    check(PCCD_EE, false,
          (const double[4][3]){{3, 3, 3}, {3, 3, 3}, {3, 3, 4}, {3, 3, 4}});
}

/* If it failed: meshes that continue each other would be said to be apart where they
 * hang together, or every such pair would take big integers. One ulp beside, it is not
 * that easy. */
CASE(exact__a_common_corner_touches)
{
    struct eng_exact *exact = case_exact();
    for (int kind = 0; kind < 2; kind++) {
        int split = kind == PCCD_VF ? 1 : 2;
        for (int pair = 0; pair < split * (4 - split); pair++) {
            struct eng_query query = {.kind = (enum pccd_kind)kind};
            for (int k = 0; k < 12; k++) {
                query.x[1][k / 3][k % 3] = query.x[0][k / 3][k % 3] = 0.1 * (k * k % 7);
            }
            int mine = pair % split;
            int other = split + pair / split;
            memcpy(query.x[0][mine], query.x[0][other], sizeof query.x[0][mine]);
            uint64_t before = exact->queries;
            struct eng_moment moment = eng_exact_moment(exact, &query, 0);
            assert_true(moment.touching && moment.side == 0);
            assert_int_equal(exact->queries, before);
            query.x[0][mine][2] = nextafter(query.x[0][mine][2], 9);
            eng_exact_moment(exact, &query, 0);
            assert_int_equal(exact->queries, before + 1);
        }
    }
}

/* If it failed: a crossing that begins at t = 0 would have no side, or the wrong one. */
CASE(exact__side_is_the_sign_of_the_determinant)
{
    const double heights[] = {5, 0x1p-1000, 0, -0x1p-1000, -5};
    const int sides[] = {1, 1, 0, -1, -1};
    for (int i = 0; i < 5; i++) {
        const double vf[4][3] = {{7, 7, heights[i]}, {0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
        const double ee[4][3] = {
            {0, 0, 0}, {1, 0, 0}, {0, 0, heights[i]}, {0, -1, heights[i]}};
        struct eng_query face = case_query(PCCD_VF, vf, vf);
        struct eng_query edge = case_query(PCCD_EE, ee, ee);
        for (int end = 0; end < 2; end++) {
            assert_int_equal(eng_exact_moment(case_exact(), &face, end).side, sides[i]);
            assert_int_equal(eng_exact_moment(case_exact(), &edge, end).side, sides[i]);
        }
    }
}

/* If it failed: the bracket of a contact would drift off the contact while it is
 * halved. */
CASE(exact__span_holds_a_known_contact_or_just_not)
{
    struct prng random = {70};
    for (int round = 0; round < 2000; round++) {
        struct eng_query query;
        unsigned eighths = prng_u32(&random, 9);
        double t = eighths / 8.0;
        kit_plant(&random, round % 2 ? PCCD_EE : PCCD_VF, eighths, &query);
        assert_true(eng_exact_meets(case_exact(), &query, 0, 1));
        if (t > 0) {
            assert_true(eng_exact_meets(case_exact(), &query, 0, t));
            assert_true(eng_exact_meets(case_exact(), &query, nextafter(t, 0), t));
        }
        if (t < 1) {
            assert_true(eng_exact_meets(case_exact(), &query, t, 1));
            assert_true(eng_exact_meets(case_exact(), &query, t, nextafter(t, 1)));
        }
    }
    const double start[4][3] = {{0.25, 0.25, 3}, {0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    const double end[4][3] = {{0.25, 0.25, -1}, {0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    struct eng_query fall = case_query(PCCD_VF, start, end); /* at 3/4 and never else */
    assert_true(eng_exact_meets(case_exact(), &fall, 0.75, 1));
    assert_true(eng_exact_meets(case_exact(), &fall, 0, 0.75));
    assert_false(eng_exact_meets(case_exact(), &fall, 0, nextafter(0.75, 0)));
    assert_false(eng_exact_meets(case_exact(), &fall, nextafter(0.75, 1), 1));
}

/* If it failed: numbers that the next query reuses would carry over from the last one. */
CASE(exact__scratch_carries_nothing_over)
{
    struct prng random = {71};
    for (int round = 0; round < 2000; round++) {
        struct eng_query query = {.kind = round % 2 ? PCCD_EE : PCCD_VF};
        struct eng_exact fresh;
        for (int i = 0; i < 24; i++) {
            query.x[i / 12][i / 3 % 4][i % 3] =
                ldexp(prng_integer(&random, 2), prng_u32(&random, 8) ? 0 : -200);
        }
        assert_ok(eng_exact_init(&fresh));
        struct eng_moment a = eng_exact_moment(case_exact(), &query, round / 2 % 2);
        struct eng_moment b = eng_exact_moment(&fresh, &query, round / 2 % 2);
        assert_int_equal(a.touching, b.touching);
        assert_int_equal(a.side, b.side);
        assert_int_equal(eng_exact_meets(case_exact(), &query, 0, 0.5),
                         eng_exact_meets(&fresh, &query, 0, 0.5));
        assert_in_range(fresh.queries, 1, 2); /* a common corner takes none */
        eng_exact_deinit(&fresh);
    }
}

/* poly = product of (a t - b), over the rational roots b / a. */
static void poly_of_roots(struct eng_poly *poly, const int (*roots)[2], int count)
{
    struct eng_poly factor;
    struct eng_poly product;
    mpz_t at0;
    mpz_t at1;
    mpz_inits(at0, at1, NULL);
    kit_poly_init(&factor);
    kit_poly_init(&product);
    mpz_set_si(at0, 1);
    mpz_set_si(at1, 1);
    eng_poly_set_linear(poly, at0, at1); /* the constant 1 */
    for (int i = 0; i < count; i++) {
        mpz_set_si(at0, -roots[i][0]);
        mpz_set_si(at1, roots[i][1] - roots[i][0]);
        eng_poly_set_linear(&factor, at0, at1);
        eng_poly_mul(&product, poly, &factor);
        eng_poly_copy(poly, &product);
    }
    kit_poly_deinit(&factor);
    kit_poly_deinit(&product);
    mpz_clears(at0, at1, NULL);
}

/* If it failed: roots would be counted that are not there, or lost: a false answer. */
CASE(exact__variations_count_the_roots_inside)
{
    struct prng random = {72};
    struct eng_poly poly;
    kit_poly_init(&poly);
    for (int round = 0; round < 5000; round++) {
        int roots[4][2]; /* b / a with 1 <= a <= 9, b in -9 .. 9 */
        int count = (int)prng_u32(&random, 5);
        int inside = 0;
        int sign = 7;
        for (int i = 0; i < count; i++) {
            roots[i][0] = (int)prng_u32(&random, 19) - 9;
            roots[i][1] = 1 + (int)prng_u32(&random, 9);
            inside += roots[i][0] > 0 && roots[i][0] < roots[i][1];
        }
        poly_of_roots(&poly, (const int(*)[2])roots, count);
        assert_int_equal(poly.degree, count);
        int variations = eng_poly_variations(&poly, &sign);
        assert_true(variations >= inside);
        assert_int_equal((variations - inside) % 2, 0);
        int expected0 = 1;
        int expected1 = 1;
        for (int i = 0; i < count; i++) {
            int at1 = roots[i][1] - roots[i][0];
            expected0 *= (roots[i][0] < 0) - (roots[i][0] > 0);
            expected1 *= (at1 > 0) - (at1 < 0);
        }
        assert_int_equal(eng_poly_sign_at_0(&poly), expected0);
        assert_int_equal(eng_poly_sign_at_1(&poly), expected1);
        if (variations == 0 && expected0 != 0) {
            assert_int_equal(sign, expected0);
        }
    }
    kit_poly_deinit(&poly);
}

/* If it failed: an event would be missed where three polynomials share a root, or a
 * double root would be looked for until there is no memory. */
CASE(exact__common_divisors_hold_the_common_roots)
{
    const int a_roots[4][2] = {{1, 2}, {1, 2}, {2, 3}, {-5, 1}};
    const int b_roots[3][2] = {{1, 2}, {3, 1}, {-5, 1}};
    const int common[2][2] = {{1, 2}, {-5, 1}};
    static const struct {
        int roots[3][2];
        int count;
        int simple[3][2];
        int simple_count;
    } free[] = {
        {{{1, 2}, {2, 3}, {-5, 1}}, 3, {{1, 2}, {2, 3}, {-5, 1}}, 3},
        {{{2, 3}, {-5, 1}, {2, 3}}, 3, {{2, 3}, {-5, 1}}, 2},
        {{{0, 1}, {0, 1}, {7, 9}}, 3, {{0, 1}, {7, 9}}, 2},
        {{{7, 9}, {0, 1}, {7, 9}}, 3, {{0, 1}, {7, 9}}, 2},
        {{{4, 7}, {4, 7}, {4, 7}}, 3, {{4, 7}}, 1},
        {{{0, 1}, {0, 1}, {0, 1}}, 3, {{0, 1}}, 1},
        {{{4, 7}, {4, 7}}, 2, {{4, 7}}, 1},
        {{{4, 7}, {4, 9}}, 2, {{4, 7}, {4, 9}}, 2},
        {{{4, 7}}, 1, {{4, 7}}, 1},
    };
    struct eng_poly p[5];
    for (int i = 0; i < 5; i++) {
        kit_poly_init(&p[i]);
    }
    poly_of_roots(&p[0], a_roots, 4);
    poly_of_roots(&p[1], b_roots, 3);
    poly_of_roots(&p[2], common, 2);
    eng_poly_gcd(&p[3], &p[0], &p[1]);
    assert_int_equal(p[3].degree, 2);
    for (int i = 0; i <= 2; i++) { /* proportional */
        mpz_mul(p[4].c[0], p[3].c[i], p[2].c[2]);
        mpz_mul(p[4].c[1], p[2].c[i], p[3].c[2]);
        assert_int_equal(mpz_cmp(p[4].c[0], p[4].c[1]), 0);
    }
    for (size_t c = 0; c < sizeof free / sizeof *free; c++) {
        poly_of_roots(&p[0], free[c].roots, free[c].count);
        eng_poly_square_free(&p[3], &p[0]);
        poly_of_roots(&p[2], free[c].simple, free[c].simple_count);
        int degree = free[c].simple_count;
        assert_int_equal(p[3].degree, degree);
        for (int i = 0; i <= degree; i++) { /* proportional */
            mpz_mul(p[4].c[0], p[3].c[i], p[2].c[degree]);
            mpz_mul(p[4].c[1], p[2].c[i], p[3].c[degree]);
            assert_int_equal(mpz_cmp(p[4].c[0], p[4].c[1]), 0);
        }
    }
    for (int i = 0; i < 5; i++) {
        kit_poly_deinit(&p[i]);
    }
}

/* If it failed: the first contact of a long span would be said to begin too late, or to
 * be where none is. */
CASE(exact__first_contact_is_bracketed)
{
    struct eng_exact exact;
    struct prng random = {81};
    int hits = 0;
    assert_ok(eng_exact_init(&exact));
    for (int round = 0; round < 6000; round++) {
        struct eng_query query = {.kind = round % 2 ? PCCD_EE : PCCD_VF};
        uint32_t bound = 1 + (uint32_t)round % 3;
        double tolerance = ldexp(1, -(int)prng_u32(&random, 44));
        double l = round % 5 == 0 ? 0.3 : 0;
        double r = round % 7 == 0 ? 0.9 : 1;
        for (int i = 0; i < 24; i++) {
            query.x[i / 12][i / 3 % 4][i % 3] =
                round % 4 ? prng_integer(&random, bound) : prng_between(&random, -1, 1);
        }
        double from = l;
        double to = r;
        bool found = eng_exact_first(&exact, &query, tolerance, &from, &to);
        assert_int_equal(found, eng_exact_meets(&exact, &query, l, r));
        if (!found) {
            assert_true(from == l && to == r);
            continue;
        }
        hits++;
        assert_true(l <= from && from <= to && to <= r);
        assert_true(to - from <= tolerance + 0x1p-48);
        assert_true(from == l || !eng_exact_meets(&exact, &query, l, nextafter(from, 0)));
        assert_true(from == to || eng_exact_meets(&exact, &query, from, to));
    }
    assert_in_range(hits, 1000, 5000);
    eng_exact_deinit(&exact);
}

static size_t gmp_calls;

static void *count_alloc(size_t bytes)
{
    gmp_calls++;
    return malloc(bytes);
}

static void *count_realloc(void *block, size_t before, size_t bytes)
{
    (void)before;
    gmp_calls++;
    return realloc(block, bytes);
}

static void count_free(void *block, size_t bytes)
{
    (void)bytes;
    free(block);
}

/* Exponents as far apart as they may be; some coordinates are the same, or each other's
 * negative, so that roots are, too. */
static void extreme_query(struct prng *random, struct eng_query *query)
{
    double pool[6] = {0};
    query->kind = prng_u32(random, 2) ? PCCD_EE : PCCD_VF;
    for (int i = 0; i < 24; i++) {
        double *x = &query->x[i / 12][i / 3 % 4][i % 3];
        double value = prng_u32(random, 2) ? prng_integer(random, 4) / 4
                                           : prng_between(random, -1, 1);
        int exponent = prng_u32(random, 3) == 0 ? -(int)prng_u32(random, 1134)
                       : prng_u32(random, 2)    ? -1133
                                                : 0;
        *x = prng_u32(random, 4) == 0 ? pool[prng_u32(random, 6)]
                                      : ldexp(value, 59 + exponent);
        pool[prng_u32(random, 6)] = prng_u32(random, 2) ? *x : -*x;
    }
}

/* If it failed: GMP would end the daemon where it gets no memory for a number. */
CASE(exact__decisions_allocate_nothing)
{
    struct eng_exact exact;
    struct prng random = {74};
    assert_ok(eng_exact_init(&exact));
    mp_set_memory_functions(count_alloc, count_realloc, count_free);
    gmp_calls = 0;
    for (int round = 0; round < 4000; round++) {
        struct eng_query query;
        extreme_query(&random, &query);
        double tolerance = ldexp(1, -(int)prng_u32(&random, 44));
        double l =
            round % 3 ? 0 : ldexp(prng_between(&random, 0, 1), -(int)(round % 1074));
        double r = l + (1 - l) * ldexp(1, -(int)prng_u32(&random, 40));
        struct eng_moment moment = eng_exact_moment(&exact, &query, round % 2);
        assert_in_range(moment.side + 1, 0, 2);
        bool found = eng_exact_meets(&exact, &query, l, r);
        assert_int_equal(found, eng_exact_first(&exact, &query, tolerance, &l, &r));
    }
    /* The longest that there are: temporaries of GMP are on the stack then, too. */
    struct eng_exact_span *span = &exact.span;
    struct eng_poly *longest = &span->condition[0];
    longest->degree = 4;
    for (int i = 0; i <= longest->degree; i++) {
        mpz_set_ui(longest->c[i], 1);
        mpz_mul_2exp(longest->c[i], longest->c[i], 8 * ENG_EXACT_BITS);
        mpz_sub_ui(longest->c[i], longest->c[i], 1);
    }
    mpz_set_ui(span->roots.num, 1);
    mpz_mul_2exp(span->roots.num, span->roots.num, ENG_EXACT_DEPTH);
    mpz_sub_ui(span->roots.num, span->roots.num, 1);
    eng_poly_zoom(&span->sign, longest, span->roots.num, ENG_EXACT_DEPTH);
    int sign;
    assert_int_equal(eng_poly_variations(&span->sign, &sign), 0);
    assert_int_equal(gmp_calls, 0);
    mp_set_memory_functions(NULL, NULL, NULL);
    eng_exact_deinit(&exact);
}

/* b0 / a0 - b1 / a1, up to a positive factor. */
static int compare(const int left[2], const int right[2])
{
    int difference = left[0] * right[1] - right[0] * left[1];
    return (difference > 0) - (difference < 0);
}

/* With few bits a sign may stay open that is not 0. */
static void check_sign(struct eng_root_sign *scratch, const struct eng_poly *g,
                       const struct eng_root *root, bool by_all_bits, int expected)
{
    int sign;
    if (!eng_root_sign_of(scratch, g, root, by_all_bits, &sign)) {
        assert_false(by_all_bits);
        assert_int_not_equal(expected, 0);
        assert_true(eng_root_sign_of(scratch, g, root, true, &sign));
    }
    assert_int_equal(sign, expected);
}

/* If it failed: a contact on the rim of a triangle, or beside it, would be taken for the
 * other. Roots of both polynomials are near each other, the same, or at the ends. */
CASE(exact__a_quadratic_has_its_sign_at_a_root)
{
    struct prng random = {73};
    struct eng_root_sign *scratch = &case_exact()->span.root_sign;
    struct eng_poly f;
    struct eng_poly g;
    int signs[3] = {0};
    kit_poly_init(&f);
    kit_poly_init(&g);
    for (int round = 0; round < 20000; round++) {
        int roots[5][2]; /* three of f, then two of g */
        int f_count = 1 + (int)prng_u32(&random, 3);
        int g_count = (int)prng_u32(&random, 3);
        for (int i = 0; i < 5; i++) {
            roots[i][0] = (int)prng_u32(&random, 15) - 3;
            roots[i][1] = 1 + (int)prng_u32(&random, 11);
            if (i >= 3 && prng_u32(&random, 4) == 0) { /* shared, or double */
                memcpy(roots[i], roots[i == 3 ? 0 : 3], sizeof *roots);
            }
        }
        unsigned long k = prng_u32(&random, 4);
        int num = (int)prng_u32(&random, 1u << k);
        const int ends[2][2] = {{num, 1 << k}, {num + 1, 1 << k}};
        bool is_alone = compare(ends[0], roots[0]) < 0 && compare(roots[0], ends[1]) < 0;
        int before = 1;
        for (int i = 0; i < f_count; i++) {
            is_alone &= i == 0 || compare(roots[i], ends[0]) <= 0 ||
                        compare(ends[1], roots[i]) <= 0;
            before *= compare(ends[0], roots[i]) >= 0 ? 1 : -1;
        }
        if (!is_alone) {
            continue;
        }
        int expected = prng_u32(&random, 2) ? 1 : -1;
        poly_of_roots(&f, (const int(*)[2])roots, f_count);
        poly_of_roots(&g, (const int(*)[2])(roots + 3), g_count);
        if (g_count == 2 && prng_u32(&random, 3) == 0) { /* no root, but nearly */
            mpz_mul_2exp(g.c[0], g.c[0], 40);
            mpz_mul_2exp(g.c[1], g.c[1], 40);
            mpz_mul_2exp(g.c[2], g.c[2], 40);
            if (compare(roots[3], roots[4]) == 0) {
                mpz_add_ui(g.c[0], g.c[0], 1);
                g_count = 0;
            }
        }
        if (expected < 0) {
            eng_poly_negate(&g);
        }
        for (int i = 3; i < 3 + g_count; i++) {
            expected *= compare(roots[0], roots[i]);
        }
        mpz_t number;
        mpz_init_set_si(number, num);
        const struct eng_root root = {&f, &number, k, before};
        check_sign(scratch, &g, &root, prng_u32(&random, 2), expected);
        signs[expected + 1]++;
        mpz_clear(number);
    }
    for (int i = 0; i < 3; i++) {
        assert_true(signs[i] > 100);
    }
    kit_poly_deinit(&f);
    kit_poly_deinit(&g);
}

CASES_WITH(NULL, case_end);

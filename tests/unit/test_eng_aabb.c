/* test_eng_aabb.c - moving boxes. */
#include "aabb.h"
#include "eng_kit.h"

/* Largest float <= x, by the book. */
static float reference_down(double x)
{
    float f = (float)x;
    return (double)f > x ? nextafterf(f, -INFINITY) : f;
}

static float reference_up(double x)
{
    float f = (float)x;
    return (double)f < x ? nextafterf(f, INFINITY) : f;
}

static void check_rounding(double x)
{
    float down = eng_round_down(x);
    float up = eng_round_up(x);
    assert_true((double)down <= x && x <= (double)up);
    assert_true(down == reference_down(x));
    assert_true(up == reference_up(x));
}

/* If it failed: a box could be too small by one rounding, or needlessly large. */
CASE(aabb__rounding_is_the_nearest_float_outward)
{
    struct prng random = {8};
    for (int i = 0; i < 300000; i++) {
        /* All magnitudes from below the smallest float to the limit, both signs. */
        double x =
            ldexp(prng_between(&random, -1, 1), -1080 + (int)prng_u32(&random, 1140));
        check_rounding(x);
    }
    for (int i = 0; i < 300000; i++) {
        float f = ldexpf((float)prng_between(&random, -1, 1),
                         -150 + (int)prng_u32(&random, 210));
        check_rounding((double)f); /* itself */
        check_rounding(nextafter((double)f, INFINITY));
        check_rounding(nextafter((double)f, -INFINITY));
    }
}

/* If it failed: denormals, zeros or the largest coordinates would round inward. */
CASE(aabb__rounding_holds_at_the_corners)
{
    const double corners[] = {
        0.0,        5e-324,        0x1p-149,        0x1p-150,        0x1.8p-150,
        0x1.8p-149, 0x1p-126,      0x1.fffffep-127, 0x1.ffffffp-127, 1.0,
        1e18,       0x1.fffffefp0, 0x1.ffffffp30,   0x1.fffffffp59,  0.1};
    for (size_t i = 0; i < sizeof corners / sizeof *corners; i++) {
        for (int step = -1; step <= 1; step++) {
            double x =
                step == 0 ? corners[i] : nextafter(corners[i], (float)step * INFINITY);
            check_rounding(x);
            check_rounding(-x);
        }
    }
}

/* If it failed: a point could lie outside its own box, or links of a node be
 * overwritten. */
CASE(aabb__box_of_a_point_is_tight_and_keeps_the_words)
{
    struct prng random = {9};
    for (int i = 0; i < 10000; i++) {
        struct eng_box box = {.word0 = 1, .word1 = 2, .word2 = UINT32_MAX, .word3 = 4};
        double x[2][3];
        for (int k = 0; k < 6; k++) {
            x[k / 3][k % 3] = prng_between(&random, -1e3, 1e3);
        }
        eng_box_of_point(&box, NULL, x[0], x[1]);
        for (int k = 0; k < 3; k++) {
            assert_true(box.lo0[k] == reference_down(x[0][k]));
            assert_true(box.hi0[k] == reference_up(x[0][k]));
            assert_true(box.lo1[k] == reference_down(x[1][k]));
            assert_true(box.hi1[k] == reference_up(x[1][k]));
        }
        assert_true(box.word0 == 1 && box.word1 == 2 && box.word2 == UINT32_MAX &&
                    box.word3 == 4);
    }
}

/* Bounds that are multiples of 1/16 below 64: times of 64ths give exact doubles. */
static struct eng_box random_box(struct prng *random, uint32_t size)
{
    struct eng_box box;
    for (int k = 0; k < 3; k++) {
        box.lo0[k] = (float)prng_integer(random, 128) / 16;
        box.hi0[k] = box.lo0[k] + (float)prng_u32(random, size) / 16;
        box.lo1[k] = (float)prng_integer(random, 128) / 16;
        box.hi1[k] = box.lo1[k] + (float)prng_u32(random, size) / 16;
    }
    box.word0 = (uint32_t)prng_next(random); /* any bits, NaN patterns among them */
    box.word1 = prng_u32(random, 2) ? UINT32_MAX : 0;
    box.word2 = (uint32_t)prng_next(random);
    box.word3 = UINT32_MAX;
    return box;
}

/* If it failed: a parent would not contain its children. */
CASE(aabb__union_is_the_smallest_box_around_both)
{
    struct prng random = {10};
    for (int i = 0; i < 20000; i++) {
        struct eng_box a = random_box(&random, 64);
        struct eng_box b = random_box(&random, 64);
        struct eng_box out = {.word0 = 11, .word1 = 12, .word2 = 13, .word3 = UINT32_MAX};
        eng_box_unite(&out, &a, &b);
        for (int k = 0; k < 3; k++) {
            assert_true(out.lo0[k] == fminf(a.lo0[k], b.lo0[k]));
            assert_true(out.hi0[k] == fmaxf(a.hi0[k], b.hi0[k]));
            assert_true(out.lo1[k] == fminf(a.lo1[k], b.lo1[k]));
            assert_true(out.hi1[k] == fmaxf(a.hi1[k], b.hi1[k]));
        }
        assert_true(out.word0 == 11 && out.word1 == 12 && out.word2 == 13 &&
                    out.word3 == UINT32_MAX);
        struct eng_box in_place = a; /* as refit does with three vertices */
        eng_box_unite(&in_place, &in_place, &b);
        assert_memory_equal(in_place.lo0, out.lo0, sizeof out.lo0);
        assert_memory_equal(in_place.hi1, out.hi1, sizeof out.hi1);
        assert_int_equal(in_place.word1, a.word1);
    }
}

static bool plain_overlap(const struct eng_box *a, const struct eng_box *b)
{
    for (int k = 0; k < 3; k++) {
        if ((a->lo0[k] > b->hi0[k] && a->lo1[k] > b->hi1[k]) ||
            (b->lo0[k] > a->hi0[k] && b->lo1[k] > a->hi1[k])) {
            return false;
        }
    }
    return true;
}

/* If it failed: the vector code would not do what its comment says, or look at the
 * words. */
CASE(aabb__overlap_agrees_with_plain_code)
{
    struct prng random = {11};
    int meets = 0;
    enum { ROUNDS = 200000 };
    for (uint32_t i = 0; i < ROUNDS; i++) {
        struct eng_box a = random_box(&random, i % 200 + 1);
        struct eng_box b = random_box(&random, i % 200 + 1);
        bool overlap = eng_box_overlap(&a, &b);
        assert_int_equal(overlap, plain_overlap(&a, &b));
        assert_int_equal(overlap, eng_box_overlap(&b, &a));
        meets += overlap;
    }
    assert_in_range(meets, ROUNDS / 10, ROUNDS - ROUNDS / 10);
}

/* Return whether the boxes overlap when moved to time j / 64. Exact. */
static bool overlap_at(const struct eng_box *a, const struct eng_box *b, int j)
{
    double t = j / 64.0;
    for (int k = 0; k < 3; k++) {
        double a_lo = (double)a->lo0[k] * (1 - t) + (double)a->lo1[k] * t;
        double a_hi = (double)a->hi0[k] * (1 - t) + (double)a->hi1[k] * t;
        double b_lo = (double)b->lo0[k] * (1 - t) + (double)b->lo1[k] * t;
        double b_hi = (double)b->hi0[k] * (1 - t) + (double)b->hi1[k] * t;
        if (a_lo > b_hi || b_lo > a_hi) {
            return false;
        }
    }
    return true;
}

/* If it failed: a contact inside the step would be lost although no end shows it. */
CASE(aabb__boxes_that_meet_at_some_time_overlap)
{
    struct prng random = {12};
    int only_between = 0;
    for (int i = 0; i < 20000; i++) {
        struct eng_box a = random_box(&random, 32);
        struct eng_box b = random_box(&random, 32);
        bool met = false;
        for (int j = 0; j <= 64; j++) {
            if (overlap_at(&a, &b, j)) {
                /* Until any later time, and until the very moment. */
                assert_true(eng_box_overlap(&a, &b));
                for (int end = j; end <= 64; end += 9) {
                    assert_true(eng_box_overlap_until(&a, &b, (float)end / 64));
                    assert_true(eng_box_overlap_until(&b, &a, (float)end / 64));
                }
                met = true;
                break;
            }
        }
        only_between += met && !overlap_at(&a, &b, 0) && !overlap_at(&a, &b, 64);
    }
    assert_true(only_between > 100); /* the case that matters did occur */
}

/* If it failed: rounding in the products could lose boxes that only just touch. */
CASE(aabb__boxes_that_just_touch_at_the_end_time_overlap)
{
    struct prng random = {13};
    for (int i = 0; i < 100000; i++) {
        struct eng_box a = random_box(&random, 32);
        struct eng_box b = a; /* alike but along one axis: only that one decides */
        int axis = (int)prng_u32(&random, 3);
        float scale = ldexpf(1, (int)prng_u32(&random, 170) - 120);
        float gap0 = (float)prng_between(&random, 0.001, 1) * scale;
        float gap1 = -(float)prng_between(&random, 0.001, 1) * scale;
        a.lo0[axis] = a.hi0[axis] = a.lo1[axis] = a.hi1[axis] = 0;
        b.lo0[axis] = b.hi0[axis] = gap0;
        b.lo1[axis] = b.hi1[axis] = gap1;
        /* The gap closes at g0 / (g0 - g1); a float at or after that must see it. */
        long double closes = (long double)gap0 / ((long double)gap0 - (long double)gap1);
        float t_end = (float)closes;
        t_end = (long double)t_end < closes ? nextafterf(t_end, 1) : t_end;
        assert_true(eng_box_overlap_until(&a, &b, t_end));
        assert_true(eng_box_overlap_until(&b, &a, t_end));
        if (scale > 0x1p-100f) { /* far above the denormals the test is also sharp */
            assert_false(eng_box_overlap_until(&a, &b, t_end * 0.99f));
            assert_false(eng_box_overlap_until(&b, &a, t_end * 0.99f));
        }
    }
}

/* If it failed: culling by the earliest contact so far would cull nothing, or
 * everything. */
CASE(aabb__overlap_until_the_end_is_overlap)
{
    struct prng random = {14};
    for (int i = 0; i < 100000; i++) {
        struct eng_box a = random_box(&random, 64);
        struct eng_box b = random_box(&random, 64);
        /* Gaps here are 0 or at least 1/16: far outside the slack. */
        assert_int_equal(eng_box_overlap_until(&a, &b, 1),
                         eng_box_overlap(&a, &b) || overlap_at(&a, &b, 64));
        assert_int_equal(eng_box_overlap_until(&a, &b, 0), overlap_at(&a, &b, 0));
    }
}

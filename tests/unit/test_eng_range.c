/* test_eng_range.c - ranges of consecutive indices. */
#include "eng_kit.h"
#include "memory.h"
#include "world.h"

static uint32_t take(struct eng_ranges *ranges, uint32_t count)
{
    uint32_t first = UINT32_MAX;
    assert_ok(eng_ranges_take(ranges, count, &first));
    return first;
}

/* If it failed: arrays would grow although a removed object left room for the new one. */
CASE(range__take_uses_the_first_hole_that_fits)
{
    struct eng_ranges ranges;
    eng_ranges_init(&ranges, 1000);
    for (uint32_t i = 0; i < 5; i++) {
        assert_int_equal(take(&ranges, 10), 10 * i);
    }
    eng_ranges_give(&ranges, 10, 10);
    eng_ranges_give(&ranges, 30, 10);
    assert_int_equal(take(&ranges, 4), 10);
    assert_int_equal(take(&ranges, 7), 30);
    assert_int_equal(take(&ranges, 6), 14);
    assert_int_equal(take(&ranges, 4), 50);
    assert_int_equal(take(&ranges, 3), 37);
    assert_int_equal(ranges.hole_count, 0);
    assert_int_equal(ranges.end, 54);
    eng_ranges_deinit(&ranges);
}

/* The i-th of the 24 orders of four things. */
static void order_of(unsigned i, uint32_t order[4])
{
    uint32_t left[4] = {0, 1, 2, 3};
    for (unsigned n = 4; n > 0; n--) {
        unsigned pick = i % n;
        i /= n;
        order[4 - n] = left[pick];
        memmove(&left[pick], &left[pick + 1], (n - pick - 1) * sizeof left[0]);
    }
}

/* If it failed: holes side by side would stay apart and a large object would not fit. */
CASE(range__neighbouring_holes_merge_in_every_order)
{
    for (unsigned i = 0; i < 24; i++) {
        uint32_t order[4];
        struct eng_ranges ranges;
        order_of(i, order);
        eng_ranges_init(&ranges, 1000);
        for (uint32_t k = 0; k < 5; k++) {
            take(&ranges, 10);
        }
        for (uint32_t k = 0; k < 4; k++) {
            eng_ranges_give(&ranges, 10 * order[k], 10);
        }
        assert_int_equal(ranges.hole_count, 1);
        assert_int_equal(ranges.holes[0].first, 0);
        assert_int_equal(ranges.holes[0].count, 40);
        eng_ranges_give(&ranges, 40, 10);
        assert_int_equal(ranges.hole_count, 0);
        assert_int_equal(ranges.end, 0);
        eng_ranges_deinit(&ranges);
    }
}

/* If it failed: an index could pass the largest number that the arrays can name. */
CASE(range__limit_is_kept)
{
    struct eng_ranges ranges;
    uint32_t first = 77;
    eng_ranges_init(&ranges, 100);
    take(&ranges, 60);
    assert_int_equal(eng_ranges_take(&ranges, 41, &first), PCCD_E_LIMIT);
    assert_int_equal(eng_ranges_take(&ranges, UINT32_MAX, &first), PCCD_E_LIMIT);
    assert_int_equal(first, 77);
    assert_int_equal(take(&ranges, 40), 60);
    assert_int_equal(eng_ranges_take(&ranges, 1, &first), PCCD_E_LIMIT);
    eng_ranges_give(&ranges, 0, 60);
    assert_int_equal(eng_ranges_take(&ranges, 61, &first), PCCD_E_LIMIT);
    assert_int_equal(take(&ranges, 60), 0);
    eng_ranges_deinit(&ranges);

    eng_ranges_init(&ranges, UINT32_MAX - 1);
    assert_int_equal(take(&ranges, UINT32_MAX - 1), 0);
    assert_int_equal(eng_ranges_take(&ranges, 1, &first), PCCD_E_LIMIT);
    eng_ranges_give(&ranges, 0, UINT32_MAX - 1);
    assert_int_equal(ranges.end, 0);
    eng_ranges_deinit(&ranges);
}

/* If it failed: removing every other of many objects would write behind the list of
 * holes. */
CASE(range__as_many_holes_as_ranges_find_room)
{
    struct eng_ranges ranges;
    eng_ranges_init(&ranges, 100000);
    for (uint32_t i = 0; i < 1001; i++) {
        assert_int_equal(take(&ranges, 3), 3 * i);
    }
    uint64_t allocations = eng_alloc_count();
    for (uint32_t i = 0; i < 1000; i += 2) {
        eng_ranges_give(&ranges, 3 * i, 3);
    }
    assert_int_equal(eng_alloc_count(), allocations); /* or it could fail */
    assert_int_equal(ranges.hole_count, 500);
    assert_true(ranges.hole_count <= ranges.hole_capacity);
    for (uint32_t i = 0; i < 1000; i += 2) {
        assert_int_equal(take(&ranges, 3), 3 * i);
    }
    eng_ranges_deinit(&ranges);
}

#define MODEL_SIZE 4096u
#define HELD_MAX   128u

/* Lowest index from which `count` bits are clear. */
static uint32_t model_fit(const bool *taken, uint32_t count)
{
    uint32_t run = 0;
    for (uint32_t i = 0; i < MODEL_SIZE; i++) {
        run = taken[i] ? 0 : run + 1;
        if (run == count) {
            return i + 1 - count;
        }
    }
    fail_msg("the model has no room for %u", count);
    return 0;
}

static void check_holes(const struct eng_ranges *ranges, const bool *taken)
{
    uint32_t at = 0;
    for (uint32_t i = 0; i < ranges->hole_count; i++) {
        const struct eng_range *hole = &ranges->holes[i];
        assert_true(hole->count > 0 && hole->first >= at);
        assert_true(i == 0 || hole->first > at); /* never adjacent */
        for (; at < hole->first; at++) {
            assert_true(taken[at]);
        }
        for (; at < hole->first + hole->count; at++) {
            assert_false(taken[at]);
        }
    }
    assert_true(ranges->hole_count == 0 || at < ranges->end);
    for (; at < MODEL_SIZE; at++) {
        assert_int_equal(taken[at], at < ranges->end);
    }
}

/* If it failed: two objects could be given the same vertices, or room would leak away. */
CASE(range__random_traffic_agrees_with_a_bitmap)
{
    struct prng random = {2};
    static bool taken[MODEL_SIZE];
    struct eng_range held[HELD_MAX];
    uint32_t held_count = 0;
    uint64_t bytes = eng_alloc_bytes();
    struct eng_ranges ranges;
    eng_ranges_init(&ranges, MODEL_SIZE);
    for (int round = 0; round < 20000; round++) {
        bool fill = round / 1000 % 2 == 0;
        if (held_count < HELD_MAX && prng_u32(&random, 10) < (fill ? 7u : 3u)) {
            uint32_t count = 1 + prng_u32(&random, 12);
            uint32_t first = take(&ranges, count);
            assert_int_equal(first, model_fit(taken, count));
            memset(taken + first, true, count);
            held[held_count++] = (struct eng_range){first, count};
        } else if (held_count > 0) {
            uint32_t i = prng_u32(&random, held_count);
            eng_ranges_give(&ranges, held[i].first, held[i].count);
            memset(taken + held[i].first, false, held[i].count);
            held[i] = held[--held_count];
        }
        check_holes(&ranges, taken);
    }
    eng_ranges_deinit(&ranges);
    assert_int_equal(eng_alloc_bytes(), bytes);
}

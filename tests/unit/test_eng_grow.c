/* tests/unit/test_eng_grow.c - hierarchies from the top down, in pieces.
 *
 * Room:     engine (grow.h, sah.h).
 * Does:     trees of one go and of many pieces, in place and aside; the depth that the
 *           surface area heuristic is held to, and what it finds.
 * Threads:  one.
 * Source:   daemon/engine/paper/grow.h.
 */
#include "eng_kit.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "grow.h"

#define ITEMS_MAX 5000u

static struct eng_split_item items[ITEMS_MAX];
static struct eng_sah_box boxes[ITEMS_MAX];
static struct eng_link links[2 * ITEMS_MAX];
static struct eng_node nodes[2 * ITEMS_MAX];

/* Item i around a point. */
static void put(uint32_t i, const double at[3], double size)
{
    items[i].id = i;
    for (int k = 0; k < 3; k++) {
        items[i].centroid[k] = (float)at[k];
        boxes[i].lo[k] = (float)(at[k] - size);
        boxes[i].hi[k] = (float)(at[k] + size);
    }
}

static void put_cloud(uint64_t seed, uint32_t count)
{
    struct kit_random random = {seed};
    for (uint32_t i = 0; i < count; i++) {
        double at[3];
        for (int k = 0; k < 3; k++) {
            at[k] = pow(kit_between(&random, 0, 1), 3); /* denser at one corner */
        }
        put(i, at, kit_between(&random, 0, 0.02));
    }
}

static struct eng_grower *grower_of(uint32_t count, bool by_sah)
{
    static struct eng_grower grower;
    memset(&grower, 0xa5, sizeof grower);
    grower.items = items;
    grower.nodes = NULL;
    grower.links = links;
    grower.base = 0;
    grower.over_roots = false;
    grower.sah.boxes = by_sah ? boxes : NULL;
    grower.sah.first_id = 0;
    eng_grow_begin(&grower, count, 0,
                   eng_grow_levels(count) + (by_sah ? ENG_LEVELS_SPARE : 0));
    return &grower;
}

/* Levels below the root of links[]; every item must be in one leaf, every count right. */
static uint32_t depth_of_links(uint32_t count)
{
    static uint8_t seen[ITEMS_MAX];
    uint32_t stack[ENG_GROW_STACK_MAX][2];
    uint32_t stack_count = 0;
    uint32_t next = 0; /* in pre-order */
    uint32_t depth = 0;
    uint32_t level = 0;
    memset(seen, 0, sizeof seen);
    for (;;) {
        uint32_t node = next++;
        assert_true(node < 2 * count - 1);
        depth = level > depth ? level : depth;
        if (links[node].count > 1) {
            uint32_t left = links[node + 1].count;
            assert_int_equal(links[node].right, node + 2 * left);
            assert_int_equal(links[node].count, left + links[links[node].right].count);
            assert_true(stack_count < ENG_GROW_STACK_MAX);
            stack[stack_count][0] = links[node].right;
            stack[stack_count++][1] = ++level;
            continue;
        }
        assert_true(links[node].right < count);
        assert_int_equal(seen[links[node].right]++, 0);
        if (stack_count == 0) {
            assert_int_equal(next, 2 * count - 1);
            return depth;
        }
        assert_int_equal(stack[--stack_count][0], next);
        level = stack[stack_count][1];
    }
}

/* If it failed: a subtree built in the background would not be a tree, or not the one
 * built in place. */
static void grow__pieces_make_the_tree_of_one_go(void **state)
{
    (void)state;
    for (int by_sah = 0; by_sah < 2; by_sah++) {
        for (uint32_t count = 1; count <= ITEMS_MAX; count = count * 3 + 1) {
            put_cloud(71, count);
            struct eng_grower *grower = grower_of(count, by_sah);
            uint32_t pieces = 1;
            while (eng_grow_piece(grower)) {
                pieces++;
            }
            assert_true(count < ITEMS_MAX / 3 || pieces > 10);
            assert_true(depth_of_links(count) <=
                        eng_grow_levels(count) + (by_sah ? ENG_LEVELS_SPARE : 0));
            put_cloud(71, count);
            grower = grower_of(count, by_sah);
            grower->nodes = nodes;
            eng_grow(grower);
            for (uint32_t i = 0; i < 2 * count - 1; i++) {
                bool is_leaf = links[i].count == 1;
                assert_int_equal(nodes[i].count, links[i].count);
                assert_int_equal(nodes[i].right, links[i].right);
                assert_int_equal(nodes[i].left, is_leaf ? ENG_LEAF : i + 1);
            }
        }
    }
}

/* If it failed: places chosen by a foe would make a list of a tree, and the stacks that
 * are sized by its depth would run over. */
static void grow__heuristic_keeps_to_the_depth(void **state)
{
    (void)state;
    const uint32_t count = 240;
    uint32_t deepest = 0;
    for (int power = 1; power < 4; power++) {
        for (uint32_t i = 0; i < count; i++) {
            double x = ldexp(1, (int)(i * (unsigned)power / 3) - 120);
            put(i, (double[3]){x, x / 3, 0}, x / 1000);
        }
        struct eng_grower *grower = grower_of(count, true);
        eng_grow(grower);
        uint32_t depth = depth_of_links(count);
        assert_true(depth <= eng_grow_levels(count) + ENG_LEVELS_SPARE);
        deepest = depth > deepest ? depth : deepest;
    }
    assert_int_equal(deepest, eng_grow_levels(count) + ENG_LEVELS_SPARE);
}

/* If it failed: the other build quality would be the first under another name. */
static void grow__heuristic_finds_the_gap(void **state)
{
    (void)state;
    struct kit_random random = {72};
    for (int axis = 0; axis < 3; axis++) {
        for (uint32_t few = 20; few < 100; few += 7) {
            for (uint32_t i = 0; i < 1000; i++) {
                double at[3];
                for (int k = 0; k < 3; k++) {
                    at[k] = kit_between(&random, 0, 1) +
                            (k == axis && i % 1000 < few ? -3 : 0);
                }
                put(i, at, 0.01);
            }
            eng_grow(grower_of(1000, true));
            assert_int_equal(links[1].count, few);
            depth_of_links(1000);
        }
    }
}

/* If it failed: what no plane divides, or no float measures, would not be built. */
static void grow__heuristic_gives_way_to_medians(void **state)
{
    (void)state;
    const double sizes[] = {0, 1e-45, 1e-30, 1, 1e18};
    for (size_t s = 0; s < sizeof sizes / sizeof *sizes; s++) {
        for (uint32_t spread = 0; spread < 3; spread++) {
            for (uint32_t i = 0; i < 500; i++) {
                double x = i % 500 < spread ? sizes[s] : 0;
                put(i, (double[3]){x, -x, 0}, sizes[s] / 2);
            }
            eng_grow(grower_of(500, true));
            assert_true(depth_of_links(500) <= eng_grow_levels(500) + ENG_LEVELS_SPARE);
        }
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(grow__pieces_make_the_tree_of_one_go),
        cmocka_unit_test(grow__heuristic_keeps_to_the_depth),
        cmocka_unit_test(grow__heuristic_finds_the_gap),
        cmocka_unit_test(grow__heuristic_gives_way_to_medians),
    };
    return cmocka_run_group_tests_name("eng_grow", tests, NULL, NULL);
}

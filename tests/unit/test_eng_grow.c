/* test_eng_grow.c - hierarchies from the top down, in pieces.
 *
 * Source: daemon/engine/paper/grow.h.
 */
#include "eng_kit.h"
#include "grow.h"

#define ITEMS_MAX 5000u

static struct eng_split_item items[ITEMS_MAX];
static struct eng_node nodes[2 * ITEMS_MAX];
static struct eng_trees trees = {.nodes = nodes};

static void put_cloud(uint64_t seed, uint32_t count)
{
    struct prng random = {seed};
    for (uint32_t i = 0; i < count; i++) {
        items[i].id = i;
        for (int k = 0; k < 3; k++) { /* denser at one corner */
            items[i].centroid[k] = (float)pow(prng_between(&random, 0, 1), 3);
        }
    }
}

static struct eng_grower *grower_of(uint32_t count, struct eng_node *to)
{
    static struct eng_grower grower;
    memset(&grower, 0xa5, sizeof grower);
    grower.items = items;
    grower.nodes = to;
    grower.over_roots = false;
    eng_grow_begin(&grower, count, 0);
    return &grower;
}

/* Levels below the root of nodes[]; every item must be in one leaf, every count right. */
static uint32_t depth_of_nodes(uint32_t count)
{
    static uint8_t seen[ITEMS_MAX];
    static uint32_t level[2 * ITEMS_MAX];
    uint32_t depth = 0;
    memset(seen, 0, sizeof seen);
    level[0] = 0;
    for (uint32_t i = 0; i < 2 * count - 1; i++) {
        const struct eng_node *node = &nodes[i];
        depth = level[i] > depth ? level[i] : depth;
        if (node->left == ENG_LEAF) {
            assert_int_equal(node->count, 1);
            assert_true(node->right < count);
            assert_int_equal(seen[node->right]++, 0);
            continue;
        }
        assert_int_equal(node->left, i + 1);
        assert_int_equal(node->right, i + 2 * nodes[i + 1].count);
        assert_int_equal(node->count, nodes[node->left].count + nodes[node->right].count);
        level[node->left] = level[node->right] = level[i] + 1;
    }
    return depth;
}

static uint32_t ceil_log2(uint32_t n)
{
    uint32_t log = 0;
    while ((uint64_t)1 << log < n) {
        log++;
    }
    return log;
}

/* If it failed: a subtree built in the background would not be the one built in place, or
 * stacks that are sized by its depth would run over. */
CASE(grow__pieces_make_the_tree_of_one_go)
{
    static struct eng_node whole[2 * ITEMS_MAX];
    for (uint32_t count = 1; count <= ITEMS_MAX; count = count * 3 + 1) {
        put_cloud(72, count); /* other places: the same nodes, other leaves */
        eng_grow(grower_of(count, nodes));
        assert_int_equal(depth_of_nodes(count), ceil_log2(count));
        put_cloud(71, count);
        struct eng_grower *grower = grower_of(count, NULL);
        uint32_t pieces = 1;
        while (eng_grow_piece(grower)) {
            pieces++;
        }
        assert_true(count < ITEMS_MAX / 3 || pieces > 10);
        eng_grow_leaves(&trees, (struct eng_range){0, 2 * count - 1}, items);
        memcpy(whole, nodes, sizeof whole);
        put_cloud(71, count);
        eng_grow(grower_of(count, nodes));
        depth_of_nodes(count);
        assert_memory_equal(nodes, whole, (2 * count - 1) * sizeof *nodes);
    }
}

/* If it failed: places chosen by a foe, or all the same, would make a list of a tree. */
CASE(grow__depth_depends_on_the_number_alone)
{
    for (int power = 0; power < 4; power++) {
        const uint32_t count = 240;
        for (uint32_t i = 0; i < count; i++) {
            float x = ldexpf(1, (int)(i * (unsigned)power / 3) - 120);
            items[i] = (struct eng_split_item){{x, x / 3, 0}, i};
        }
        eng_grow(grower_of(count, nodes));
        assert_int_equal(depth_of_nodes(count), ceil_log2(count));
    }
}

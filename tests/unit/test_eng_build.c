/* test_eng_build.c - hierarchies of objects, and the tree over them.
 *
 * Source: daemon/engine/paper/build.h; paper sections 6.2 and 7.
 */
#include "eng_kit.h"

#include <time.h>

#include "kernel.h"
#include "refit.h"
#include "sort.h"
#include "trees.h"

static struct eng_scene *new_scene(void)
{
    struct eng_scene *scene = kit_scene();
    return scene;
}

/* Add an instance and let go of the mesh: the scene holds it. */
static uint32_t add(struct eng_scene *scene, struct eng_mesh *mesh, uint32_t id)
{
    uint32_t idx = UINT32_MAX;
    idx = kit_add(scene, mesh, id);
    return idx;
}

/* Do to trees what a step does. */
static void settle(struct eng_scene *scene)
{
    assert_ok(eng_paper_add_objects(scene));
    assert_ok(eng_build_top(scene));
    assert_false(eng_trees_of(scene)->top_is_stale);
    eng_refit(scene, NULL);
    assert_true(eng_tree_validate(scene));
}

static uint32_t ceil_log2(uint32_t n)
{
    uint32_t log = 0;
    while ((uint64_t)1 << log < n) {
        log++;
    }
    return log;
}

static bool is_root(const struct eng_scene *scene, uint32_t node_idx)
{
    for (uint32_t i = 0; i < scene->object_capacity; i++) {
        if (scene->objects[i].mesh &&
            eng_paper_object_of(&scene->objects[i])->nodes.first == node_idx) {
            return true;
        }
    }
    return false;
}

/* Walk from the root; every triangle of every object once. Returns the depth of the
 * deepest leaf, the root being 0; *top_depth: of the deepest object root. */
static uint32_t walk(const struct eng_scene *scene, uint32_t *top_depth)
{
    uint8_t *seen = test_room((eng_trees_of(scene)->triangle_capacity + 1));
    uint32_t stack[128][2];
    uint32_t count = 0;
    uint32_t depth = 0;
    uint32_t leaves = 0;
    *top_depth = 0;
    stack[count][0] = eng_trees_of(scene)->root;
    stack[count++][1] = 0;
    while (count > 0) {
        uint32_t node_idx = stack[--count][0];
        uint32_t level = stack[count][1];
        const struct eng_node *node = &eng_trees_of(scene)->nodes[node_idx];
        if (level > *top_depth && is_root(scene, node_idx)) {
            *top_depth = level;
        }
        if (node->left == ENG_LEAF) {
            assert_int_equal(seen[node->right]++, 0);
            leaves++;
            depth = level > depth ? level : depth;
            continue;
        }
        assert_true(count + 2 <= 128);
        stack[count][0] = node->left;
        stack[count++][1] = level + 1;
        stack[count][0] = node->right;
        stack[count++][1] = level + 1;
    }
    free(seen);
    assert_int_equal(leaves, eng_trees_of(scene)->nodes[eng_trees_of(scene)->root].count);
    return depth;
}

/* If it failed: triangles would be missing from the hierarchy, or the stacks that a
 * traversal sizes by its depth would run over. */
CASE(build__trees_of_every_size_are_complete_and_shallow)
{
    struct prng random = {20};
    for (uint32_t n = 1; n <= 100; n++) {
        struct eng_scene *scene = new_scene();
        uint32_t idx = add(scene, kit_soup(&random, n), n);
        uint32_t top_depth;
        settle(scene);
        assert_int_equal(eng_trees_of(scene)->root,
                         eng_paper_object_of(&scene->objects[idx])->nodes.first);
        assert_int_equal(eng_paper_object_of(&scene->objects[idx])->nodes.count,
                         2 * n - 1);
        assert_int_equal(eng_trees_of(scene)->nodes[eng_trees_of(scene)->root].count, n);
        assert_true(walk(scene, &top_depth) <= ceil_log2(n) + 1);
        assert_int_equal(top_depth, 0);
        eng_scene_free(scene);
    }
}

/* If it failed: many triangles at one place would make a list of the tree, or no tree. */
CASE(build__identical_centroids_split_evenly)
{
    const double x[6][3] = {{1, 0, 0},  {0, 1, 0},  {0, 0, 1},
                            {-1, 2, 0}, {2, 0, -1}, {0, -1, 2}};
    for (uint32_t n = 1; n <= 1000; n = n * 3 + 1) {
        uint32_t(*triangles)[3] = test_room(n * sizeof *triangles);
        for (uint32_t t = 0; t < n; t++) {
            for (uint32_t k = 0; k < 3; k++) {
                triangles[t][k] =
                    (t + k) % 3 + t % 2 * 3; /* both have the same centroid */
            }
        }
        struct eng_scene *scene = new_scene();
        uint32_t top_depth;
        add(scene, kit_mesh(x, 6, triangles, n), 0);
        settle(scene);
        assert_true(walk(scene, &top_depth) <= ceil_log2(n) + 1);
        eng_scene_free(scene);
        free(triangles);
    }
}

/* If it failed: triangles at the limit of the coordinates would overflow a centroid. */
CASE(build__extreme_coordinates_make_a_tree)
{
    const double x[6][3] = {{1e18, 1e18, 1e18}, {1e18, 1e18, -1e18},
                            {1e18, 1e18, 0},    {-1e18, -1e18, -1e18},
                            {5e-324, 0, 0},     {-1e18, -1e18, 1e18}};
    const uint32_t triangles[3][3] = {{0, 1, 2}, {3, 4, 5}, {3, 5, 5}};
    struct eng_scene *scene = new_scene();
    uint32_t top_depth;
    add(scene, kit_mesh(x, 6, triangles, 3), 0);
    settle(scene);
    assert_true(walk(scene, &top_depth) <= 3);
    assert_true((double)eng_trees_of(scene)->nodes[eng_trees_of(scene)->root].hi0[0] >=
                1e18);
    assert_true((double)eng_trees_of(scene)->nodes[eng_trees_of(scene)->root].lo0[0] <=
                -1e18);
    eng_scene_free(scene);
}

/* If it failed: an object would be missing from the tree over the objects, or doubled. */
CASE(build__tree_over_objects_holds_each_once)
{
    struct prng random = {21};
    struct eng_scene *scene = new_scene();
    uint32_t triangles = 0;
    for (uint32_t n = 1; n <= 300; n++) {
        uint32_t size = 1 + prng_u32(&random, 5);
        uint32_t top_depth;
        add(scene, kit_soup(&random, size), n);
        triangles += size;
        if (n > 20 && n % 40 != 0) {
            continue;
        }
        settle(scene);
        assert_int_equal(eng_trees_of(scene)->nodes[eng_trees_of(scene)->root].count,
                         triangles);
        assert_int_equal(eng_trees_of(scene)->top.count, n - 1);
        assert_true(walk(scene, &top_depth) <= ceil_log2(n) + 1 + 3 + 1);
        assert_true(top_depth <= ceil_log2(n) + 1);
    }
    eng_scene_free(scene);
}

/* If it failed: removal would leave a dangling node, or lose room for nodes for good. */
CASE(build__tree_over_objects_follows_removals)
{
    struct prng random = {22};
    struct eng_scene *scene = new_scene();
    uint32_t ids[64];
    uint32_t top_depth;
    for (uint32_t i = 0; i < 64; i++) {
        ids[i] = add(scene, kit_soup(&random, 1 + i % 7), i);
    }
    settle(scene);
    for (uint32_t left = 64; left > 0; left--) {
        uint32_t pick = prng_u32(&random, left);
        assert_ok(eng_scene_remove(scene, ids[pick]));
        ids[pick] = ids[left - 1];
        settle(scene);
        if (left > 1) {
            walk(scene, &top_depth);
            assert_true(top_depth <= ceil_log2(left - 1) + 1);
        }
    }
    assert_int_equal(eng_trees_of(scene)->root, ENG_NO_NODE);
    assert_int_equal(eng_trees_of(scene)->node_ranges.end, 0); /* every node came back */
    assert_int_equal(scene->vertex_ranges.end, 0);
    assert_int_equal(eng_trees_of(scene)->edge_ranges.end, 0);
    assert_int_equal(eng_trees_of(scene)->triangle_ranges.end, 0);
    eng_scene_free(scene);
}

/* If it failed: the same objects would make another tree on another run. */
CASE(build__same_input_makes_the_same_bytes)
{
    struct eng_scene *scenes[2];
    for (int i = 0; i < 2; i++) {
        struct prng random = {23};
        scenes[i] = new_scene();
        for (uint32_t k = 0; k < 20; k++) {
            add(scenes[i], kit_soup(&random, 1 + 3 * k), k);
        }
        settle(scenes[i]);
    }
    assert_int_equal(eng_trees_of(scenes[0])->node_ranges.end,
                     eng_trees_of(scenes[1])->node_ranges.end);
    assert_memory_equal(eng_trees_of(scenes[0])->nodes, eng_trees_of(scenes[1])->nodes,
                        eng_trees_of(scenes[0])->node_ranges.end *
                            sizeof *eng_trees_of(scenes[0])->nodes);
    eng_scene_free(scenes[0]);
    eng_scene_free(scenes[1]);
}

/* If it failed: the validator would pass a broken tree, and the tests that lean on it. */
CASE(build__validator_sees_each_kind_of_damage)
{
    struct prng random = {24};
    struct eng_scene *scene = new_scene();
    struct eng_question question = ENG_QUESTION_DEFAULT;
    question.method = PCCD_METHOD_PAPER;
    add(scene, kit_soup(&random, 9), 1);
    add(scene, kit_soup(&random, 7), 2);
    kit_step(scene, &question); /* boxes are looked at where they are of the last step */
    assert_true(eng_tree_has_boxes(scene) && eng_tree_validate(scene));
    uint32_t end = eng_trees_of(scene)->node_ranges.end;
    for (uint32_t i = 0; i < end; i++) {
        struct eng_node *node = &eng_trees_of(scene)->nodes[i];
        struct eng_node saved = *node;
        node->count++;
        assert_false(eng_tree_validate(scene));
        *node = saved;
        if (i == eng_trees_of(scene)->root) {
            continue; /* nothing is above it that could notice a larger box */
        }
        node->hi1[1] += 100; /* no longer inside its parent */
        assert_false(eng_tree_validate(scene));
        *node = saved;
        node->lo0[2] = node->hi0[2] + 1; /* no longer around its content */
        assert_false(eng_tree_validate(scene));
        *node = saved;
        if (node->left == ENG_LEAF) {
            uint32_t object = eng_trees_of(scene)->triangles[node->right].object;
            uint32_t first =
                eng_paper_object_of(&scene->objects[object])->triangles.first;
            node->right =
                node->right == first ? first + 1 : first; /* another's triangle */
            assert_false(eng_tree_validate(scene));
            *node = saved;
        }
    }
    assert_true(eng_tree_validate(scene));
    eng_scene_free(scene);
}

#define ITEMS 100000u

/* Put numbers 0 .. count-1 as centroids, in one of several orders. */
static void arrange(struct eng_split_item *items, uint32_t count, int order)
{
    struct prng random = {25};
    for (uint32_t i = 0; i < count; i++) {
        uint32_t half = count / 2;
        uint32_t killer = i < half ? (i % 2 == 0 ? i + 1 : half + i + (half % 2 == 0))
                                   : 2 * (i - half) + 2; /* of the median of three */
        uint32_t value = order == 0   ? i
                         : order == 1 ? count - i
                         : order == 2 ? (i < half ? i : count - i)
                         : order == 3 ? 7
                         : order == 4 ? prng_u32(&random, 10)
                         : order == 5 ? killer
                                      : (uint32_t)prng_next(&random) >> 8;
        items[i].centroid[0] = 0;
        items[i].centroid[1] = (float)value;
        items[i].centroid[2] = -(float)value;
        items[i].id = order % 2 ? i : count - i;
    }
}

static int compare_items(const void *a, const void *b)
{
    const struct eng_split_item *x = a;
    const struct eng_split_item *y = b;
    if (x->centroid[1] != y->centroid[1]) {
        return x->centroid[1] < y->centroid[1] ? -1 : 1;
    }
    return x->id < y->id ? -1 : x->id > y->id;
}

/* If it failed: a tree would depend on the order of triangles, or take hours to build. */
CASE(build__median_split_makes_the_same_halves_from_any_order)
{
    static struct eng_split_item items[ITEMS];
    static struct eng_split_item sorted[ITEMS];
    for (uint32_t count = 1; count <= ITEMS; count = count * 3 + (count < 10)) {
        for (int order = 0; order < 14; order++) {
            uint32_t middle = order < 7 ? count / 2 : order < 10 ? count / 9 : count - 1;
            arrange(items, count, order % 7);
            memcpy(sorted, items, count * sizeof *items);
            qsort(sorted, count, sizeof *sorted, compare_items);
            clock_t begin = clock();
            eng_median_split(items, count, middle, 1, eng_kernels()->come_before);
            /* A hundred times what it takes; quadratic time would be twice as long. */
            assert_true(clock() - begin < CLOCKS_PER_SEC / 2);
            qsort(items, middle, sizeof *items, compare_items);
            qsort(items + middle, count - middle, sizeof *items, compare_items);
            assert_memory_equal(items, sorted, count * sizeof *items);
        }
    }
}

/* test_eng_refit_plan.c - how a team divides the refit.
 *
 * Source: daemon/engine/paper/refit.h; paper section 6.1.
 */
#include "eng_kit.h"
#include "refit.h"
#include "trees.h"

/* Very different sizes, so that the tree over the objects is lopsided. */
static const uint32_t sizes[] = {700, 1, 3, 1, 40, 2, 1, 2000, 1, 5, 1};
#define OBJECT_COUNT (sizeof sizes / sizeof *sizes)

static const uint32_t teams[] = {1, 2, 3, 4, 8, 16, 64, 256};
#define TEAM_COUNT (sizeof teams / sizeof *teams)

struct fixture {
    struct eng_scene *scene;
    struct eng_refit_plan plan;
};

static int setup(void **state)
{
    struct fixture *f = test_room(sizeof *f);
    struct prng random = {11};
    f->scene = kit_scene();
    for (uint32_t i = 0; i < OBJECT_COUNT; i++) {
        kit_add(f->scene, kit_soup(&random, sizes[i]), i);
    }
    assert_ok(eng_scene_remove(f->scene, 4)); /* a gap in every array */
    assert_ok(eng_paper_add_objects(f->scene));
    assert_ok(eng_build_top(f->scene));
    *state = f;
    return 0;
}

static int teardown(void **state)
{
    struct fixture *f = *state;
    eng_refit_plan_deinit(&f->plan);
    eng_scene_free(f->scene);
    free(f);
    return 0;
}

static void divide(struct fixture *f, enum eng_refit_scheme scheme, uint32_t threads)
{
    assert_ok(eng_refit_plan_tree(&f->plan, f->scene, scheme, threads));
}

/* Opened nodes come after their parents, and their children are opened or roots. */
static void check_tree(const struct fixture *f)
{
    const struct eng_refit_plan *plan = &f->plan;
    uint32_t *children = test_room((plan->opened_count + 1) * sizeof *children);
    uint64_t triangles = 0;
    for (uint32_t i = 0; i < plan->opened_count; i++) {
        uint32_t parent = plan->opened_parent[i];
        assert_int_equal(atomic_load(&plan->unfinished[i]), 2);
        assert_int_equal(parent == ENG_NO_NODE,
                         plan->opened[i] == eng_trees_of(f->scene)->root);
        if (parent != ENG_NO_NODE) {
            const struct eng_node *up =
                &eng_trees_of(f->scene)->nodes[plan->opened[parent]];
            assert_true(parent < i);
            assert_true(up->left == plan->opened[i] || up->right == plan->opened[i]);
            children[parent]++;
        }
    }
    for (uint32_t i = 0; i < plan->root_count; i++) {
        uint32_t parent = plan->root_parent[i];
        triangles += eng_trees_of(f->scene)->nodes[plan->roots[i]].count;
        assert_int_equal(parent == ENG_NO_NODE,
                         plan->roots[i] == eng_trees_of(f->scene)->root);
        if (parent != ENG_NO_NODE) {
            const struct eng_node *up =
                &eng_trees_of(f->scene)->nodes[plan->opened[parent]];
            assert_true(up->left == plan->roots[i] || up->right == plan->roots[i]);
            children[parent]++;
        }
    }
    for (uint32_t i = 0; i < plan->opened_count; i++) {
        assert_int_equal(children[i], 2);
    }
    assert_int_equal(triangles,
                     eng_trees_of(f->scene)->nodes[eng_trees_of(f->scene)->root].count);
    free(children);
}

/* If it failed: a subtree would be refit by two threads, by none, or before its parent
 * for ever. */
CASE_WITH(refit_plan__subtrees_make_up_the_tree, setup, teardown)
{
    struct fixture *f = *state;
    for (size_t i = 0; i < TEAM_COUNT; i++) {
        divide(f, ENG_REFIT_EVEN, teams[i]);
        check_tree(f);
        divide(f, ENG_REFIT_PAPER, teams[i]);
        check_tree(f);
    }
}

/* If it failed: the comparison with the paper would be with something else. */
CASE_WITH(refit_plan__paper_has_two_subtrees_a_thread, setup, teardown)
{
    struct fixture *f = *state;
    for (size_t i = 0; i < TEAM_COUNT; i++) {
        divide(f, ENG_REFIT_PAPER, teams[i]);
        assert_int_equal(f->plan.root_count, 2 * teams[i]);
        assert_int_equal(f->plan.dealt, teams[i]);
    }
}

/* If it failed: one thread would be left with a large subtree while the others wait. */
CASE_WITH(refit_plan__even_subtrees_are_small, setup, teardown)
{
    struct fixture *f = *state;
    uint32_t triangles =
        eng_trees_of(f->scene)->nodes[eng_trees_of(f->scene)->root].count;
    for (size_t i = 0; i < TEAM_COUNT; i++) {
        divide(f, ENG_REFIT_EVEN, teams[i]);
        assert_int_equal(f->plan.dealt, 0);
        for (uint32_t k = 0; k < f->plan.root_count; k++) {
            uint32_t count = eng_trees_of(f->scene)->nodes[f->plan.roots[k]].count;
            assert_true(count == 1 || count <= triangles / (16 * teams[i]));
        }
    }
}

static void check_chunks(const struct eng_refit_chunks *chunks, uint32_t end,
                         unsigned char *seen, unsigned char *wanted)
{
    memset(seen, 0, end);
    for (uint32_t i = 0; i < chunks->count; i++) {
        const struct eng_range *range = &chunks->ranges[i];
        assert_true(range->count > 0 && range->count <= ENG_REFIT_CHUNK);
        for (uint32_t k = range->first; k < range->first + range->count; k++) {
            seen[k]++;
        }
    }
    assert_memory_equal(seen, wanted, end);
}

/* If it failed: the box of a vertex or an edge would stay where it was. */
CASE_WITH(refit_plan__chunks_hold_every_feature_once, setup, teardown)
{
    static unsigned char seen[1 << 16];
    static unsigned char vertices[1 << 16];
    static unsigned char edges[1 << 16];
    struct fixture *f = *state;
    assert_true(f->scene->vertex_ranges.end < sizeof seen);
    assert_true(eng_trees_of(f->scene)->edge_ranges.end < sizeof seen);
    for (uint32_t i = 0; i < OBJECT_COUNT; i++) {
        const struct eng_object *object = eng_scene_object(f->scene, i);
        if (object) {
            memset(vertices + object->vertices.first, 1, object->vertices.count);
            memset(edges + eng_paper_object_of(object)->edges.first, 1,
                   eng_paper_object_of(object)->edges.count);
        }
    }
    assert_ok(eng_refit_plan_features(&f->plan, f->scene));
    check_chunks(&f->plan.vertices, f->scene->vertex_ranges.end, seen, vertices);
    check_chunks(&f->plan.edges, eng_trees_of(f->scene)->edge_ranges.end, seen, edges);
    uint64_t least = f->scene->vertex_ranges.end / ENG_REFIT_CHUNK;
    assert_true(f->plan.vertices.count <= least + 3); /* neighbours share chunks */
}

static void forget(struct eng_scene *scene, struct eng_range nodes)
{
    for (uint32_t i = nodes.first; i < nodes.first + nodes.count; i++) {
        memset(eng_trees_of(scene)->nodes[i].lo0, 0xff,
               sizeof eng_trees_of(scene)->nodes[i].lo0);
    }
}

/* If it failed: a subtree with nodes above objects would keep old boxes. */
CASE_WITH(refit_plan__every_subtree_is_refit_as_a_whole, setup, teardown)
{
    struct fixture *f = *state;
    struct eng_scene *scene = f->scene;
    eng_refit(scene, NULL);
    size_t bytes =
        eng_trees_of(scene)->node_ranges.end * sizeof *eng_trees_of(scene)->nodes;
    void *expected = test_copy(eng_trees_of(scene)->nodes, bytes);
    for (uint32_t i = 0; i < eng_trees_of(scene)->top.count; i++) {
        uint32_t root = eng_trees_of(scene)->top.first + i;
        forget(scene, eng_trees_of(scene)->top);
        for (uint32_t k = 0; k < OBJECT_COUNT; k++) {
            const struct eng_object *object = eng_scene_object(scene, k);
            forget(scene, object ? eng_paper_object_of(object)->nodes
                                 : (struct eng_range){0, 0});
        }
        eng_refit_subtree(scene, root);
        const struct eng_node *was = (const struct eng_node *)expected + root;
        assert_memory_equal(&eng_trees_of(scene)->nodes[root], was, sizeof *was);
        eng_refit(scene, NULL);
        assert_memory_equal(eng_trees_of(scene)->nodes, expected, bytes);
    }
    free(expected);
}

/* test_eng_replace.c - objects that change their topology between steps. */
#include "eng_kit.h"
#include "memory.h"
#include "trees.h"
#include "world.h"

#define SIDE 6u

/* A sheet that falls through another one. */
struct fixture {
    struct eng_scene *scene;
    struct eng_mesh *sheet;
    struct eng_mesh *finer;
    uint32_t low;
    uint32_t high;
};

static void open_scene(struct fixture *f, struct eng_mesh *low, struct eng_mesh *high)
{
    f->scene = kit_scene();
    assert_ok(eng_scene_add(f->scene, low, 7, &f->low));
    assert_ok(eng_scene_add(f->scene, high, 9, &f->high));
}

static int set_up(void **state)
{
    static struct fixture fixture;
    fixture.sheet = kit_sheet(SIDE, 0);
    fixture.finer = kit_sheet(2 * SIDE, 0.25);
    open_scene(&fixture, fixture.sheet, fixture.sheet);
    *state = &fixture;
    return 0;
}

static int tear_down(void **state)
{
    struct fixture *f = *state;
    eng_scene_free(f->scene);
    eng_mesh_release(f->sheet);
    eng_mesh_release(f->finer);
    assert_int_equal(eng_alloc_bytes(), 0);
    return 0;
}

/* The high sheet from where it was registered, tilted, down to `z`. */
static uint64_t step(struct fixture *f, double z)
{
    const struct eng_question settings = ENG_QUESTION_DEFAULT;
    const double from[12] = {1, 0, 0, 0.01, 0, 1, 0, 0.02, 0, 0, 1, 0.5};
    const double to[12] = {1, 0, 0, 0.03, 0, 1, 0, 0.01, 0.125, 0.0625, 1, z};
    uint32_t count = eng_scene_vertex_count(f->scene, f->high);
    assert_ok(eng_paper_add_objects(f->scene)); /* trees of both methods */
    eng_stage_begin(f->scene);
    assert_ok(eng_stage_rigid(f->scene, f->high, 0, count, from, to));
    struct eng_step_result result = kit_step(f->scene, &settings);
    assert_true(result.count > 0);
    return result.hash[1];
}

/* If it failed: a replaced object would answer otherwise than one made so. */
CASE_WITH(replace__answers_as_a_fresh_object, set_up, tear_down)
{
    struct fixture *f = *state;
    struct fixture fresh = *f;
    step(f, -0.75);
    open_scene(&fresh, f->sheet, f->finer);
    uint32_t idx = f->high;
    assert_ok(eng_scene_replace(f->scene, idx, f->finer));
    assert_int_equal(eng_scene_object_count(f->scene), 2);
    assert_int_equal(eng_scene_vertex_count(f->scene, idx), 13 * 13);
    for (int i = 0; i < 3; i++) {
        assert_true(step(f, -0.5 - i) == step(&fresh, -0.5 - i));
    }
    eng_scene_free(fresh.scene);
}

/* If it failed: an attempt that came to nothing would have moved or changed something. */
CASE_WITH(replace__taken_back_leaves_everything_as_it_was, set_up, tear_down)
{
    struct fixture *f = *state;
    struct fixture twin = *f;
    open_scene(&twin, f->sheet, f->sheet);
    assert_true(step(f, -0.75) == step(&twin, -0.75));
    for (int i = 0; i < 3; i++) {
        uint32_t end = eng_trees_of(f->scene)->node_ranges.end;
        assert_ok(eng_scene_try_replace(f->scene, f->low, f->finer));
        assert_ok(eng_scene_try_replace(f->scene, f->high, f->finer));
        assert_int_equal(eng_scene_vertex_count(f->scene, f->low), 13 * 13);
        assert_int_equal(f->scene->leaf_count, 2 * f->finer->info.triangle_count);
        eng_scene_take_back(f->scene);
        assert_int_equal(eng_scene_vertex_count(f->scene, f->low), 7 * 7);
        assert_int_equal(f->scene->leaf_count, 2 * f->sheet->info.triangle_count);
        assert_int_equal(eng_trees_of(f->scene)->node_ranges.end, end);
        assert_true(step(f, -0.5 - i) == step(&twin, -0.5 - i));
    }
    eng_scene_free(twin.scene);
}

/* If it failed: what an object was would stay in memory, or go while it is in use. */
CASE_WITH(replace__settled_releases_what_was, set_up, tear_down)
{
    struct fixture *f = *state;
    step(f, -0.75);
    assert_ok(eng_scene_try_replace(f->scene, f->low, f->finer));
    assert_ok(eng_scene_try_replace(f->scene, f->high, f->finer));
    eng_scene_settle(f->scene);
    step(f, -0.5);
    assert_ok(eng_scene_remove(f->scene, f->low));
    assert_ok(eng_scene_remove(f->scene, f->high));
    assert_int_equal(f->scene->vertex_ranges.end, 0);
    assert_int_equal(eng_trees_of(f->scene)->triangle_ranges.end, 0);
    assert_int_equal(f->scene->leaf_count, 0);
}

/* If it failed: a client's handle would name something else after its object broke, or
 * the others would pay for it. */
CASE_WITH(replace__touches_nothing_but_its_object, set_up, tear_down)
{
    struct fixture *f = *state;
    step(f, -0.75);
    const struct eng_object *other = eng_scene_object(f->scene, f->high);
    const struct eng_object before = *other;
    struct eng_range range = eng_paper_object_of(other)->nodes;
    assert_true(range.count > 0);
    size_t node_bytes = range.count * sizeof *eng_trees_of(f->scene)->nodes;
    size_t x_bytes = before.vertices.count * sizeof *f->scene->x[0];
    void *nodes = test_copy(eng_trees_of(f->scene)->nodes + range.first, node_bytes);
    void *x = test_copy(f->scene->x[f->scene->now] + before.vertices.first, x_bytes);
    uint64_t builds = f->scene->builds;
    uint32_t idx;
    assert_ok(eng_scene_replace(f->scene, f->low, f->finer));
    assert_int_equal(f->scene->builds, builds + 1);
    assert_int_equal(eng_scene_object_count(f->scene), 2);
    assert_int_equal(eng_scene_object(f->scene, f->low)->id, 7);
    assert_int_equal(eng_scene_vertex_count(f->scene, f->low), 13 * 13);
    assert_int_equal(eng_scene_add(f->scene, f->sheet, 7, &idx), PCCD_E_INVAL);
    other = eng_scene_object(f->scene, f->high);
    assert_memory_equal(other, &before, sizeof before);
    assert_memory_equal(eng_trees_of(f->scene)->nodes + range.first, nodes, node_bytes);
    assert_memory_equal(f->scene->x[f->scene->now] + before.vertices.first, x, x_bytes);
    free(nodes);
    free(x);
}

/* If it failed: an object that keeps breaking would fill the memory. */
CASE_WITH(replace__a_thousand_times_grows_nothing, set_up, tear_down)
{
    struct fixture *f = *state;
    uint64_t bytes = 0;
    uint64_t scene_bytes = 0;
    uint32_t ends[4] = {0};
    for (int i = 0; i < 1000; i++) {
        assert_ok(eng_scene_replace(f->scene, i % 3 ? f->low : f->high,
                                    i % 2 ? f->sheet : f->finer));
        if (i % 20 == 0) {
            step(f, -0.75);
        }
        const uint32_t now[4] = {f->scene->vertex_ranges.end,
                                 eng_trees_of(f->scene)->edge_ranges.end,
                                 eng_trees_of(f->scene)->triangle_ranges.end,
                                 eng_trees_of(f->scene)->node_ranges.end};
        for (int k = 0; k < 4; k++) {
            assert_true(i < 100 || now[k] <= ends[k]);
            ends[k] = i < 100 && now[k] > ends[k] ? now[k] : ends[k];
        }
        bytes = i == 100 ? eng_alloc_bytes() : bytes;
        scene_bytes = i == 100 ? eng_scene_bytes(f->scene) : scene_bytes;
    }
    step(f, -0.75); /* as at i == 100: every object has its hierarchy */
    assert_int_equal(eng_alloc_bytes(), bytes);
    assert_int_equal(eng_scene_bytes(f->scene), scene_bytes);
}

/* If it failed: a mesh would stay in memory after the last object that had it, or go
 * while one has it. */
CASE_WITH(replace__holds_the_new_mesh_and_drops_the_old, set_up, tear_down)
{
    struct fixture *f = *state;
    uint64_t bytes = 0;
    for (int i = 0; i < 8; i++) {
        struct eng_mesh *mesh = kit_sheet(SIDE, 0);
        assert_ok(eng_scene_replace(f->scene, f->low, mesh));
        eng_mesh_release(mesh); /* the scene's is the last one */
        step(f, -0.75);
        assert_ptr_equal(eng_scene_object(f->scene, f->low)->mesh, mesh);
        assert_ok(eng_scene_replace(f->scene, f->low, mesh)); /* itself */
        step(f, -0.5);
        assert_ok(eng_scene_replace(f->scene, f->low, f->sheet));
        step(f, -0.25);
        assert_true(i < 4 || eng_alloc_bytes() == bytes);
        bytes = eng_alloc_bytes();
    }
}

/* If it failed: a wrong call would be taken for another, or would leave something behind.
 */
CASE_WITH(replace__wrong_calls_are_refused, set_up, tear_down)
{
    struct fixture *f = *state;
    struct fixture twin = *f;
    struct eng_mesh *empty = NULL;
    open_scene(&twin, f->sheet, f->sheet);
    uint64_t bytes = eng_alloc_bytes();
    assert_ok(eng_mesh_new(3, 1, &empty));
    assert_int_equal(eng_scene_replace(f->scene, 77, f->finer), PCCD_E_INVAL);
    assert_int_equal(eng_scene_replace(f->scene, f->low, empty), PCCD_E_STATE);
    assert_int_equal(eng_scene_try_replace(f->scene, 77, f->finer), PCCD_E_INVAL);
    assert_int_equal(eng_scene_try_replace(f->scene, f->low, empty), PCCD_E_STATE);
    eng_stage_begin(f->scene);
    assert_int_equal(eng_scene_try_replace(f->scene, f->low, f->finer), PCCD_E_STATE);
    assert_int_equal(eng_scene_replace(f->scene, f->low, f->finer), PCCD_E_STATE);
    eng_stage_abort(f->scene);
    eng_mesh_release(empty);
    assert_int_equal(eng_alloc_bytes(), bytes);
    assert_int_equal(eng_scene_vertex_count(f->scene, f->low), 7 * 7);
    assert_true(step(f, -0.75) == step(&twin, -0.75));
    eng_scene_free(twin.scene);
}

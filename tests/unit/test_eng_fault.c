/* test_eng_fault.c - the engine when memory runs out. */
#include "eng_scarce.h"

#include "paper.h"
#include "stage_turning.h"
#include "step.h"
#include "trees.h"
#include "wide_state.h"
#include "world.h"

/* ---- one thread -------------------------------------------------------------------- */

#define SIDE 2u
#define V    ((SIDE + 1) * (SIDE + 1))

static struct eng_mesh *make_sheet(void)
{
    struct eng_mesh *mesh = NULL;
    double x[V][3];
    uint32_t triangles[2 * SIDE * SIDE][3];
    uint32_t bad;
    for (uint32_t i = 0; i < V; i++) {
        x[i][0] = i % (SIDE + 1);
        x[i][1] = i / (SIDE + 1);
        x[i][2] = 0;
    }
    for (uint32_t i = 0; i < SIDE * SIDE; i++) {
        uint32_t corner = i / SIDE * (SIDE + 1) + i % SIDE;
        const uint32_t square[2][3] = {
            {corner, corner + 1, corner + SIDE + 1},
            {corner + 1, corner + SIDE + 2, corner + SIDE + 1}};
        memcpy(triangles[2 * i], square, sizeof square);
    }
    RETRY(eng_mesh_new(V, 2 * SIDE * SIDE, &mesh));
    RETRY(eng_mesh_write_vertices(mesh, PCCD_FORMAT_F64, 0, V, x));
    RETRY(eng_mesh_write_triangles(mesh, 0, 2 * SIDE * SIDE, triangles, &bad));
    RETRY(eng_mesh_commit(mesh, 1));
    RETRY(eng_mesh_sort_features(mesh, 1));
    return mesh;
}

static int stage(struct eng_scene *scene, uint32_t object_idx, int seed)
{
    struct prng random = {(uint64_t)seed};
    const double from[12] = {1, 0, 0, 0.3, 0, 1, 0, 0.2, 0, 0, 1, 0.5 + seed};
    const double to[12] = {1, 0.1, 0, 0, 0, 1, 0.1, 0, 0, 0.2, 1, -0.5 - seed};
    double x0[V][3];
    double x1[V][3];
    for (uint32_t i = 0; i < 3 * V; i++) {
        double place = i % 3 == 0 && object_idx > 2 ? 3.0 * object_idx : 0;
        x0[i / 3][i % 3] = place + prng_between(&random, 0, SIDE);
        x1[i / 3][i % 3] = place + prng_between(&random, 0, SIDE);
    }
    if (seed % 3 == 0 && object_idx < 3) {
        return eng_stage_rigid(scene, object_idx, 0, V, from, to);
    }
    if (seed % 3 == 1) {
        return eng_stage_x0x1(scene, object_idx, PCCD_FORMAT_F64, 0, V, x0, x1);
    }
    for (uint32_t v = 0; v < V; v++) { /* one write a vertex: the list of writes grows */
        int status =
            eng_stage_x0x1(scene, object_idx, PCCD_FORMAT_F64, v, 1, x0[v], x1[v]);
        if (status != PCCD_OK) {
            return status;
        }
    }
    return PCCD_OK;
}

/* Stage and step once. A step without room for its records is whole but for them. */
static int try_step(struct eng_scene *scene, enum pccd_mode mode, enum pccd_method method,
                    int seed, struct eng_step_result *result)
{
    struct eng_question settings = kit_contacts(mode, method);
    settings.touching = seed % 2 == 0 ? PCCD_TOUCHING_LEFT_OUT : PCCD_TOUCHING_KEPT;
    eng_stage_begin(scene);
    for (uint32_t idx = 0; idx < scene->object_capacity; idx++) {
        int status =
            eng_scene_object(scene, idx) ? stage(scene, idx, seed + (int)idx) : 0;
        if (status != PCCD_OK) {
            eng_stage_abort(scene);
            return status;
        }
    }
    const uint64_t failed_before = scarce.failures;
    int status = eng_step(scene, &settings, result);
    assert_false(scene->staging);
    if (status == PCCD_OK && result->incomplete != PCCD_COMPLETE) {
        assert_int_equal(result->incomplete, PCCD_INCOMPLETE_CONTACT_LIMIT);
        assert_true(scarce.failures > failed_before);
        status = PCCD_E_NOMEM;
    }
    return status;
}

#define STEPS_MAX 32u

/* The hashes that a life has seen. */
struct journal {
    uint64_t hash[STEPS_MAX];
    uint32_t count;
};

static void step(struct eng_scene *scene, enum pccd_mode mode, int seed,
                 struct journal *journal)
{
    struct eng_step_result result;
    enum pccd_method method = seed % 2 ? PCCD_METHOD_PAPER : PCCD_METHOD_WIDE;
    RETRY(try_step(scene, mode, method, seed, &result));
    assert_true(method == PCCD_METHOD_WIDE || eng_tree_validate(scene));
    assert_true(journal->count < STEPS_MAX);
    journal->hash[journal->count++] = result.hash[1];
}

/* A failed attempt leaves the scene's positions alone. */
static void check_failed_step_moves_nothing(struct eng_scene *scene)
{
    struct eng_question settings = ENG_QUESTION_DEFAULT;
    struct eng_step_result result;
    size_t bytes = scene->vertex_ranges.end * sizeof *scene->x[0];
    double *before = test_room(bytes);
    double x[1][3] = {{9, 9, 9}};
    settings.mode = PCCD_MODE_ANY;
    memcpy(before, scene->x[scene->now], bytes);
    eng_stage_begin(scene);
    int status = eng_stage_x1(scene, 0, PCCD_FORMAT_F64, 0, 1, x);
    if (status == PCCD_OK) {
        status = eng_step(scene, &settings, &result);
    } else {
        eng_stage_abort(scene);
    }
    if (!scarce_recovered(status)) {
        assert_memory_equal(scene->x[scene->now], before, bytes);
    }
    free(before);
}

/* Both objects get the mesh, or both are what they were. */
static int replace_both(struct eng_scene *scene, const uint32_t idx[2],
                        struct eng_mesh *mesh)
{
    const struct eng_object before[2] = {scene->objects[idx[0]], scene->objects[idx[1]]};
    int status = eng_scene_try_replace(scene, idx[0], mesh);
    if (status == PCCD_OK) {
        status = eng_scene_try_replace(scene, idx[1], mesh);
    }
    if (status == PCCD_OK) {
        eng_scene_settle(scene);
        return status;
    }
    eng_scene_take_back(scene);
    for (int i = 0; i < 2; i++) {
        const struct eng_object *now = &scene->objects[idx[i]];
        assert_ptr_equal(now->mesh, before[i].mesh);
        assert_int_equal(now->id, before[i].id);
        assert_int_equal(now->vertices.first, before[i].vertices.first);
        assert_int_equal(eng_paper_object_of(now)->nodes.first,
                         eng_paper_object_of(&before[i])->nodes.first);
    }
    return status;
}

static void live(struct journal *journal)
{
    struct eng_scene *scene = NULL;
    uint32_t idx[20];
    journal->count = 0;
    struct eng_mesh *mesh = make_sheet();
    RETRY(eng_scene_new(NULL, &scene));
    step(scene, PCCD_MODE_ALL, 0, journal);
    for (uint32_t i = 0; i < 3; i++) {
        RETRY(eng_scene_add(scene, mesh, i, &idx[i]));
        assert_int_equal(eng_scene_object_count(scene), i + 1);
        step(scene, i == 1 ? PCCD_MODE_PAIRS : PCCD_MODE_ALL, (int)i, journal);
    }
    assert_ok(eng_scene_remove(scene, idx[1]));
    step(scene, PCCD_MODE_FIRST, 3, journal);
    for (uint32_t i = 3; i < 20; i++) { /* the tables of objects and holes grow */
        RETRY(eng_scene_add(scene, mesh, i, &idx[i]));
    }
    check_failed_step_moves_nothing(scene);
    step(scene, PCCD_MODE_ANY, 4, journal);
    for (uint32_t i = 3; i < 20; i++) { /* the first pair takes memory, the 33rd more */
        const struct eng_object_filter bits = {1u << i % 3, 6 - i % 3, i % 4 > 0};
        assert_ok(eng_scene_set_filter(scene, idx[i], &bits));
        RETRY(eng_scene_ignore(scene, idx[i], idx[i - 3], true));
        RETRY(eng_scene_ignore(scene, idx[i], idx[0], true));
        RETRY(eng_scene_ignore(scene, idx[i], idx[2], true));
    }
    struct eng_mesh *other = make_sheet();
    RETRY(replace_both(scene, idx + 4, other));
    RETRY(eng_scene_replace(scene, idx[7], other));
    eng_mesh_release(other);
    step(scene, PCCD_MODE_ALL, 8, journal);
    for (uint32_t i = 3; i < 20; i += 2) {
        assert_ok(eng_scene_remove(scene, idx[i]));
    }
    step(scene, PCCD_MODE_PAIRS, 5, journal);
    step(scene, PCCD_MODE_ALL, 6, journal);
    for (uint32_t i = 0; i < 20; i++) {
        if (eng_scene_object(scene, idx[i])) {
            assert_ok(eng_scene_remove(scene, idx[i]));
        }
    }
    step(scene, PCCD_MODE_ANY, 7, journal);
    assert_int_equal(scene->vertex_ranges.end, 0); /* no index was lost on the way */
    assert_int_equal(eng_trees_of(scene)->edge_ranges.end, 0);
    assert_int_equal(eng_trees_of(scene)->triangle_ranges.end, 0);
    assert_int_equal(eng_trees_of(scene)->node_ranges.end, 0);
    eng_mesh_release(mesh);
    eng_scene_free(scene);
}

/* If it failed: running out of memory would crash, leak, spoil the scene or change
 * answers. */
CASE(fault__every_allocation_may_fail)
{
    struct journal reference;
    struct journal journal;
    scarce.countdown = 0;
    uint64_t before = scarce.allocations;
    live(&reference);
    assert_int_equal(scarce.held_blocks, 0);
    uint64_t total = scarce.allocations - before;
    assert_true(total > 50);
    for (int mode = 0; mode < 2; mode++) {
        scarce.goes_on_failing = mode == 1;
        for (uint64_t n = 1; n <= total; n++) {
            scarce.countdown = n;
            scarce.failures = 0;
            live(&journal);
            assert_int_equal(scarce.failures, 1);
            assert_int_equal(journal.count, reference.count);
            assert_memory_equal(journal.hash, reference.hash,
                                reference.count * sizeof *reference.hash);
            assert_int_equal(scarce.held_blocks, 0);
            assert_int_equal(scarce.held_bytes, 0);
        }
    }
}

/* If it failed: a call that could not get memory would leave a part of it behind. */
CASE(fault__failed_calls_leave_nothing_behind)
{
    struct eng_mesh *mesh = NULL;
    struct eng_scene *scene = NULL;
    scarce.goes_on_failing = false;
    for (uint64_t n = 1; n <= 3; n++) {
        scarce.countdown = n;
        assert_int_equal(eng_mesh_new(100, 100, &mesh), PCCD_E_NOMEM);
        assert_null(mesh);
        assert_int_equal(scarce.held_blocks, 0);
    }
    for (uint64_t n = 1; n <= 2; n++) {
        scarce.countdown = n;
        assert_int_equal(eng_scene_new(NULL, &scene), PCCD_E_NOMEM);
        assert_null(scene);
        assert_int_equal(scarce.held_blocks, 0);
    }
    scarce.countdown = 0;
    mesh = make_sheet();
    int status = PCCD_E_NOMEM;
    for (uint64_t n = 1; status != PCCD_OK; n++) {
        uint32_t idx = 77;
        uint64_t before = scarce.allocations;
        assert_ok(eng_scene_new(NULL, &scene));
        uint64_t made = scarce.allocations - before;
        scarce.countdown = n;
        status = eng_scene_add(scene, mesh, 1, &idx);
        bool was_added = status == PCCD_OK;
        if (was_added) {
            status = eng_paper_add_objects(scene);
        }
        if (status != PCCD_OK) {
            assert_int_equal(status, PCCD_E_NOMEM);
            assert_int_equal(scarce.allocations - before,
                             made + n - 1); /* each in its turn */
            assert_int_equal(idx, was_added ? 0 : 77);
            assert_int_equal(eng_scene_object_count(scene), was_added);
            assert_int_equal(scene->vertex_ranges.end > 0, was_added);
            assert_int_equal(eng_trees_of(scene)->edge_ranges.end,
                             0); /* the ranges came back */
            assert_int_equal(eng_trees_of(scene)->triangle_ranges.end, 0);
            assert_int_equal(eng_trees_of(scene)->node_ranges.end, 0);
        } else {
            assert_true(n > 10);
            assert_true(eng_trees_of(scene)->node_ranges.end > 0);
        }
        scarce.countdown = 0;
        eng_scene_free(scene);
    }
    eng_mesh_release(mesh);
    assert_int_equal(scarce.held_blocks, 0);
}

/* Some vertices of a larger sheet in disorder: with regions of three triangles there is
 * work aside in every step. */
static void run_disorder(struct eng_scene *scene, struct journal *journal)
{
    for (int seed = 0; seed < 6; seed++) {
        struct eng_step_result result;
        assert_ok(try_step(scene, PCCD_MODE_ALL, PCCD_METHOD_PAPER, seed, &result));
        assert_true(eng_tree_validate(scene));
        journal->hash[journal->count++] = result.hash[1];
    }
}

/* If it failed: a step that lacks memory for a better hierarchy would fail with it. */
CASE(fault__steps_go_on_without_memory_aside)
{
    const struct eng_scene_settings settings = {1e-9, 3, 1};
    struct journal reference = {.count = 0};
    struct eng_mesh *mesh = kit_sheet(2 * SIDE, 0);
    for (uint64_t n = 0; n <= 1; n++) { /* items */
        struct journal journal = {.count = 0};
        struct eng_scene *scene;
        uint32_t idx;
        assert_ok(eng_scene_new(&settings, &scene));
        assert_ok(eng_scene_add(scene, mesh, 0, &idx));
        run_disorder(scene, &journal); /* nothing is as poor; room for contacts is made */
        assert_int_equal(eng_background_bytes(&eng_paper_of(scene)->background), 0);
        scene->settings.rebuild_ratio = 0.9;
        scarce.goes_on_failing = false;
        scarce.failures = 0;
        scarce.countdown = n;
        run_disorder(scene, &journal);
        assert_int_equal(scarce.failures, n > 0);
        assert_true(eng_background_bytes(&eng_paper_of(scene)->background) > 0);
        reference = n == 0 ? journal : reference;
        assert_memory_equal(&journal, &reference, sizeof journal);
        eng_scene_free(scene);
    }
    eng_mesh_release(mesh);
    assert_int_equal(scarce.held_blocks, 0);
}

/* If it failed: a step would fail for want of memory that only makes later ones faster,
 * or ask for it again in every step. */
CASE(fault__steps_go_on_without_memory_for_an_order)
{
    struct eng_mesh *mesh = make_sheet();
    struct eng_scene *scene;
    struct eng_step_result result;
    uint32_t idx;
    assert_ok(eng_scene_new(NULL, &scene));
    assert_ok(eng_scene_add(scene, mesh, 0, &idx));
    struct eng_wide_resort *resort = &eng_wide_state_of(scene)->resort;
    for (int round = 0; round < 2; round++) { /* the first step makes room for others */
        assert_ok(try_step(scene, PCCD_MODE_ALL, PCCD_METHOD_WIDE, 0, &result));
    }
    uint64_t hash = result.hash[1];
    resort->state = ENG_WIDE_WANTED;
    scarce.goes_on_failing = false;
    scarce.failures = 0;
    scarce.countdown = 1;
    assert_ok(try_step(scene, PCCD_MODE_ALL, PCCD_METHOD_WIDE, 0, &result));
    assert_int_equal(scarce.failures, 1);
    assert_int_equal(resort->state, ENG_WIDE_IDLE);
    assert_int_equal(eng_wide_resort_bytes(resort), 0);
    assert_true(result.hash[1] == hash);
    resort->state = ENG_WIDE_WANTED; /* with memory it is made */
    assert_ok(try_step(scene, PCCD_MODE_ALL, PCCD_METHOD_WIDE, 0, &result));
    assert_int_not_equal(resort->state, ENG_WIDE_IDLE);
    eng_scene_free(scene);
    eng_mesh_release(mesh);
    assert_int_equal(scarce.held_blocks, 0);
}

/* Three sheets turn on three joints, and one stands. */
static int try_turning_step(struct eng_scene *scene, enum pccd_mode mode,
                            uint32_t threads, struct eng_step_result *result)
{
    struct pccd_joint joints[3] = {
        {PCCD_JOINT_TURN,
         PCCD_NO_JOINT,
         {0.1, 0.2, 0.3},
         {0, 0, 0, 1},
         {0, 1, 0},
         {0},
         {3, 0, 0}},
        {PCCD_JOINT_TURN, 0, {1, 0, 0.3}, {0, 0, 0, 1}, {0, 1, 1}, {0}, {-2, 0, 0}},
        {PCCD_JOINT_SLIDE, 1, {0.3, 0, 0.4}, {0, 0, 0, 1}, {1, 1, 1}, {0}, {2, 0, 0}}};
    struct eng_question settings = ENG_QUESTION_DEFAULT;
    struct eng_bad_joint bad;
    uint32_t base = 0;
    settings.mode = mode;
    settings.threads = threads;
    settings.team_always = true;
    eng_stage_begin(scene);
    int status = eng_stage_joints(scene, joints, 3, &base, &bad);
    for (uint32_t i = 0; i < 3 && status == PCCD_OK; i++) {
        status = eng_stage_turning(scene, i, base + i);
    }
    if (status != PCCD_OK) {
        eng_stage_abort(scene);
        return status;
    }
    const uint64_t failed_before = scarce.failures;
    status = eng_step(scene, &settings, result);
    if (status == PCCD_OK && result->incomplete != PCCD_COMPLETE) {
        assert_true(result->incomplete == PCCD_INCOMPLETE_CONTACT_LIMIT ||
                    result->incomplete == PCCD_INCOMPLETE_UNDECIDED);
        assert_true(result->safe_step == 0 && scarce.failures > failed_before);
        status = PCCD_E_NOMEM;
    }
    return status;
}

static void live_turning(struct journal *journal, uint32_t threads)
{
    struct eng_scene *scene = NULL;
    struct eng_step_result result;
    uint32_t idx;
    journal->count = 0;
    struct eng_mesh *mesh = make_sheet();
    struct eng_mesh *other = make_sheet();
    RETRY(eng_scene_new(NULL, &scene));
    for (uint32_t i = 0; i < 4; i++) {
        RETRY(eng_scene_add(scene, i < 2 ? mesh : other, i, &idx));
    }
    for (int s = 0; s < 4; s++) {
        RETRY(try_turning_step(scene, (enum pccd_mode)(s % 3), threads, &result));
        journal->hash[journal->count++] = result.hash[1];
        assert_true(s > 0 || result.count > 0);
    }
    eng_mesh_release(mesh);
    eng_mesh_release(other);
    eng_scene_free(scene);
}

/* If it failed: a step in which objects turn would do what that says, or wait for ever
 * for a thread that had no memory. */
CASE(fault__every_allocation_of_a_turning_step_may_fail)
{
    struct journal reference;
    struct journal journal;
    for (uint32_t i = 0; i < 4; i++) {
        scarce.countdown = 0;
        scarce.goes_on_failing = i >= 2;
        live_turning(&reference, 1 + 2 * (i % 2));
        for (uint64_t n = 1, unharmed = 0; unharmed < 3; n++) {
            scarce.countdown = n;
            scarce.failures = 0;
            live_turning(&journal, 1 + 2 * (i % 2));
            unharmed += scarce.failures == 0;
            assert_int_equal(journal.count, reference.count);
            assert_memory_equal(journal.hash, reference.hash,
                                reference.count * sizeof *reference.hash);
            assert_int_equal(scarce.held_blocks, 0);
        }
    }
    scarce.countdown = 0;
}

/* ---- several threads --------------------------------------------------------------- */

#define TEAM_TRIANGLES 1100u /* enough for a team */
#define TEAM_THREADS   4u

static int try_team_step(struct eng_scene *scene, const struct eng_question *settings,
                         struct eng_step_result *result)
{
    const uint64_t failures = scarce.failures;
    int status = eng_step(scene, settings, result);
    if (status == PCCD_OK && result->incomplete != PCCD_COMPLETE) {
        assert_int_equal(result->incomplete, PCCD_INCOMPLETE_CONTACT_LIMIT);
        assert_true(scarce.failures > failures);
        return PCCD_E_NOMEM;
    }
    return status;
}

/* One step of a new scene, again if memory ran out; the hash of its answer. */
static uint64_t live_team(struct eng_mesh *mesh, enum pccd_mode mode,
                          enum eng_scheduler scheduler)
{
    struct eng_question settings = ENG_QUESTION_DEFAULT;
    struct eng_step_result result;
    struct eng_scene *scene = NULL;
    uint32_t idx;
    settings.mode = mode;
    settings.threads = TEAM_THREADS;
    settings.team_always = true;
    settings.tuning.scheduler = scheduler;
    RETRY(eng_scene_new(NULL, &scene));
    RETRY(eng_scene_add(scene, mesh, 1, &idx));
    RETRY(try_team_step(scene, &settings, &result));
    assert_true(result.count > 5000); /* enough to be merged by all */
    assert_int_equal(result.threads, TEAM_THREADS);
    uint64_t hash = result.hash[1];
    eng_scene_free(scene);
    return hash;
}

/* If it failed: threads would wait for ever for one that had no memory, or an answer
 * without some of its records would look whole. */
CASE(fault_team__every_allocation_of_a_step_may_fail)
{
    struct prng random = {92};
    struct eng_mesh *mesh = kit_soup(&random, TEAM_TRIANGLES);
    const uint64_t held = scarce.held_blocks;
    for (int i = 0; i < 4; i++) {
        enum eng_scheduler scheduler = i % 2 ? ENG_SCHEDULER_PAPER : ENG_SCHEDULER_STEAL;
        uint64_t hash = live_team(mesh, PCCD_MODE_PAIRS, scheduler);
        scarce.goes_on_failing = i >= 2;
        for (uint64_t n = 1, unharmed = 0; unharmed < 3; n++) {
            scarce.countdown = n;
            scarce.failures = 0;
            assert_true(live_team(mesh, PCCD_MODE_PAIRS, scheduler) == hash);
            unharmed += scarce.failures == 0;
            assert_int_equal(scarce.held_blocks, held);
            assert_true(n > 10 || scarce.failures == 1);
        }
        scarce.countdown = 0;
    }
    eng_mesh_release(mesh);
    assert_int_equal(scarce.held_blocks, 0);
}

/* test_eng_lend.c - scenes that are stepped with another one's worker, and items that
 * several threads take.
 */
#include "eng_kit.h"

#include <stdatomic.h>

#include "parallel.h"
#include "step.h"
#include "step_memory.h"
#include "world.h"

#define SCENES 12u
#define SIDE   6u
#define STEPS  5u

struct farm {
    struct eng_scene *scenes[SCENES];
    uint32_t objects[SCENES][2];
    struct eng_step_result results[SCENES];
};

static void make(struct farm *farm, struct eng_mesh *sheet)
{
    for (uint32_t i = 0; i < SCENES; i++) {
        farm->scenes[i] = kit_scene();
        for (uint32_t k = 0; k < 2; k++) {
            assert_ok(eng_scene_add(farm->scenes[i], sheet, k + 1, &farm->objects[i][k]));
        }
    }
}

static void drop(struct farm *farm)
{
    for (uint32_t i = 0; i < SCENES; i++) {
        eng_scene_free(farm->scenes[i]);
    }
}

/* One sheet goes through the other, in each scene and step in another way. */
static void stage(struct farm *farm, uint32_t i, uint32_t step)
{
    double x1[(SIDE + 1) * (SIDE + 1)][3];
    struct prng random = {i * 100 + step};
    for (uint32_t v = 0; v < (SIDE + 1) * (SIDE + 1); v++) {
        x1[v][0] = v % (SIDE + 1) + prng_between(&random, -0.2, 0.2);
        x1[v][1] = v / (SIDE + 1) + prng_between(&random, -0.2, 0.2);
        x1[v][2] = (step % 2 == 0 ? 1 : -1) * prng_between(&random, 0.1, 1);
        x1[v][0] /= SIDE;
        x1[v][1] /= SIDE;
    }
    eng_stage_begin(farm->scenes[i]);
    assert_ok(eng_stage_x1(farm->scenes[i], farm->objects[i][1], PCCD_FORMAT_F64, 0,
                           (SIDE + 1) * (SIDE + 1), x1));
}

static void step_one(struct farm *farm, uint32_t i, uint32_t step,
                     struct eng_scene *lender)
{
    struct eng_question settings =
        kit_contacts((enum pccd_mode)(step % PCCD_MODE_COUNT),
                     step == 3 ? PCCD_METHOD_PAPER : PCCD_METHOD_WIDE);
    settings.scratch_from = lender;
    stage(farm, i, step);
    farm->results[i] = kit_step(farm->scenes[i], &settings);
}

struct turn {
    struct farm *farm;
    uint32_t step;
};

static void step_item(void *context, uint32_t item, uint32_t thread)
{
    struct turn *turn = context;
    step_one(turn->farm, item, turn->step, turn->farm->scenes[thread]);
}

/* If it failed, a scene in a batch would have other contacts than by itself, or each
 * scene would keep the scratch of a thread. */
CASE(lent__worker_finds_what_an_own_one_finds)
{
    struct eng_mesh *sheet = kit_sheet(SIDE, 0);
    struct farm own = {.scenes = {NULL}}, lent = {.scenes = {NULL}};
    uint64_t records = 0;
    make(&own, sheet);
    make(&lent, sheet);
    for (uint32_t step = 0; step < STEPS; step++) {
        struct turn turn = {&lent, step};
        eng_parallel_for(&(const struct eng_parallel_for){
            .count = SCENES, .threads = 2, .item = step_item, .context = &turn});
        for (uint32_t i = 0; i < SCENES; i++) {
            step_one(&own, i, step, NULL);
            assert_int_equal(lent.results[i].count, own.results[i].count);
            assert_memory_equal(lent.results[i].hash, own.results[i].hash,
                                sizeof own.results[i].hash);
            records += own.results[i].count;
        }
    }
    assert_true(records > 0);
    for (uint32_t i = 0; i < SCENES; i++) {
        uint32_t workers = eng_step_memory_of(lent.scenes[i])->worker_count;
        assert_int_equal(workers, i < 2 ? 1 : 0);
        assert_int_equal(eng_step_memory_of(own.scenes[i])->worker_count, 1);
    }
    drop(&own);
    drop(&lent);
    eng_mesh_release(sheet);
}

/* If it failed, a scene that was stepped by itself once would keep its scratch for as
 * long as it lives, though only batches step it; or lose it between two steps by
 * itself. */
CASE(own__worker_goes_when_others_lend_theirs_for_long)
{
    struct eng_mesh *sheet = kit_sheet(SIDE, 0);
    struct farm farm = {.scenes = {NULL}};
    make(&farm, sheet);
    step_one(&farm, 5, 0, NULL);
    step_one(&farm, 0, 0, NULL);
    for (uint32_t step = 1; step <= 100; step++) {
        step_one(&farm, 5, step, farm.scenes[0]);
    }
    assert_int_equal(eng_step_memory_of(farm.scenes[5])->worker_count, 1);
    step_one(&farm, 5, 101, NULL);
    for (uint32_t step = 102; step <= 800; step++) {
        step_one(&farm, 5, step, farm.scenes[0]);
    }
    assert_int_equal(eng_step_memory_of(farm.scenes[5])->worker_count, 0);
    step_one(&farm, 5, 801, NULL);
    assert_int_equal(eng_step_memory_of(farm.scenes[5])->worker_count, 1);
    eng_step_free_scratch(farm.scenes[5]);
    assert_int_equal(eng_step_memory_of(farm.scenes[5])->worker_count, 0);
    drop(&farm);
    eng_mesh_release(sheet);
}

#define ITEMS 1000u

struct taken {
    atomic_uint times[ITEMS];
    uint32_t first[2];
    atomic_uint begun[2];
};

static void take(void *context, uint32_t item, uint32_t thread)
{
    struct taken *taken = context;
    assert_true(thread < 2);
    if (atomic_fetch_add(&taken->begun[thread], 1) == 0) {
        taken->first[thread] = item;
    }
    atomic_fetch_add(&taken->times[item], 1);
}

/* If it failed, a scene of a batch would be left out, or stepped twice. */
CASE(items__are_taken_once_each)
{
    static struct taken taken;
    for (uint32_t count = 0; count <= ITEMS; count = count * 3 + 1) {
        memset(&taken, 0, sizeof taken);
        eng_parallel_for(&(const struct eng_parallel_for){
            .count = count, .threads = 2, .item = take, .context = &taken});
        for (uint32_t i = 0; i < ITEMS; i++) {
            assert_int_equal(atomic_load(&taken.times[i]), i < count ? 1 : 0);
        }
        for (uint32_t thread = 0; thread < 2 && thread < count; thread++) {
            assert_int_equal(taken.first[thread], thread);
        }
    }
}

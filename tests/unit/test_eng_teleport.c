/* test_eng_teleport.c - a step's memory does not depend on how far things go. */
#include "eng_kit.h"
#include "eng_way.h"
#include "memory.h"
#include "topology.h"

#define TRIANGLES 600u
#define VERTICES  (3 * TRIANGLES)
#define FAR       100.0
#define KEPT      16u

/* Candidates of the far step to those of a calm one, at least. What is seen is 320 times,
 * two millions, whose names alone would take 16 MB. */
#define MORE_CANDIDATES 100u

/* Bytes that far steps may add for each thread: blocks of records, which are kept for the
 * next step; who finds how many is a matter of luck. */
#define MORE_BYTES_MAX (256u << 10)

/* Blocks of records that a step may take from the system, of 64 KiB each (result.h), for
 * each thread: records are thrown away when they are more than the limit. */
#define ALLOCS_MAX 24u

struct ground {
    struct eng_scene *scene;
    uint32_t object;
    double calm[2][VERTICES][3];
    double far[2][VERTICES][3];
};

static int setup(void **state)
{
    static struct ground ground;
    struct prng random = {4};
    struct eng_mesh *mesh = kit_soup(&random, TRIANGLES);
    memset(&ground, 0, sizeof ground);
    ground.scene = kit_scene();
    assert_ok(eng_scene_add(ground.scene, mesh, 1, &ground.object));
    for (uint32_t i = 0; i < 3 * VERTICES; i++) {
        double x = mesh->x[i / 3][i % 3];
        ground.calm[0][i / 3][i % 3] = x;
        ground.calm[1][i / 3][i % 3] = x + prng_between(&random, -1e-3, 1e-3);
        ground.far[0][i / 3][i % 3] = prng_between(&random, -FAR, FAR);
        ground.far[1][i / 3][i % 3] = prng_between(&random, -FAR, FAR);
    }
    eng_mesh_release(mesh);
    *state = &ground;
    return 0;
}

static int teardown(void **state)
{
    eng_scene_free(((struct ground *)*state)->scene);
    return 0;
}

static struct pccd_step_counters step(struct ground *ground, double x[2][VERTICES][3],
                                      const struct eng_question *settings)
{
    eng_stage_begin(ground->scene);
    assert_ok(eng_stage_x0x1(ground->scene, ground->object, PCCD_FORMAT_F64, 0, VERTICES,
                             x[0], x[1]));
    struct eng_step_result result = kit_step(ground->scene, settings);
    assert_int_equal(result.threads, settings->threads);
    assert_true(result.count <= KEPT);
    return result.counters;
}

static uint64_t candidates(const struct pccd_step_counters *counters)
{
    return counters->candidates[PCCD_VF] + counters->candidates[PCCD_EE];
}

/* If it failed, a mesh that goes astray would take a machine's memory. */
CASE_WITH(teleport__takes_no_more_memory_than_a_calm_step, setup, teardown)
{
    struct ground *ground = *state;
    for (uint32_t i = 0; i < WAY_METHODS * 2 * 2; i++) {
        struct eng_question settings =
            kit_contacts(PCCD_MODE_ALL, way_methods[i % WAY_METHODS]);
        settings.mode = i / WAY_METHODS % 2 ? PCCD_MODE_PAIRS : PCCD_MODE_ALL;
        settings.threads = i / WAY_METHODS / 2 ? 4 : 1;
        settings.team_always = true;
        settings.contact_max = KEPT;
        /* What is small beside a jump is compared in floats, which have room from then
         * on: as much as the features take, not the candidates. */
        step(ground, ground->calm, &settings);
        step(ground, ground->far, &settings);
        step(ground, ground->calm, &settings);
        struct pccd_step_counters calm = step(ground, ground->calm, &settings);
        uint64_t bytes = eng_alloc_bytes();
        for (uint32_t again = 0; again < 3; again++) {
            struct pccd_step_counters far = step(ground, ground->far, &settings);
            assert_true(candidates(&far) > MORE_CANDIDATES * candidates(&calm));
            assert_true(eng_alloc_bytes() <= bytes + MORE_BYTES_MAX * settings.threads);
            assert_true(far.allocs <= ALLOCS_MAX * settings.threads);
        }
    }
}

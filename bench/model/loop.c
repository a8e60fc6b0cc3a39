/* loop.c - what a turn of the paper's main loop costs.
 *
 * Run the paper's scheduler and the serial one, each by one thread, over a scene in which
 * nothing is near anything else: all units are one box test, and the difference is what
 * section 4.3 adds to each.
 */
#include <stdlib.h>
#include <string.h>

#include "clock.h"
#include "machine.h"
#include "memory.h"
#include "method.h"
#include "paper.h"
#include "paper_work.h"
#include "report.h"
#include "resident.h"
#include "schedule_paper.h"
#include "step_memory.h"
#include "taskunit.h"

#define TRIANGLES 8192u
#define REPEATS   31

/* Triangles in a row, each in a cell of its own. */
static void make_row(struct bench_scene *scene)
{
    memset(scene, 0, sizeof *scene);
    scene->name = "row";
    struct bench_object *object = bench_scene_add(scene, 3 * TRIANGLES, TRIANGLES);
    double(*x)[3] = bench_scene_store(scene, 2);
    for (uint32_t i = 0; i < 2 * scene->vertex_count; i++) {
        uint32_t v = i % scene->vertex_count;
        x[i][0] = 4.0 * (v / 3) + (v % 3 == 1);
        x[i][1] = v % 3 == 2;
        x[i][2] = 0;
        object->triangles[v / 3][v % 3] = v;
    }
}

/* One run of the serial loop, or of the paper's scheduler, by the calling thread. */
static double run(struct eng_scene *scene, bool by_paper)
{
    struct eng_step_settings settings = ENG_STEP_SETTINGS_DEFAULT;
    struct eng_stop stop;
    struct eng_step_memory *memory = eng_step_memory_of(scene);
    struct eng_team team = {.scene = scene,
                            .workers = memory->workers,
                            .count = 1,
                            .method = &eng_method_paper};
    settings.method = PCCD_METHOD_PAPER;
    eng_stop_init(&stop, &settings);
    eng_pool_reset(memory->pool, 1);
    if (eng_assignment_reserve(&eng_paper_of(scene)->assignment, 1) != PCCD_OK ||
        eng_paper_work_reserve(memory->workers[0], scene) != PCCD_OK) {
        exit(2);
    }
    eng_worker_begin(memory->workers[0], scene, &settings, &stop, memory->pool);
    eng_paper_work_begin(memory->workers[0]);
    memory->workers[0]->thread = 0;
    uint64_t begin_ns = common_now_ns();
    if (by_paper) {
        eng_schedule_paper_begin(&team, memory->workers[0]);
        eng_schedule_paper(&team, memory->workers[0]);
    } else {
        eng_taskunit_perform_all(memory->workers[0]);
    }
    return (double)(common_now_ns() - begin_ns);
}

double model_loop_ns(void)
{
    struct bench_scene source;
    struct bench_world world;
    struct bench_frames frames;
    struct eng_step_settings settings = bench_step_settings(PCCD_MODE_ALL);
    struct eng_step_result result;
    struct bench_samples more = {0};
    make_row(&source);
    bench_frames_init(&frames, &source, 0);
    bench_world_init(&world, &frames, NULL);
    bench_world_step(&world, &frames, &settings, &result);
    for (int i = 0; i < REPEATS; i++) {
        double serial_ns = run(world.scene, false);
        double paper_ns = run(world.scene, true);
        bench_add(&more, (paper_ns - serial_ns) / (2 * TRIANGLES - 1));
    }
    double ns = bench_summarise(&more).p50;
    bench_free(&more);
    bench_world_deinit(&world);
    bench_frames_deinit(&frames);
    bench_scene_free(&source);
    return ns > 0 ? ns : 0;
}

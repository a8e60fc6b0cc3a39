/* way_engine.c - the engine in this process.
 *
 * Threads: one; the engine uses as many as it is told. The team is placed as the daemon's
 * is.
 */
#include <assert.h>
#include <stdlib.h>
#include <unistd.h>

#include "kernel.h"
#include "mesh.h"
#include "names.h"
#include "parallel.h"
#include "play.h"
#include "question.h"
#include "report.h"
#include "resident.h"

struct run_asked {
    struct bench_world world;
    struct eng_question settings;
    enum pccd_method method;
};

static const struct eng_affinity *affinity(uint32_t threads)
{
    static struct eng_affinity ours;
    static uint32_t warm; /* threads of the team that there is */
    if (warm == 0) {
        eng_affinity_init(&ours);
    }
    if (warm < threads) {
        eng_affinity_warm_up(&ours, threads);
        warm = threads;
    }
    return &ours;
}

/* The daemon's defaults: those of the engine. */
static struct eng_question translate(const struct run_side *side,
                                     const struct bench_frames *frames)
{
    const struct pccd_step_settings *step = &side->step;
    struct eng_question settings = bench_step_settings((enum pccd_mode)step->mode);
    settings.method = (enum pccd_method)step->method;
    settings.threads = step->threads;
    settings.distance = run_separation(side, frames);
    settings.approach = step->approach;
    settings.affinity = affinity(step->threads);
    settings.team_always = side->is_team;
    settings.kernels = side->cpu ? eng_kernels_named(side->cpu) : eng_kernels();
    if (step->tuning != NULL) {
        char why[ENG_TUNING_WHY_BYTES];
        int status = eng_tuning_read(step->tuning, &settings.tuning, why);
        assert(status == PCCD_OK); /* by settings.c */
        (void)status;
    }
    return settings;
}

static struct run_asked *open_engine(const struct run_side *side,
                                     const struct bench_frames *frames)
{
    struct run_asked *asked = bench_alloc(1, sizeof *asked);
    struct eng_scene_settings scene = ENG_SCENE_SETTINGS_DEFAULT;
    if (side->rebuild_ratio != 0) {
        scene.rebuild_ratio = side->rebuild_ratio < 0 ? 0 : side->rebuild_ratio;
    }
    asked->settings = translate(side, frames);
    asked->method = PCCD_METHOD_DEFAULT;
    bench_world_init(&asked->world, frames, &scene);
    return asked;
}

static void close_engine(struct run_asked *asked)
{
    bench_world_deinit(&asked->world);
    free(asked);
}

static uint64_t scene_bytes(const struct bench_world *world)
{
    uint64_t bytes = eng_scene_bytes(world->scene);
    for (uint32_t i = 0; i < world->source->object_count; i++) {
        bytes += eng_mesh_bytes(eng_scene_mesh(world->scene, world->object_idx[i]));
    }
    return bytes;
}

/* Add up what the threads say that they did. */
static void keep_work(struct run_frame *frame, const struct eng_step_result *result)
{
    frame->counts[RUN_ELEMENTARY] = 0;
    for (uint32_t i = 0; i < result->threads; i++) {
        const struct eng_thread_record *one = &result->thread_records[i];
        frame->counts[RUN_ELEMENTARY] += one->tests;
        frame->ns[RUN_REFIT_WORK] += one->refit_ns;
        frame->ns[RUN_LOW_WORK] += one->low_ns;
        frame->ns[RUN_HIGH_WORK] += one->high_ns;
        frame->ns[RUN_MERGE_WORK] += one->merge_ns;
        frame->ns[RUN_WAIT] += one->wait_ns;
    }
}

static bool step_engine(struct run_asked *asked, const struct bench_frames *frames,
                        struct run_frame *frame)
{
    struct eng_step_result result;
    bench_world_follow(&asked->world, frames);
    uint64_t begin_ns = common_now_ns();
    bench_world_step(&asked->world, frames, &asked->settings, &result);
    frame->ns[RUN_WALL] = common_now_ns() - begin_ns;
    run_frame_keep(frame, &result.times, &result.counters);
    keep_work(frame, &result);
    frame->counts[RUN_CONTACTS] = result.count;
    frame->counts[RUN_SCENE_BYTES] = scene_bytes(&asked->world);
    frame->counts[RUN_PROCESS_BYTES] = run_resident_bytes((uint32_t)getpid());
    frame->threads = result.threads;
    frame->hash[0] = result.hash[0];
    frame->hash[1] = result.hash[1];
    asked->method = result.method;
    return result.incomplete == PCCD_COMPLETE;
}

static const char *method_of(const struct run_asked *asked)
{
    return asked->method == PCCD_METHOD_DEFAULT
               ? ""
               : common_method_name((enum pccd_method)asked->method);
}

static const char *cpu_of(const struct run_asked *asked)
{
    return asked->settings.kernels->name;
}

const struct run_way run_way_engine = {open_engine, step_engine, method_of, cpu_of,
                                       close_engine};

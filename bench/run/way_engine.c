/* bench/run/way_engine.c - the engine in this process.
 *
 * Room:     bench/run; engine headers.
 * Does:     see way.h.
 * Threads:  one; the engine uses as many as it is told. The team is placed as the
 *           daemon's is.
 */
#include <stdlib.h>
#include <unistd.h>

#include "kernel.h"
#include "mesh.h"
#include "place.h"
#include "report.h"
#include "resident.h"
#include "way.h"

struct run_asked {
    struct bench_world world;
    struct eng_step_settings settings;
    enum eng_method method;
};

static const struct eng_places *places(uint32_t threads)
{
    static struct eng_places ours;
    static bool are_known;
    if (!are_known) {
        eng_places_init(&ours);
        eng_places_warm_up(&ours, threads);
        are_known = true;
    }
    return &ours;
}

/* The daemon's defaults: those of the engine. */
static struct eng_step_settings translate(const struct pccd_step_settings *step)
{
    struct eng_step_settings settings = bench_step_settings((enum eng_mode)step->mode);
    settings.method = (enum eng_method)step->method;
    settings.threads = step->threads;
    settings.places = places(step->threads);
    if (step->scheduler == PCCD_SCHEDULER_PAPER) {
        settings.scheduler = ENG_SCHEDULER_PAPER;
    }
    if (step->high_level == PCCD_HIGH_LEVEL_DISJOINT) {
        settings.high_level = ENG_HIGH_DISJOINT;
    }
    if (step->refit == PCCD_REFIT_PAPER) {
        settings.refit = ENG_REFIT_PAPER;
    }
    return settings;
}

static struct run_asked *open_engine(const struct run_settings *settings,
                                     const struct bench_frames *frames)
{
    struct run_asked *asked = bench_alloc(1, sizeof *asked);
    asked->settings = translate(&settings->step);
    asked->method = ENG_METHOD_DEFAULT;
    bench_world_init(&asked->world, frames, NULL);
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

static uint64_t elementary_tests(const struct eng_step_result *result)
{
    uint64_t tests = 0;
    for (uint32_t i = 0; i < result->threads; i++) {
        tests += result->thread_records[i].tests;
    }
    return tests;
}

static bool step_engine(struct run_asked *asked, const struct bench_frames *frames,
                        struct run_frame *frame)
{
    struct eng_step_result result;
    bench_world_follow(&asked->world, frames);
    uint64_t begin_ns = bench_now_ns();
    bench_world_step(&asked->world, frames, &asked->settings, &result);
    frame->ns[RUN_WALL] = bench_now_ns() - begin_ns;
    RUN_KEEP_TIMES(frame, &result.times);
    RUN_KEEP_COUNTS(frame, &result.counters);
    frame->counts[RUN_ELEMENTARY] = elementary_tests(&result);
    frame->counts[RUN_CONTACTS] = result.count;
    frame->counts[RUN_SCENE_BYTES] = scene_bytes(&asked->world);
    frame->counts[RUN_PROCESS_BYTES] = run_resident_bytes((uint32_t)getpid());
    frame->threads = result.threads;
    frame->hash[0] = result.hash_hi;
    frame->hash[1] = result.hash_lo;
    asked->method = result.method;
    return result.incomplete == ENG_COMPLETE;
}

static const char *method_of(const struct run_asked *asked)
{
    return asked->method == ENG_METHOD_DEFAULT
               ? ""
               : run_method_name((enum pccd_method)asked->method);
}

static const char *cpu_of(const struct run_asked *asked)
{
    (void)asked;
    return eng_kernels()->name;
}

const struct run_way run_way_engine = {open_engine, step_engine, method_of, cpu_of,
                                       close_engine};

/* bench/step.c - what a resident scene, the modes and moving boxes save of a step.
 *
 * Room:     bench; engine headers.
 * Does:     in every frame do, one after the other, all that is compared, so that a busy
 *           machine hits both sides of a ratio; check that the answers agree. Of the
 *           method paper, whose tree is walked.
 * Does not: tell the phases of a step, or what it counts: bench/pccd-bench does.
 * Threads:  one; the engine uses as many as it says.
 */
#include "step.h"

#include <string.h>

#include "report.h"
#include "resident.h"
#include "traverse.h"

#define MODES      4
#define WORLDS     5 /* the modes, and mode all once more */
#define WARM_STEPS 2u
#define STEPS_MAX  300u
#define STEPS_MIN  5u
#define SCENE_NS   8000000000u /* about as long for each scene */

enum quantity {
    TRAVERSAL,
    STEP,
    AGAIN,
    REBUILD,
    FIRST,
    ANY,
    PAIRS,
    WALK_MOVING,
    WALK_SWEPT,
    LEAVES_MOVING,
    LEAVES_SWEPT,
    QUANTITIES
};

static const struct {
    const char *what;
    const char *unit;
    double scale; /* of the value that is kept */
    int base;     /* -1: no ratio */
} quantities[QUANTITIES] = {
    [TRAVERSAL] = {"traversal", "ms", 1e-6, WALK_MOVING},
    [STEP] = {"step, all", "ms", 1e-6, REBUILD},
    [AGAIN] = {"step, all, again", "ms", 1e-6, STEP},
    [REBUILD] = {"rebuild at every call", "ms", 1e-6, -1},
    [FIRST] = {"step, first", "ms", 1e-6, STEP},
    [ANY] = {"step, any", "ms", 1e-6, STEP},
    [PAIRS] = {"step, pairs", "ms", 1e-6, STEP},
    [WALK_MOVING] = {"walk, moving boxes", "ms", 1e-6, WALK_SWEPT},
    [WALK_SWEPT] = {"walk, swept boxes", "ms", 1e-6, -1},
    [LEAVES_MOVING] = {"leaf pairs, moving boxes", "pairs", 1, LEAVES_SWEPT},
    [LEAVES_SWEPT] = {"leaf pairs, swept boxes", "pairs", 1, -1},
};

struct run {
    const struct bench_scene *source;
    struct bench_frames frames;
    struct bench_world
        worlds[WORLDS]; /* resident, one a mode, so that none disturbs another */
    struct bench_swept_tree swept;
    struct bench_samples samples[QUANTITIES];
    bool keep; /* false while warming up */
    uint64_t hash[2];
    uint32_t threads;
};

static void keep(struct run *run, enum quantity quantity, double value)
{
    if (run->keep) {
        bench_add(&run->samples[quantity], value * quantities[quantity].scale);
    }
}

/* What a function that keeps nothing between calls would do: register, build, step, free.
 * The start positions are the registered ones, which saves it their second copy. */
static bool rebuild(struct run *run, const struct eng_step_result *all)
{
    struct eng_step_settings settings = bench_step_settings(ENG_MODE_ALL);
    struct bench_world world;
    struct eng_step_result result;
    uint64_t begin_ns = bench_now_ns();
    bench_world_init(&world, &run->frames, NULL);
    bench_world_step(&world, &run->frames, &settings, &result);
    bench_world_deinit(&world);
    keep(run, REBUILD, (double)(bench_now_ns() - begin_ns));
    return bench_check(result.count == all->count && result.hash_hi == all->hash_hi &&
                           result.hash_lo == all->hash_lo,
                       run->source->name, "a resident and a fresh scene differ");
}

static void step(struct run *run, int world, enum eng_mode mode,
                 struct eng_step_result *result)
{
    struct eng_step_settings settings = bench_step_settings(mode);
    bench_world_step(&run->worlds[world], &run->frames, &settings, result);
}

/* The other modes against the answer of mode all. */
static bool other_modes(struct run *run, const struct eng_step_result *all)
{
    const char *name = run->source->name;
    struct eng_step_result result;
    bool good = true;
    /* The same work as mode all: its ratio to it shows the noise of all the others. */
    step(run, MODES, ENG_MODE_ALL, &result);
    keep(run, AGAIN, (double)result.times.step);
    good &= bench_check(result.hash_hi == all->hash_hi && result.hash_lo == all->hash_lo,
                        name, "two resident scenes differ");
    step(run, ENG_MODE_FIRST, ENG_MODE_FIRST, &result);
    keep(run, FIRST, (double)result.times.step);
    good &= bench_check(!(result.toi_first < all->toi_first) &&
                            !(result.toi_first > all->toi_first),
                        name, "mode first finds another earliest time");
    step(run, ENG_MODE_ANY, ENG_MODE_ANY, &result);
    keep(run, ANY, (double)result.times.step);
    good &=
        bench_check((result.verdict == ENG_VERDICT_YES) == (all->count > all->possible),
                    name, "mode any has another verdict");
    step(run, ENG_MODE_PAIRS, ENG_MODE_PAIRS, &result);
    keep(run, PAIRS, (double)result.times.step);
    /* Boxes are rounded, so they let a few more through than no axis separates. */
    good &= bench_check(result.count >= all->count &&
                            result.count <=
                                all->counters.candidates_vf + all->counters.candidates_ee,
                        name, "mode pairs has fewer pairs than meet, or more than boxes");
    return good;
}

/* The tree of mode all as the step left it, walked with both kinds of boxes. */
static bool walks(struct run *run, const struct eng_step_result *all)
{
    const struct eng_scene *scene = run->worlds[ENG_MODE_ALL].scene;
    bench_swept_update(&run->swept, scene);
    uint64_t begin_ns = bench_now_ns();
    struct bench_count moving = bench_traverse_moving(scene);
    uint64_t between_ns = bench_now_ns();
    struct bench_count swept = bench_traverse_swept(scene, &run->swept);
    keep(run, WALK_SWEPT, (double)(bench_now_ns() - between_ns));
    keep(run, WALK_MOVING, (double)(between_ns - begin_ns));
    keep(run, LEAVES_MOVING, (double)moving.leaf_pairs);
    keep(run, LEAVES_SWEPT, (double)swept.leaf_pairs);
    return bench_check(moving.leaf_pairs == all->counters.leaf_pairs &&
                           moving.box_tests == all->counters.box_tests,
                       run->source->name,
                       "the walk counts other pairs than the engine") &&
           bench_check(swept.leaf_pairs >= moving.leaf_pairs, run->source->name,
                       "swept boxes overlap less than moving ones");
}

static bool one_frame(struct run *run)
{
    struct eng_step_result all;
    step(run, ENG_MODE_ALL, ENG_MODE_ALL, &all);
    keep(run, STEP, (double)all.times.step);
    keep(run, TRAVERSAL, (double)all.times.traversal);
    run->threads = all.threads;
    run->hash[0] = all.hash_hi;
    run->hash[1] = all.hash_lo;
    return bench_check(all.incomplete == ENG_COMPLETE, run->source->name, "incomplete") &&
           rebuild(run, &all) && other_modes(run, &all) && walks(run, &all);
}

static void print(const struct run *run)
{
    for (int q = 0; q < QUANTITIES; q++) {
        struct bench_row row = {.scene = run->source->name,
                                .what = quantities[q].what,
                                .unit = quantities[q].unit,
                                .samples = &run->samples[q],
                                .threads = run->threads,
                                .hash = run->hash};
        if (quantities[q].base >= 0) {
            row.base = &run->samples[quantities[q].base];
            row.base_name = quantities[quantities[q].base].what;
        }
        bench_row(&row);
    }
}

static void measure(const struct bench_scene *source, bool smoke)
{
    static struct run run; /* too large for a stack */
    uint64_t begin_ns = bench_now_ns();
    bool good = true;
    memset(&run, 0, sizeof run);
    run.source = source;
    bench_frames_init(&run.frames, source, source->hard_frame);
    for (int i = 0; i < WORLDS; i++) {
        bench_world_init(&run.worlds[i], &run.frames, NULL);
    }
    for (uint32_t i = 0; i < STEPS_MAX && good; i++) {
        bool is_time_up = smoke || bench_now_ns() - begin_ns > SCENE_NS;
        if (i >= WARM_STEPS + STEPS_MIN && is_time_up) {
            break;
        }
        run.keep = i >= WARM_STEPS;
        bench_frames_seek(&run.frames, bench_hard_step(source, i));
        good = one_frame(&run);
    }
    if (good) {
        print(&run);
    }
    for (int q = 0; q < QUANTITIES; q++) {
        bench_free(&run.samples[q]);
    }
    bench_frames_deinit(&run.frames);
    bench_swept_deinit(&run.swept);
    for (int i = 0; i < WORLDS; i++) {
        bench_world_deinit(&run.worlds[i]);
    }
}

int main(int argc, char **argv)
{
    struct bench_options options;
    int exit_status;
    if (!bench_begin("step", argc, argv, &options, &exit_status)) {
        return exit_status;
    }
    struct bench_scene scene;
    for (unsigned i = 0; bench_next_scene(&options, NULL, &i, &scene);) {
        bench_heading(scene.name);
        measure(&scene, options.smoke);
        bench_scene_free(&scene);
    }
    return bench_end();
}

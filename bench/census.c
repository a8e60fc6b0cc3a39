/* bench/census.c - what the steps of each scene hold, so that scenes can be compared.
 *
 * Room:     bench; engine headers.
 * Does:     step through frames of a scene; count its triangles, what the boxes let
 *           through and what there is to be found; check that frames are the same
 *           whenever they are made. No times: step.c has them.
 * Threads:  one.
 */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "report.h"
#include "resident.h"
#include "traverse.h"
#include "workload.h"

#define STEPS_MAX 40u /* of a scene, evenly taken from all */

enum quantity {
    BOX_TESTS,
    LEAVES,
    LEAVES_SWEPT,
    CANDIDATES,
    SURVIVORS,
    EXACT,
    CONTACTS,
    INITIAL,
    QUANTITIES
};

static const struct {
    const char *what;
    const char *unit;
} quantities[QUANTITIES] = {
    [BOX_TESTS] = {"box tests", "pairs"},
    [LEAVES] = {"leaf pairs, moving boxes", "pairs"},
    [LEAVES_SWEPT] = {"leaf pairs, swept boxes", "pairs"},
    [CANDIDATES] = {"candidates", "pairs"},
    [SURVIVORS] = {"survivors", "pairs"},
    [EXACT] = {"exact queries", "pairs"},
    [CONTACTS] = {"contacts", "records"},
    [INITIAL] = {"contacts from the start", "records"},
};

static void count_step(const struct bench_world *world, struct bench_swept_tree *swept,
                       const struct eng_step_result *result,
                       struct bench_samples *samples)
{
    const struct eng_step_counters *counters = &result->counters;
    bench_swept_update(swept, world->scene);
    bench_add(&samples[BOX_TESTS], (double)counters->box_tests);
    bench_add(&samples[LEAVES], (double)counters->leaf_pairs);
    bench_add(&samples[LEAVES_SWEPT],
              (double)bench_traverse_swept(world->scene, swept).leaf_pairs);
    bench_add(&samples[CANDIDATES],
              (double)(counters->candidates_vf + counters->candidates_ee));
    bench_add(&samples[SURVIVORS], (double)counters->survivors);
    bench_add(&samples[EXACT], (double)counters->exact);
    bench_add(&samples[CONTACTS], (double)result->count);
    bench_add(&samples[INITIAL], (double)result->initial);
}

/* A frame does not depend on how it was come by. */
static void check_frames(const struct bench_frames *frames, const char *name)
{
    struct bench_frames again;
    size_t bytes = frames->scene->vertex_count * sizeof *again.x[0];
    bench_frames_init(&again, frames->scene, frames->from);
    bench_check(memcmp(frames->x[0], again.x[0], bytes) == 0 &&
                    memcmp(frames->x[1], again.x[1], bytes) == 0,
                name, "a frame differs when it is made again");
    bench_frames_deinit(&again);
}

/* An early frame once more after the last one: those that are made one by one, such as a
 * simulation's, have to begin anew. */
#define EARLY 12u

static void check_early(struct bench_frames *frames, const double (*early)[3],
                        uint32_t from, const char *name)
{
    size_t bytes = frames->scene->vertex_count * sizeof *early;
    bench_frames_seek(frames, from);
    bench_check(memcmp(frames->x[0], early, bytes) == 0, name,
                "an early frame differs after the last one");
}

/* Frames `begin` to `end`, or every few of them. */
static void take(const struct bench_scene *scene, const char *name, uint32_t begin,
                 uint32_t end)
{
    struct eng_step_settings settings = bench_step_settings(ENG_MODE_ALL);
    struct bench_samples samples[QUANTITIES];
    struct bench_swept_tree swept = {NULL, 0};
    struct bench_frames frames;
    struct bench_world world;
    struct eng_step_result result;
    uint32_t early_from = end - begin > EARLY ? begin + EARLY : begin;
    double(*early)[3] = bench_alloc(scene->vertex_count, sizeof *early);
    uint32_t stride = (end - begin + STEPS_MAX - 1) / STEPS_MAX;
    memset(samples, 0, sizeof samples);
    bench_frames_init(&frames, scene, begin);
    bench_world_init(&world, &frames, NULL);
    for (uint32_t from = begin; from < end; from++) {
        bench_frames_seek(&frames, from);
        if (from == early_from) {
            memcpy(early, frames.x[0], scene->vertex_count * sizeof *early);
        }
        bench_world_step(&world, &frames, &settings, &result);
        bench_check(result.incomplete == ENG_COMPLETE, name, "incomplete");
        if ((from - begin) % stride == 0) {
            check_frames(&frames, name);
            count_step(&world, &swept, &result, samples);
        }
    }
    check_early(&frames, (const double(*)[3])early, early_from, name);
    free(early);
    for (int q = 0; q < QUANTITIES; q++) {
        bench_row(&(struct bench_row){.scene = name,
                                      .what = quantities[q].what,
                                      .unit = quantities[q].unit,
                                      .samples = &samples[q]});
        bench_free(&samples[q]);
    }
    bench_world_deinit(&world);
    bench_swept_deinit(&swept);
    bench_frames_deinit(&frames);
}

static void census(const struct bench_scene *scene)
{
    bench_heading(scene->name);
    bench_number(scene->name, "objects", "", scene->object_count);
    bench_number(scene->name, "vertices", "", scene->vertex_count);
    bench_number(scene->name, "triangles", "", (double)bench_scene_triangles(scene));
    bench_number(scene->name, "steps", "", scene->frame_count - 1);
    if (scene->break_frame > 0) {
        char part[64];
        snprintf(part, sizeof part, "%s, whole", scene->name);
        take(scene, part, 0, scene->break_frame);
        snprintf(part, sizeof part, "%s, in pieces", scene->name);
        take(scene, part, scene->break_frame, scene->frame_count - 1);
    } else {
        take(scene, scene->name, 0, scene->frame_count - 1);
    }
}

int main(int argc, char **argv)
{
    struct bench_options options;
    int exit_status;
    if (!bench_begin("census", argc, argv, &options, &exit_status)) {
        return exit_status;
    }
    struct bench_scene scene;
    for (unsigned i = 0; bench_next_scene(&options, NULL, &i, &scene);) {
        census(&scene);
        bench_scene_free(&scene);
    }
    return bench_end();
}

/* thickness.c - what thickness adds to a step.
 *
 * Take the same step of a scene without thickness and with a separation of some part of
 * the median edge, in turn; report both times, how many pairs were tested, how many of
 * them by themselves, and what one took.
 */
#include <math.h>
#include <stdlib.h>

#include "report.h"
#include "resident.h"
#include "workload.h"

#define REPEATS       9u
#define REPEATS_SMOKE 2u

static const struct part {
    const char *name;
    double of_edge;
    double approach;
} parts[] = {{"r = 0", 0, 0},
             {"r = 0.1 % of an edge", 1e-3, 0},
             {"r = 1 % of an edge", 1e-2, 0},
             {"r = 1 %, approach 0.1", 1e-2, 0.1},
             {"r = 10 % of an edge", 1e-1, 0}};
#define PARTS (sizeof parts / sizeof parts[0])

static const char *const names[] = {"cloth-20k", "cloth-ball", "cloth-funnel", "n-body",
                                    NULL};

static void report(const char *name, const struct bench_samples ms[PARTS],
                   const struct eng_step_result results[PARTS],
                   const struct bench_samples ns[PARTS])
{
    for (size_t i = 0; i < PARTS; i++) {
        bench_row(&(struct bench_row){.scene = name,
                                      .what = parts[i].name,
                                      .unit = "ms",
                                      .samples = &ms[i],
                                      .base_name = i > 0 ? parts[0].name : NULL,
                                      .base = i > 0 ? &ms[0] : NULL});
        if (i == 0) {
            continue;
        }
        bench_number(name, "contacts", "", (double)results[i].count);
        bench_number(name, "pairs tested", "", (double)results[i].thick.candidates);
        bench_number(name, "by themselves", "", (double)results[i].thick.survivors);
        bench_number(name, "by integers", "", (double)results[i].thick.exact);
        bench_row(&(struct bench_row){
            .scene = name, .what = "a pair", .unit = "ns", .samples = &ns[i]});
    }
}

static void measure(const struct bench_scene *scene, uint32_t repeats)
{
    struct bench_samples ms[PARTS] = {{0}};
    struct bench_samples ns[PARTS] = {{0}};
    struct eng_step_result results[PARTS];
    struct bench_world worlds[PARTS];
    struct bench_frames frames;
    bench_frames_init(&frames, scene, scene->hard_frame);
    double edge = bench_frames_median_edge(&frames);
    for (size_t i = 0; i < PARTS; i++) {
        bench_world_init(&worlds[i], &frames, NULL);
    }
    for (uint32_t round = 0; round <= repeats; round++) {
        for (size_t i = 0; i < PARTS; i++) {
            struct eng_question settings = bench_step_settings(PCCD_MODE_ALL);
            settings.method = PCCD_METHOD_DEFAULT;
            settings.distance = parts[i].of_edge * edge;
            settings.approach = parts[i].approach;
            bench_world_step(&worlds[i], &frames, &settings, &results[i]);
            bench_check(results[i].incomplete == PCCD_COMPLETE, scene->name, "complete");
            if (round > 0) {
                bench_add(&ms[i], 1e-6 * (double)results[i].times.step);
                bench_add(&ns[i], (double)results[i].times.tests /
                                      fmax(1, (double)results[i].thick.candidates));
            }
        }
    }
    report(scene->name, ms, results, ns);
    for (size_t i = 0; i < PARTS; i++) {
        bench_world_deinit(&worlds[i]);
        bench_free(&ms[i]);
        bench_free(&ns[i]);
    }
    bench_frames_deinit(&frames);
}

int main(int argc, char **argv)
{
    struct bench_options options;
    int status;
    if (!bench_begin("thickness", argc, argv, &options, &status)) {
        return status;
    }
    struct bench_scene scene;
    bench_heading("thickness");
    for (unsigned i = 0; bench_next_scene(&options, names, &i, &scene);) {
        measure(&scene, options.smoke ? REPEATS_SMOKE : REPEATS);
        bench_scene_free(&scene);
    }
    return bench_end();
}

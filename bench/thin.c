/* bench/thin.c - steps of points and rods.
 *
 * Room:     bench (engine: step.h, scene.h).
 * Does:     take the same step of a cloud above a sheet, with and without pairs within the
 *           cloud, and of hair, by one thread; report times, pairs and contacts.
 * Does not: judge the answers (tests/unit does).
 * Threads:  one.
 * Source:   thin [NAME], a part of a row's name.
 */
#include <math.h>
#include <stdlib.h>

#include "families.h"
#include "report.h"
#include "resident.h"
#include "workload.h"

#define REPEATS       5u
#define REPEATS_SMOKE 2u

static const struct thin {
    const char *name;
    void (*make)(struct bench_scene *scene, bool small);
    double r;     /* at which a pair meets */
    bool is_self; /* the first object may meet itself */
    uint32_t rings;
    enum pccd_method method;
} rows[] = {
    {"points", bench_make_points, BENCH_POINTS_R, false, 0, PCCD_METHOD_WIDE},
    {"points, paper", bench_make_points, BENCH_POINTS_R, false, 0, PCCD_METHOD_PAPER},
    {"points and themselves", bench_make_points, BENCH_POINTS_R, true, 0,
     PCCD_METHOD_WIDE},
    {"hair", bench_make_hair, BENCH_HAIR_R, true, 3, PCCD_METHOD_WIDE},
    {"hair, paper", bench_make_hair, BENCH_HAIR_R, true, 3, PCCD_METHOD_PAPER},
};
#define ROWS (sizeof rows / sizeof rows[0])

static void set_objects(const struct thin *row, const struct bench_world *world,
                        const struct bench_scene *scene)
{
    const struct eng_object_thickness thickness = {
        .has_radius = true, .radius = row->r / 2, .rest_rings = row->rings};
    const struct eng_object_filter filter = {
        .group = 1, .mask = UINT64_MAX, .self = row->is_self};
    for (uint32_t i = 0; i < scene->object_count; i++) {
        bench_check(eng_scene_set_thickness(world->scene, world->object_idx[i],
                                            &thickness) == PCCD_OK,
                    row->name, "thickness");
        bench_check(eng_scene_set_filter(world->scene, world->object_idx[i], &filter) ==
                        PCCD_OK,
                    row->name, "filter");
    }
}

static void measure(const struct thin *row, bool is_smoke)
{
    static const char *const kinds[PCCD_KIND_COUNT] = {"VF", "EE", "VE", "VV"};
    struct bench_scene scene = {.name = row->name};
    struct bench_samples ms = {0};
    struct eng_step_result result = {0};
    struct bench_world world;
    struct bench_frames frames;
    row->make(&scene, is_smoke);
    bench_frames_init(&frames, &scene, 0);
    bench_world_init(&world, &frames, NULL);
    set_objects(row, &world, &scene);
    for (uint32_t round = 0; round <= (is_smoke ? REPEATS_SMOKE : REPEATS); round++) {
        struct eng_step_settings settings = bench_step_settings(PCCD_MODE_ALL);
        settings.method = row->method;
        bench_world_step(&world, &frames, &settings, &result);
        bench_check(result.incomplete == PCCD_COMPLETE, row->name, "complete");
        if (round > 0) {
            bench_add(&ms, 1e-6 * (double)result.times.step);
        }
    }
    bench_row(&(struct bench_row){
        .scene = row->name, .what = "step", .unit = "ms", .samples = &ms});
    bench_number(row->name, "refit", "ms", 1e-6 * (double)result.times.refit);
    bench_number(row->name, "traversal", "ms", 1e-6 * (double)result.times.traversal);
    bench_number(row->name, "tests", "ms", 1e-6 * (double)result.times.tests);
    bench_number(row->name, "merge", "ms", 1e-6 * (double)result.times.merge);
    for (uint32_t kind = 0; kind < PCCD_KIND_COUNT; kind++) {
        bench_number(row->name, kinds[kind], "candidates",
                     (double)result.counters.candidates[kind]);
        bench_number(row->name, kinds[kind], "contacts", (double)result.counts[kind]);
    }
    bench_number(row->name, "pairs at a distance", "", (double)result.thick.candidates);
    bench_number(row->name, "by themselves", "", (double)result.thick.survivors);
    bench_number(row->name, "by integers", "", (double)result.thick.exact);
    bench_world_deinit(&world);
    bench_frames_deinit(&frames);
    bench_scene_free(&scene);
    bench_free(&ms);
}

int main(int argc, char **argv)
{
    struct bench_options options;
    int status;
    if (!bench_begin("thin", argc, argv, &options, &status)) {
        return status;
    }
    bench_heading("thin");
    for (size_t i = 0; i < ROWS; i++) {
        if (bench_is_wanted(&options, rows[i].name)) {
            measure(&rows[i], options.smoke);
        }
    }
    return bench_end();
}

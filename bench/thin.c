/* thin.c - steps of points and rods.
 *
 * Take the same step of a cloud above a sheet, with and without pairs within the cloud,
 * and of hair, by one thread, in turn with a step of cloth-ball; report times, pairs and
 * contacts.
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

/* The step that others are compared with. */
struct beside {
    bool is_there;
    struct bench_scene scene;
    struct bench_frames frames;
    struct bench_world world;
};

static void beside_init(struct beside *beside, const struct bench_options *options)
{
    static const char *const names[] = {"cloth-ball", NULL};
    const struct bench_options all = {.smoke = options->smoke};
    unsigned i = 0;
    beside->is_there = bench_next_scene(&all, names, &i, &beside->scene);
    if (beside->is_there) {
        bench_frames_init(&beside->frames, &beside->scene, beside->scene.hard_frame);
        bench_world_init(&beside->world, &beside->frames, NULL);
    }
}

static void beside_deinit(struct beside *beside)
{
    if (beside->is_there) {
        bench_world_deinit(&beside->world);
        bench_frames_deinit(&beside->frames);
        bench_scene_free(&beside->scene);
    }
}

static double beside_step(struct beside *beside)
{
    struct eng_question settings = bench_step_settings(PCCD_MODE_ALL);
    struct eng_step_result result = {0};
    settings.method = PCCD_METHOD_DEFAULT;
    bench_world_step(&beside->world, &beside->frames, &settings, &result);
    return 1e-6 * (double)result.times.step;
}

static void tell(const struct thin *row, const struct eng_step_result *result)
{
    static const char *const kinds[PCCD_KIND_COUNT] = {"VF", "EE", "VE", "VV"};
    bench_number(row->name, "refit", "ms", 1e-6 * (double)result->times.refit);
    bench_number(row->name, "traversal", "ms", 1e-6 * (double)result->times.traversal);
    bench_number(row->name, "tests", "ms", 1e-6 * (double)result->times.tests);
    bench_number(row->name, "merge", "ms", 1e-6 * (double)result->times.merge);
    for (uint32_t kind = 0; kind < PCCD_KIND_COUNT; kind++) {
        bench_number(row->name, kinds[kind], "candidates",
                     (double)result->counters.candidates[kind]);
        bench_number(row->name, kinds[kind], "contacts", (double)result->counts[kind]);
    }
    bench_number(row->name, "pairs at a distance", "", (double)result->thick.candidates);
    bench_number(row->name, "by themselves", "", (double)result->thick.survivors);
    bench_number(row->name, "by integers", "", (double)result->thick.exact);
}

static void measure(const struct thin *row, struct beside *beside, bool is_smoke)
{
    struct bench_scene scene = {.name = row->name};
    struct bench_samples ms = {0};
    struct bench_samples base = {0};
    struct eng_step_result result = {0};
    struct bench_world world;
    struct bench_frames frames;
    row->make(&scene, is_smoke);
    bench_frames_init(&frames, &scene, 0);
    bench_world_init(&world, &frames, NULL);
    set_objects(row, &world, &scene);
    for (uint32_t round = 0; round <= (is_smoke ? REPEATS_SMOKE : REPEATS); round++) {
        struct eng_question settings = bench_step_settings(PCCD_MODE_ALL);
        settings.method = row->method;
        bench_world_step(&world, &frames, &settings, &result);
        bench_check(result.incomplete == PCCD_COMPLETE, row->name, "complete");
        if (round > 0) {
            bench_add(&ms, 1e-6 * (double)result.times.step);
        }
        if (beside->is_there) {
            double step_ms = beside_step(beside);
            if (round > 0) {
                bench_add(&base, step_ms);
            }
        }
    }
    bench_row(&(struct bench_row){.scene = row->name,
                                  .what = "step",
                                  .unit = "ms",
                                  .samples = &ms,
                                  .base_name = beside->is_there ? "cloth-ball" : NULL,
                                  .base = beside->is_there ? &base : NULL});
    tell(row, &result);
    bench_world_deinit(&world);
    bench_frames_deinit(&frames);
    bench_scene_free(&scene);
    bench_free(&ms);
    bench_free(&base);
}

int main(int argc, char **argv)
{
    struct bench_options options;
    int status;
    if (!bench_begin("thin", argc, argv, &options, &status)) {
        return status;
    }
    struct beside beside;
    beside_init(&beside, &options);
    bench_heading("thin");
    for (size_t i = 0; i < ROWS; i++) {
        if (bench_is_wanted(&options, rows[i].name)) {
            measure(&rows[i], &beside, options.smoke);
        }
    }
    beside_deinit(&beside);
    return bench_end();
}

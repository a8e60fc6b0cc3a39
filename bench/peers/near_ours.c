/* near_ours.c - what the engine says is near. */
#include "near_ours.h"

#include <stdlib.h>
#include <string.h>

#include "steps.h"

_Static_assert(NEAR_VF == (int)PCCD_VF && NEAR_EE == (int)PCCD_EE &&
                   NEAR_VE == (int)PCCD_VE && NEAR_VV == (int)PCCD_VV,
               "kinds");

void near_keep(struct near_quantity *quantity, uint64_t begin_ns, bool counts)
{
    uint64_t ns = common_now_ns() - begin_ns;
    quantity->spent_ns += ns;
    if (counts) {
        bench_add(&quantity->ms, 1e-6 * (double)ns);
    }
}

void near_scene_init(struct near_scene *scene, const struct bench_scene *source)
{
    struct eng_question settings = bench_step_settings(PCCD_MODE_ALL);
    struct eng_step_result result;
    bench_frames_init(&scene->frames, source, source->hard_frame);
    bench_world_init(&scene->world, &scene->frames, NULL);
    bench_world_step(&scene->world, &scene->frames, &settings, &result);
    peers_swept_init(&scene->features, &scene->world);
    const struct peer_features *groups = scene->features.groups;
    scene->input =
        (struct near_input){.vertex_count = groups[PEER_VERTICES].count,
                            .edge_count = groups[PEER_EDGES].count,
                            .face_count = groups[PEER_FACES].count,
                            .x = (const double(*)[3])scene->frames.x[0],
                            .edges = (const uint32_t(*)[3])groups[PEER_EDGES].corners,
                            .faces = (const uint32_t(*)[3])groups[PEER_FACES].corners};
}

void near_scene_deinit(struct near_scene *scene)
{
    peers_swept_deinit(&scene->features);
    bench_world_deinit(&scene->world);
    bench_frames_deinit(&scene->frames);
}

struct eng_question near_ours_settings(enum pccd_near_what what, double d,
                                       uint32_t threads)
{
    struct eng_question settings = bench_step_settings(PCCD_MODE_ALL);
    settings.verb = what;
    settings.distance = d;
    settings.end = 1;
    settings.method = PCCD_METHOD_WIDE;
    settings.threads = threads;
    return settings;
}

/* Points of each side, by enum near_kind. */
static const uint32_t points_a[] = {1, 2, 1, 1};
static const uint32_t points_b[] = {3, 2, 2, 1};

static struct near_name name_of(const struct bench_world *world,
                                const struct pccd_near *record)
{
    return (struct near_name){
        record->kind,
        peers_index(world, points_a[record->kind], record->object_a, record->feature_a),
        peers_index(world, points_b[record->kind], record->object_b, record->feature_b)};
}

static void keep_pairs(struct near_ours *ours, const struct bench_world *world,
                       const struct eng_step_result *result)
{
    const struct pccd_near *records = result->records;
    ours->answers.pair_count = result->count;
    ours->answers.pairs = bench_alloc(result->count, sizeof *ours->answers.pairs);
    ours->brackets = bench_alloc(result->count, sizeof *ours->brackets);
    for (uint64_t i = 0; i < result->count; i++) {
        struct near_pair *pair = &ours->answers.pairs[i];
        pair->name = name_of(world, &records[i]);
        /* Records of pairs have the kind alone; records of features say which. */
        pair->closest = (struct near_name){.kind = PCCD_NEAR_TYPE(records[i].flags)};
        ours->brackets[i] = (struct near_bracket){records[i].d_lo, records[i].d_hi};
    }
}

static void keep_features(struct near_ours *ours, const struct bench_world *world,
                          const struct eng_step_result *result)
{
    const struct pccd_near *records = result->records;
    ours->answers.feature_count = result->count;
    ours->answers.features = bench_alloc(result->count, sizeof *ours->answers.features);
    for (uint64_t i = 0; i < result->count; i++) {
        ours->answers.features[i] =
            (struct near_feature){name_of(world, &records[i]), records[i].count};
    }
}

void near_ours_ask(struct near_ours *ours, struct bench_world *world,
                   const struct bench_frames *frames, double d)
{
    struct eng_step_result result;
    struct eng_question settings = near_ours_settings(PCCD_NEAR_PAIRS, d, 1);
    bench_world_near(world, frames, true, &settings, &result);
    keep_pairs(ours, world, &result);
    settings.verb = PCCD_NEAR_FEATURES;
    bench_world_near(world, frames, false, &settings, &result);
    keep_features(ours, world, &result);
    settings.verb = PCCD_NEAR_VERTICES;
    bench_world_near(world, frames, false, &settings, &result);
    ours->answers.bounds = bench_alloc(result.count, sizeof(double));
    memcpy(ours->answers.bounds, result.records, result.count * sizeof(double));
}

void near_ours_free(struct near_ours *ours)
{
    free(ours->answers.pairs);
    free(ours->answers.features);
    free(ours->answers.bounds);
    free(ours->brackets);
}

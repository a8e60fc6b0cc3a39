/* gather.c - what the kernels are measured on: the work of a real step. */
#include "gather.h"

#include <stdlib.h>
#include <string.h>

#include "report.h"
#include "trees.h"

static const struct eng_object *object_of_id(const struct bench_world *world, uint32_t id)
{
    return eng_scene_object(world->scene, world->object_idx[BENCH_OBJECT_OF(id)]);
}

/* Every `stride`-th pair of one kind, so that all parts of the scene have their share. */
static void take(struct bench_candidates *candidates, const struct bench_world *world,
                 const struct eng_step_result *pairs, uint32_t query_max)
{
    bool is_vf = candidates->kind == PCCD_VF;
    const struct pccd_pair *pair = pairs->records;
    uint64_t total = is_vf ? pairs->counts[PCCD_VF] : pairs->counts[PCCD_EE];
    uint64_t stride = total / query_max + 1;
    if (total > 0 && !is_vf) {
        pair += pairs->counts[PCCD_VF]; /* sorted by kind */
    }
    candidates->a = bench_alloc(query_max, sizeof *candidates->a);
    candidates->b = bench_alloc(query_max, sizeof *candidates->b);
    for (uint64_t i = 0; i < total && candidates->count < query_max; i += stride) {
        const struct eng_object *a = object_of_id(world, pair[i].object_a);
        const struct eng_object *b = object_of_id(world, pair[i].object_b);
        uint32_t n = candidates->count++;
        candidates->a[n] =
            pair[i].feature_a +
            (is_vf ? a->vertices.first : eng_paper_object_of(a)->edges.first);
        candidates->b[n] =
            pair[i].feature_b + (is_vf ? eng_paper_object_of(b)->triangles.first
                                       : eng_paper_object_of(b)->edges.first);
    }
}

static uint64_t gcd(uint64_t a, uint64_t b)
{
    while (b != 0) {
        uint64_t rest = a % b;
        a = b;
        b = rest;
    }
    return a;
}

/* The records as the worker found them: its blocks are given back after a step, so they
 * are found again in an order that is not sorted. */
static void copy_found(struct bench_work *work, const struct eng_step_result *pairs)
{
    const struct pccd_pair *sorted = pairs->records;
    eng_pool_init(&work->pool);
    eng_found_begin(&work->found, &work->pool, sizeof *sorted, pairs->count);
    /* A stride that has no common factor with the count visits every record once; in the
     * golden ratio no two that are close in order are close in the list. */
    uint64_t stride = (uint64_t)((double)pairs->count * 0.6180339887) + 1;
    while (stride > 1 && gcd(stride, pairs->count) != 1) {
        stride++;
    }
    for (uint64_t i = 0, at = 0; i < pairs->count; i++) {
        if (!eng_found_add(&work->found, &sorted[at])) {
            break;
        }
        at = (at + stride) % pairs->count;
    }
}

void bench_work_init(struct bench_work *work, const struct bench_scene *source,
                     uint32_t query_max)
{
    struct eng_question settings = bench_step_settings(PCCD_MODE_PAIRS);
    struct eng_step_result pairs;
    struct bench_frames frames;
    memset(work, 0, sizeof *work);
    work->vf.kind = PCCD_VF;
    work->ee.kind = PCCD_EE;
    bench_frames_init(&frames, source, source->hard_frame);
    bench_world_init(&work->world, &frames, NULL);
    bench_world_step(&work->world, &frames, &settings, &pairs);
    bench_frames_deinit(&frames);
    take(&work->vf, &work->world, &pairs, query_max);
    take(&work->ee, &work->world, &pairs, query_max);
    copy_found(work, &pairs);
}

void bench_work_deinit(struct bench_work *work)
{
    free(work->vf.a);
    free(work->vf.b);
    free(work->ee.a);
    free(work->ee.b);
    eng_pool_deinit(&work->pool);
    bench_world_deinit(&work->world);
}

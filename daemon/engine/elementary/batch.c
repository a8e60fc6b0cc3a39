/* batch.c - elementary tests of many pairs at once. */
#include "batch.h"

#include <assert.h>
#include <string.h>

#include "solvers.h"

static void load(enum pccd_kind kind, const struct eng_point *points,
                 const uint32_t quad[4], struct eng_query *query)
{
    query->kind = kind;
    for (int i = 0; i < 4; i++) {
        memcpy(query->x[0][i], points[quad[i]].x0, sizeof query->x[0][i]);
        memcpy(query->x[1][i], points[quad[i]].x1, sizeof query->x[1][i]);
    }
}

/* The pairs that no filter of the kernels rejects, to batch->left. */
static uint32_t filter(const struct eng_kernels *kernels, enum pccd_kind kind,
                       const struct eng_point *points, const uint32_t (*quads)[4],
                       uint32_t count, struct eng_batch *batch)
{
    uint32_t *left = batch->left;
    if (batch->from == ENG_FROM_AXES) {
        count = kernels->reject_axes(kind, points, quads, count, left);
    } else {
        for (uint32_t i = 0; i < count; i++) {
            left[i] = i;
        }
    }
    return batch->from == ENG_FROM_BRACKET || !eng_solvers[kind].has_kernels
               ? count
               : kernels->filter(kind, points, quads, left, count, left);
}

/* Decide pairs batch->left, but for those that it is not sure of. */
static void bracket(const struct eng_kernels *kernels, enum pccd_kind kind,
                    const struct eng_point *points, const uint32_t (*quads)[4],
                    double tolerance, double t_end, struct eng_batch *batch,
                    struct eng_bracketed *out)
{
    if (eng_solvers[kind].has_kernels) {
        kernels->bracket(kind, points, quads, batch->left, batch->survivors, tolerance,
                         t_end, out);
        return;
    }
    memcpy(batch->unsure, batch->left, batch->survivors * sizeof *batch->left);
    out->unsure_count = batch->survivors;
}

/* The pairs that the bracket kernel is not sure of, one by one, until it is to stop. A
 * pair whose decision was given up is left out, as are those after it. */
static void search(enum pccd_kind kind, const struct eng_point *points,
                   const uint32_t (*quads)[4], double tolerance, double t_end,
                   struct eng_exact *exact, struct eng_batch *batch,
                   struct eng_bracketed *out)
{
    struct eng_exact_watch *watch = &exact->span.watch;
    watch->should_stop = batch->should_stop;
    watch->owner = batch->owner;
    for (uint32_t i = 0; i < out->unsure_count; i++) {
        struct eng_query query;
        uint64_t exact_queries = exact->queries;
        load(kind, points, quads[batch->unsure[i]], &query);
        bool hits = eng_solvers[kind].search(&query, tolerance, t_end, exact,
                                             &batch->hits[out->hit_count]);
        if (watch->has_stopped) {
            break;
        }
        if (hits) {
            batch->index[out->hit_count++] = batch->unsure[i];
        }
        if (exact->queries != exact_queries && batch->should_stop &&
            batch->should_stop(batch->owner)) {
            break;
        }
    }
    *watch = (struct eng_exact_watch){0};
}

uint32_t eng_batch_test(const struct eng_kernels *kernels, enum pccd_kind kind,
                        const struct eng_point *points, const uint32_t (*quads)[4],
                        uint32_t count, double tolerance, double t_end,
                        struct eng_exact *exact, struct eng_batch *batch)
{
    assert(count <= ENG_CHUNK_MAX && tolerance > 0);
    struct eng_bracketed out = {
        .index = batch->index, .hits = batch->hits, .unsure = batch->unsure};
    batch->survivors = filter(kernels, kind, points, quads, count, batch);
    bracket(kernels, kind, points, quads, tolerance, t_end, batch, &out);
    batch->unsure_count = out.unsure_count;
    if (exact) {
        search(kind, points, quads, tolerance, t_end, exact, batch, &out);
    }
    return out.hit_count;
}

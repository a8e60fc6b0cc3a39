/* daemon/engine/elementary/batch.c - elementary tests of many pairs at once.
 *
 * Room:     engine.
 * Does:     see batch.h.
 * Threads:  one thread for one scratch.
 */
#include "batch.h"

#include <string.h>

static void load(enum eng_kind kind, const struct eng_point *points,
                 const uint32_t quad[4], struct eng_query *query)
{
    query->kind = kind;
    for (int i = 0; i < 4; i++) {
        memcpy(query->x[0][i], points[quad[i]].x0, sizeof query->x[0][i]);
        memcpy(query->x[1][i], points[quad[i]].x1, sizeof query->x[1][i]);
    }
}

/* The pairs that no filter rejects, to batch->left. */
static uint32_t filter(const struct eng_kernels *kernels, enum eng_kind kind,
                       const struct eng_point *points, const uint32_t (*quads)[4],
                       uint32_t count, struct eng_batch *batch)
{
    uint32_t *left = batch->left;
    if (batch->from == ENG_FROM_AXES) {
        count = kernels->apart(kind, points, quads, count, left);
    } else {
        for (uint32_t i = 0; i < count; i++) {
            left[i] = i;
        }
    }
    return batch->from == ENG_FROM_BRACKET
               ? count
               : kernels->filter(kind, points, quads, left, count, left);
}

uint32_t eng_batch_test(const struct eng_kernels *kernels, enum eng_kind kind,
                        const struct eng_point *points, const uint32_t (*quads)[4],
                        uint32_t count, double tolerance, double t_end,
                        struct eng_exact *exact, struct eng_batch *batch)
{
    struct eng_bracketed out = {
        .index = batch->index, .hits = batch->hits, .unsure = batch->unsure};
    batch->survivors = filter(kernels, kind, points, quads, count, batch);
    kernels->bracket(kind, points, quads, batch->left, batch->survivors, tolerance, t_end,
                     &out);
    batch->unsure_count = out.unsure_count;
    for (uint32_t i = 0; exact && i < out.unsure_count; i++) {
        struct eng_query query;
        uint64_t exact_queries = exact->queries;
        load(kind, points, quads[batch->unsure[i]], &query);
        if (eng_search(&query, tolerance, t_end, exact, &batch->hits[out.hit_count])) {
            batch->index[out.hit_count++] = batch->unsure[i];
        }
        if (exact->queries != exact_queries && batch->should_stop &&
            batch->should_stop(batch->owner)) {
            break;
        }
    }
    return out.hit_count;
}

/* daemon/engine/elementary/batch.c - elementary tests of many pairs at once.
 *
 * Room:     engine.
 * Does:     see batch.h.
 * Threads:  one thread for one scratch.
 */
#include "batch.h"

#include <string.h>

#include "filter.h"

static void load(enum eng_kind kind, const struct eng_point *points,
                 const uint32_t quad[4], struct eng_query *query)
{
    query->kind = kind;
    for (int i = 0; i < 4; i++) {
        memcpy(query->x[0][i], points[quad[i]].x0, sizeof query->x[0][i]);
        memcpy(query->x[1][i], points[quad[i]].x1, sizeof query->x[1][i]);
    }
}

uint32_t eng_batch_test(const struct eng_kernels *kernels, enum eng_kind kind,
                        const struct eng_point *points, const uint32_t (*quads)[4],
                        uint32_t count, double tolerance, double t_end,
                        struct eng_exact *exact, struct eng_batch *batch)
{
    uint32_t hit_count = 0;
    (void)kernels;
    batch->survivors = 0;
    for (uint32_t first = 0; first < count; first += ENG_LANES) {
        struct eng_query queries[ENG_LANES];
        struct eng_lanes lanes;
        uint32_t n = count - first < ENG_LANES ? count - first : ENG_LANES;
        for (uint32_t lane = 0; lane < ENG_LANES; lane++) {
            uint32_t i = lane < n ? lane : 0;
            load(kind, points, quads[first + i], &queries[lane]);
            eng_lanes_set(&lanes, lane, &queries[lane]);
        }
        uint32_t survivors = eng_filter(kind, &lanes);
        for (uint32_t lane = 0; lane < n; lane++) {
            if (!(survivors >> lane & 1u)) {
                continue;
            }
            uint64_t exact_queries = exact->queries;
            batch->survivors++;
            if (eng_solve(&queries[lane], tolerance, t_end, exact,
                          &batch->hits[hit_count])) {
                batch->index[hit_count++] = first + lane;
            }
            if (exact->queries != exact_queries && batch->should_stop &&
                batch->should_stop(batch->owner)) {
                return hit_count;
            }
        }
    }
    return hit_count;
}

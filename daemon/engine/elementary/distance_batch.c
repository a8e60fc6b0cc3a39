/* daemon/engine/elementary/distance_batch.c - distances of many pairs.
 *
 * Room:     engine.
 * Does:     see distance_batch.h.
 * Threads:  one thread for one scratch.
 */
#include "distance_batch.h"

#include <assert.h>
#include <string.h>

/* Pairs between two looks at the clock: some 50 us. */
#define PAIRS_PER_LOOK 256u

static void load(const struct eng_point *points, const uint32_t quad[4], uint32_t end,
                 double x[4][3])
{
    for (int i = 0; i < 4; i++) {
        const struct eng_point *point = &points[quad[i]];
        memcpy(x[i], end == 0 ? point->x0 : point->x1, sizeof x[i]);
    }
}

/* A point that a face or an edge names twice comes after itself. */
static void rank(const struct eng_point *points, const uint32_t quad[4], uint8_t rank[4])
{
    for (int i = 0; i < 4; i++) {
        rank[i] = 0;
        for (int k = 0; k < 4; k++) {
            uint64_t mine = points[quad[i]].word1;
            uint64_t other = points[quad[k]].word1;
            rank[i] = (uint8_t)(rank[i] + (other < mine || (other == mine && k < i)));
        }
    }
}

static bool looks(const struct eng_distance_batch *batch, uint32_t pair, bool was_exact)
{
    return batch->should_stop && (was_exact || pair % PAIRS_PER_LOOK == 0) &&
           batch->should_stop(batch->owner);
}

uint32_t eng_distance_batch_test(const struct eng_kernels *kernels,
                                 const struct eng_distance_question *question,
                                 const struct eng_point *points,
                                 const uint32_t (*quads)[4], uint32_t count,
                                 struct eng_distances *distances,
                                 struct eng_distance_batch *batch)
{
    assert(count <= ENG_CHUNK_MAX && question->end <= 1);
    (void)kernels;
    uint32_t found = 0;
    for (uint32_t i = 0; i < count; i++) {
        uint64_t before = distances->decided[ENG_DISTANCE_BY_INTEGERS];
        double x[4][3];
        load(points, quads[i], question->end, x);
        if (eng_distance_within(distances, question->kind, (const double(*)[3])x,
                                question->distance)) {
            if (question->wanted != ENG_DISTANCE_WITHIN) {
                uint8_t ranks[4];
                rank(points, quads[i], ranks);
                eng_distance_find(distances, question->kind, (const double(*)[3])x, ranks,
                                  &batch->found[found]);
            }
            batch->index[found++] = i;
        }
        bool was_exact = distances->decided[ENG_DISTANCE_BY_INTEGERS] != before;
        batch->exact += was_exact;
        if (looks(batch, i, was_exact)) {
            break;
        }
    }
    return found;
}

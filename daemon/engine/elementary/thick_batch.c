/* thick_batch.c - many pairs of thick features at once. */
#include "thick_batch.h"

#include <assert.h>
#include <string.h>

#include "kinds.h"

static void load(const struct eng_thick_question *question,
                 const struct eng_point *points, const uint32_t quad[4],
                 const double radius[3], struct eng_thick_query *query)
{
    query->query.kind = (enum pccd_kind)question->kind;
    query->approach = question->approach;
    memcpy(query->radius, radius, sizeof query->radius);
    for (int i = 0; i < 4; i++) {
        memcpy(query->query.x[0][i], points[quad[i]].x0, sizeof query->query.x[0][i]);
        memcpy(query->query.x[1][i], points[quad[i]].x1, sizeof query->query.x[1][i]);
    }
}

/* Writes down the pairs that are left, and returns how many. */
static uint32_t keep(const struct eng_kernels *kernels,
                     const struct eng_thick_question *question,
                     const struct eng_point *points, const uint32_t (*quads)[4],
                     const double (*radius)[3], uint32_t count,
                     struct eng_thick_batch *batch)
{
    if (question->is_sifted) {
        for (uint32_t i = 0; i < count; i++) {
            batch->left[i] = i;
        }
        return count;
    }
    for (uint32_t i = 0; i < count; i++) {
        batch->reach[i] = eng_thick_reach(radius[i]);
    }
    return kernels->reject_thick(common_kinds[question->kind].points[0], points, quads,
                                 count, batch->reach, batch->left);
}

/* How each pair left has advanced. */
static void advance(const struct eng_kernels *kernels,
                    const struct eng_thick_question *question,
                    const struct eng_point *points, const uint32_t (*quads)[4],
                    const double (*radius)[3], uint32_t count,
                    struct eng_thick_batch *batch)
{
    const struct eng_advance_limits limits = {question->approach, question->t_end,
                                              eng_thick_depth(question->tolerance)};
    for (uint32_t i = 0; i < count; i++) {
        batch->advance[i] =
            (struct eng_advance){.lo = eng_thick_sum(radius[batch->left[i]])};
    }
    kernels->advance(question->kind, points, quads, batch->left, count, &limits,
                     batch->advance);
}

uint32_t eng_thick_batch_test(const struct eng_kernels *kernels,
                              const struct eng_thick_question *question,
                              const struct eng_point *points, const uint32_t (*quads)[4],
                              const double (*radius)[3], uint32_t count,
                              struct eng_thick *thick, struct eng_thick_batch *batch)
{
    assert(count <= ENG_CHUNK_MAX && question->kind <= PCCD_VV);
    uint32_t found = 0;
    uint32_t left = keep(kernels, question, points, quads, radius, count, batch);
    advance(kernels, question, points, quads, radius, left, batch);
    batch->survivors = 0;
    for (uint32_t i = 0; i < left; i++) {
        uint32_t pair = batch->left[i];
        const struct eng_advance *now = &batch->advance[i];
        struct eng_thick_query query;
        batch->survivors += now->now != ENG_ADVANCE_MISSES;
        if (now->now == ENG_ADVANCE_OPEN) {
            load(question, points, quads[pair], radius[pair], &query);
        }
        if (eng_thick_decide(thick, &query, now, question->tolerance, question->t_end,
                             &batch->hits[found])) {
            batch->index[found++] = pair;
        }
        if (now->now == ENG_ADVANCE_OPEN) {
            batch->exact++;
            if (batch->should_stop && batch->should_stop(batch->owner)) {
                break;
            }
        }
    }
    kernels->describe(question->kind, points, quads, batch->index, found, batch->hits);
    return found;
}

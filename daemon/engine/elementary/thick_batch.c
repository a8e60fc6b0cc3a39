/* daemon/engine/elementary/thick_batch.c - many pairs of thick features at once.
 *
 * Room:     engine.
 * Does:     see thick_batch.h. Kernels reject, in lanes; the rest are asked one by one.
 * Threads:  one thread for one scratch.
 */
#include "thick_batch.h"

#include <assert.h>
#include <string.h>

#include "kinds.h"

/* Pairs one by one between two looks at the clock: some 50 us. */
#define PAIRS_PER_LOOK 32u

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

uint32_t eng_thick_batch_test(const struct eng_kernels *kernels,
                              const struct eng_thick_question *question,
                              const struct eng_point *points, const uint32_t (*quads)[4],
                              const double (*radius)[3], uint32_t count,
                              struct eng_thick *thick, struct eng_exact *contacts,
                              struct eng_thick_batch *batch)
{
    assert(count <= ENG_CHUNK_MAX && question->kind <= PCCD_VV);
    uint32_t found = 0;
    for (uint32_t i = 0; i < count; i++) {
        batch->reach[i] = eng_thick_reach(radius[i]);
    }
    batch->survivors =
        kernels->stay_beyond(common_kinds[question->kind].points[0], points, quads, count,
                             batch->reach, batch->left);
    bool has_lanes = question->kind == PCCD_VF || question->kind == PCCD_EE;
    if (has_lanes) {
        batch->survivors = kernels->advance((enum pccd_kind)question->kind, points, quads,
                                            batch->left, batch->survivors, batch->reach,
                                            question->t_end, batch->since);
    }
    for (uint32_t i = 0; i < batch->survivors; i++) {
        uint32_t pair = batch->left[i];
        uint64_t before = thick->decided[ENG_THICK_BY_INTEGERS] + contacts->queries;
        struct eng_thick_query query;
        load(question, points, quads[pair], radius[pair], &query);
        query.since = has_lanes ? batch->since[i] : 0;
        if (eng_thick_solve(thick, contacts, &query, question->tolerance, question->t_end,
                            &batch->hits[found])) {
            batch->index[found++] = pair;
        }
        uint64_t exact =
            thick->decided[ENG_THICK_BY_INTEGERS] + contacts->queries - before;
        batch->exact += exact > 0;
        if (batch->should_stop && (exact > 0 || i % PAIRS_PER_LOOK == 0) &&
            batch->should_stop(batch->owner)) {
            break;
        }
    }
    return found;
}

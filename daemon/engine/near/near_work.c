/* daemon/engine/near/near_work.c - pairs that are near, as they were asked for.
 *
 * Room:     engine.
 * Does:     see near_work.h.
 * Threads:  near_work.h.
 */
#include "near_work.h"

#include <assert.h>
#include <string.h>

#include "closest_features.h"
#include "memory.h"

/* Records are those of contacts, with other meanings: all that puts them in order, merges
 * and hashes them serves both. */
static_assert(sizeof(struct pccd_near) == sizeof(struct pccd_contact) &&
                  offsetof(struct pccd_near, d_lo) ==
                      offsetof(struct pccd_contact, toi) &&
                  offsetof(struct pccd_near, count) ==
                      offsetof(struct pccd_contact, reserved),
              "records");

static bool should_stop(void *owner)
{
    return eng_worker_should_stop(owner);
}

int eng_near_work_reserve(struct eng_worker *worker)
{
    if (worker->near_work) {
        return PCCD_OK;
    }
    struct eng_near_work *work = eng_alloc(1, sizeof *work);
    if (!work) {
        return PCCD_E_NOMEM;
    }
    int status = eng_distances_init(&work->distances);
    if (status != PCCD_OK) {
        eng_free(work);
        return status;
    }
    work->batch.should_stop = should_stop;
    work->batch.owner = worker;
    worker->near_work = work;
    return PCCD_OK;
}

void eng_near_work_free(struct eng_worker *worker)
{
    if (worker->near_work) {
        eng_distances_deinit(&worker->near_work->distances);
        eng_free(worker->near_work);
        worker->near_work = NULL;
    }
}

uint64_t eng_near_work_bytes(const struct eng_worker *worker)
{
    return worker->near_work ? sizeof *worker->near_work : 0;
}

void eng_near_work_begin(struct eng_worker *worker)
{
    struct eng_near_work *work = eng_near_work_of(worker);
    work->least = 2e18;
    work->greatest = 0;
    work->touches = 0;
    work->batch.exact = 0;
}

static enum eng_distance_wanted wanted_for(enum pccd_near_what what)
{
    switch (what) {
    case PCCD_NEAR_CROSSINGS:
        return ENG_DISTANCE_WITHIN;
    case PCCD_NEAR_VERTICES:
        return ENG_DISTANCE_LENGTH;
    default:
        return ENG_DISTANCE_WHOLE;
    }
}

static void write_record(struct pccd_near *record, const struct eng_distance *distance)
{
    record->flags = (uint32_t)distance->type << 8;
    record->d_lo = distance->lo;
    record->d_hi = distance->hi;
    for (int k = 0; k < 2; k++) {
        record->param[k] = (float)distance->param[k];
    }
    for (int k = 0; k < 3; k++) {
        record->direction[k] = (float)distance->direction[k];
    }
    record->count = 1;
}

static void keep_record(struct eng_worker *worker, const struct pccd_pair *name,
                        const struct eng_distance *distance)
{
    struct pccd_near *record = eng_found_add(&worker->found, name);
    if (record) { /* a full list says so itself */
        write_record(record, distance);
    }
}

static void keep_features(struct eng_worker *worker, const struct pccd_pair *pair,
                          const struct eng_point *const all[4],
                          const struct eng_distance *distance)
{
    struct pccd_pair closest;
    struct eng_distance at;
    eng_closest_features(worker->scene, pair, all, distance, &closest, &at);
    keep_record(worker, &closest, &at);
}

/* The least of all pairs of a vertex, whichever thread finds it. */
static void keep_bound(_Atomic uint64_t *bound, uint64_t bits)
{
    uint64_t before = atomic_load_explicit(bound, memory_order_relaxed);
    while (bits < before &&
           !atomic_compare_exchange_weak_explicit(
               bound, &before, bits, memory_order_relaxed, memory_order_relaxed)) {
    }
}

static void keep_bounds(struct eng_worker *worker, const struct eng_point *const all[4],
                        double length)
{
    uint64_t bits;
    memcpy(&bits, &length, sizeof bits);
    for (uint32_t i = 0; i < 4; i++) {
        keep_bound(&worker->settings->near->bounds[(uint32_t)all[i]->word0], bits);
    }
}

void eng_near_test(struct eng_worker *worker, enum pccd_kind kind,
                   const struct eng_point *points, const uint32_t (*quads)[4],
                   uint32_t count, bool is_sifted, eng_near_name_fn name)
{
    const struct eng_near_query *near = worker->settings->near;
    struct eng_near_work *work = eng_near_work_of(worker);
    const struct eng_distance_question question = {.kind = kind,
                                                   .end = near->end,
                                                   .distance = near->distance,
                                                   .is_sifted = is_sifted,
                                                   .wanted = wanted_for(near->what)};
    worker->record.tests += count;
    uint32_t found = eng_distance_batch_test(worker->kernels, &question, points, quads,
                                             count, &work->distances, &work->batch);
    worker->tally.survivors += found;
    if (question.wanted == ENG_DISTANCE_WITHIN) {
        work->touches += found;
        return;
    }
    for (uint32_t i = 0; i < found; i++) {
        const struct eng_distance *distance = &work->batch.found[i];
        const uint32_t *quad = quads[work->batch.index[i]];
        const struct eng_point *const all[4] = {&points[quad[0]], &points[quad[1]],
                                                &points[quad[2]], &points[quad[3]]};
        work->least = distance->lo < work->least ? distance->lo : work->least;
        work->greatest = distance->hi > work->greatest ? distance->hi : work->greatest;
        if (near->what == PCCD_NEAR_VERTICES) {
            keep_bounds(worker, all, distance->lo);
            continue;
        }
        struct pccd_pair pair = name(worker, kind, work->batch.index[i]);
        if (near->what == PCCD_NEAR_FEATURES) {
            keep_features(worker, &pair, all, distance);
        } else {
            keep_record(worker, &pair, distance);
        }
    }
}

/* Where along the edge it passes through the face, in a record's terms. */
static struct eng_distance passage(struct eng_distances *distances, uint32_t end,
                                   const struct eng_point *points, const uint32_t five[5])
{
    struct eng_distance at = {.type = ENG_NEAREST_VF};
    double x[5][3];
    for (int i = 0; i < 5; i++) {
        const struct eng_point *point = &points[five[i]];
        memcpy(x[i], end == 0 ? point->x0 : point->x1, sizeof x[i]);
    }
    at.param[0] = eng_distance_crossing(distances, (const double(*)[3])x);
    return at;
}

void eng_near_cross(struct eng_worker *worker, const struct eng_point *points,
                    const uint32_t (*fives)[5], uint32_t count, eng_near_name_fn name)
{
    struct eng_near_work *work = eng_near_work_of(worker);
    const uint64_t *integers = &work->distances.decided[ENG_DISTANCE_BY_INTEGERS];
    uint32_t end = worker->settings->near->end;
    worker->record.tests += count;
    uint32_t found = eng_distance_batch_cross(worker->kernels, end, points, fives, count,
                                              &work->distances, &work->batch);
    worker->tally.survivors += found;
    work->least = found > 0 ? 0 : work->least;
    for (uint32_t i = 0; i < found; i++) {
        uint64_t before = *integers;
        uint32_t pair = work->batch.index[i];
        struct pccd_pair named = name(worker, (enum pccd_kind)PCCD_EF, pair);
        struct eng_distance at = passage(&work->distances, end, points, fives[pair]);
        keep_record(worker, &named, &at);
        if (*integers > before && eng_worker_should_stop(worker)) {
            return;
        }
    }
}

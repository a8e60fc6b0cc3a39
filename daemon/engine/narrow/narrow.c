/* narrow.c - contacts and pairs, and what a worker needs to test any. */
#include "narrow.h"

#include <assert.h>
#include <string.h>

#include "memory.h"
#include "solve.h"

/* Pairs that are named at a time. */
#define NAMES 64u

static bool should_stop(void *owner)
{
    return eng_worker_should_stop(owner);
}

static int reserve_thick(struct eng_narrow *narrow)
{
    struct eng_narrow_thick *thick = eng_alloc(1, sizeof *thick);
    if (!thick) {
        return PCCD_E_NOMEM;
    }
    int status = eng_thick_init(&thick->thick);
    if (status == PCCD_OK) {
        status = eng_distances_init(&thick->distances);
        if (status != PCCD_OK) {
            eng_thick_deinit(&thick->thick);
        }
    }
    if (status != PCCD_OK) {
        eng_free(thick);
        return status;
    }
    narrow->thick = thick;
    narrow->batch.thick = &thick->thick;
    narrow->batch.lanes = &thick->lanes;
    return PCCD_OK;
}

static int reserve_near(struct eng_narrow *narrow)
{
    struct eng_narrow_near *near = eng_alloc(1, sizeof *near);
    if (!near) {
        return PCCD_E_NOMEM;
    }
    int status = eng_distances_init(&near->distances);
    if (status != PCCD_OK) {
        eng_free(near);
        return status;
    }
    near->has_recent = true; /* what lies there */
    narrow->near = near;
    narrow->batch.distances = &near->distances;
    return PCCD_OK;
}

static int reserve_touching(struct eng_narrow *narrow)
{
    struct eng_touching *touching = eng_alloc(1, sizeof *touching);
    if (!touching) {
        return PCCD_E_NOMEM;
    }
    int status = eng_touching_init(touching);
    if (status != PCCD_OK) {
        eng_free(touching);
        return status;
    }
    narrow->touching = touching;
    return PCCD_OK;
}

static int reserve_batch(struct eng_worker *worker)
{
    struct eng_narrow *narrow = eng_alloc(1, sizeof *narrow);
    if (!narrow) {
        return PCCD_E_NOMEM;
    }
    narrow->thick = NULL;
    narrow->near = NULL;
    narrow->touching = NULL;
    narrow->batch.should_stop = should_stop;
    narrow->batch.owner = worker;
    narrow->batch.contacts = &worker->exact;
    worker->narrow = narrow;
    return PCCD_OK;
}

int eng_narrow_reserve(struct eng_worker *worker, const struct eng_scene *scene,
                       const struct eng_question *question)
{
    bool is_near = eng_asks_near(question);
    int status = worker->narrow ? PCCD_OK : reserve_batch(worker);
    bool is_thick = is_near ? question->sought.is_thick : scene->thickness.is_on;
    if (status == PCCD_OK && is_thick && !worker->narrow->thick) {
        status = reserve_thick(worker->narrow);
    }
    if (status == PCCD_OK && is_near && !worker->narrow->near) {
        status = reserve_near(worker->narrow);
    }
    if (status == PCCD_OK && eng_asks_touching(question) && !worker->narrow->touching) {
        status = reserve_touching(worker->narrow);
    }
    return status;
}

void eng_narrow_free(struct eng_worker *worker)
{
    struct eng_narrow *narrow = worker->narrow;
    if (narrow && narrow->thick) {
        eng_thick_deinit(&narrow->thick->thick);
        eng_distances_deinit(&narrow->thick->distances);
        eng_free(narrow->thick);
    }
    if (narrow && narrow->near) {
        eng_distances_deinit(&narrow->near->distances);
        eng_free(narrow->near);
    }
    if (narrow && narrow->touching) {
        eng_touching_deinit(narrow->touching);
        eng_free(narrow->touching);
    }
    eng_free(narrow);
    worker->narrow = NULL;
}

uint64_t eng_narrow_bytes(const struct eng_worker *worker)
{
    const struct eng_narrow *narrow = worker->narrow;
    uint64_t bytes = narrow ? sizeof *narrow : 0;
    if (narrow && narrow->thick) {
        bytes += sizeof *narrow->thick + eng_thick_exact_bytes() + eng_numbers_bytes();
    }
    if (narrow && narrow->touching) {
        bytes += sizeof *narrow->touching + eng_touching_bytes();
    }
    return bytes + (narrow && narrow->near ? sizeof *narrow->near : 0);
}

void eng_narrow_begin(struct eng_worker *worker)
{
    struct eng_narrow *narrow = worker->narrow;
    if (!narrow) { /* it is asked of objects two by two */
        return;
    }
    narrow->batch.kernels = worker->kernels;
    narrow->batch.integers = 0;
    if (narrow->thick) {
        narrow->thick->candidates = 0;
        narrow->thick->survivors = 0;
    }
}

/* ---- contacts ---------------------------------------------------------------------- */

/* Fill in records one behind the other, and widen the range of their names. */
static void write_contacts(struct pccd_contact *contacts, const struct pccd_pair *names,
                           const struct eng_hit *hits, uint32_t count,
                           struct eng_name_range *range)
{
    struct eng_name_range all = *range; /* in registers: no record can be in it */
    for (uint32_t i = 0; i < count; i++) {
        const struct eng_hit *hit = &hits[i];
        const struct eng_name words = {{names[i].kind, names[i].object_a,
                                        names[i].feature_a, names[i].object_b,
                                        names[i].feature_b}};
        assert(hit->toi <= hit->toi_hi); /* a bracket, NaN in neither end */
        __builtin_prefetch((const unsigned char *)&contacts[i] + ENG_FETCHED_AHEAD, 1);
        eng_name_range_add(&all, &words);
        contacts[i] = (struct pccd_contact){
            .kind = names[i].kind,
            .flags = hit->flags,
            .object_a = names[i].object_a,
            .feature_a = names[i].feature_a,
            .object_b = names[i].object_b,
            .feature_b = names[i].feature_b,
            .toi = hit->toi,
            .toi_hi = hit->toi_hi,
            .param = {hit->param[0], hit->param[1]},
            .normal = {hit->normal[0], hit->normal[1], hit->normal[2]}};
    }
    *range = all;
}

/* Keep contacts, as many at a time as the list has places for; a full one knows what
 * becomes of the next. */
static void keep_contacts(struct eng_worker *worker, const struct pccd_pair *names,
                          const struct eng_hit *hits, uint32_t count)
{
    struct eng_found *found = &worker->found;
    for (uint32_t i = 0; i < count;) {
        void *slots;
        uint64_t *keys;
        uint32_t n = eng_found_open(found, count - i, &slots, &keys);
        if (n == 0) {
            eng_record_contact(worker, &names[i], &hits[i]);
            i++;
            continue;
        }
        write_contacts(slots, &names[i], &hits[i], n, &found->range);
        eng_found_close(found, n);
        i += n;
    }
}

/* Those of the batch, whose pairs are numbers number[..] of the candidates, NULL: as they
 * are. */
static void keep(struct eng_worker *worker, const struct eng_pairs *pairs,
                 const uint32_t *number, eng_names_fn names)
{
    struct eng_batch *batch = &worker->narrow->batch;
    bool is_listed = worker->question->mode == PCCD_MODE_PAIRS;
    for (uint32_t i = 0; i < batch->found && number; i++) {
        batch->index[i] = number[batch->index[i]];
    }
    for (uint32_t i = 0; i < batch->found; i += NAMES) {
        struct pccd_pair name[NAMES];
        uint32_t count = batch->found - i < NAMES ? batch->found - i : NAMES;
        names(worker, (enum pccd_kind)pairs->kind, batch->index + i, count, name);
        if (worker->question->mode == PCCD_MODE_ALL) {
            keep_contacts(worker, name, &batch->hits[i], count);
            continue;
        }
        for (uint32_t k = 0; k < count; k++) {
            if (is_listed) {
                eng_found_add(&worker->found, &name[k]); /* a full list says so itself */
            } else if (!eng_stop_is_set(worker->stop)) {
                eng_record_contact(worker, &name[k], &batch->hits[i + k]);
            }
        }
    }
}

/* Tell whoever weighs of the pairs that the lanes did not reject, in the place of keeping
 * any. Those that keep a distance may be rejected later, where `left` stays as it was: as
 * many are told as are left, but not always the same ones. Weights need no more. */
static void weigh(struct eng_worker *worker, const struct eng_pairs *pairs,
                  const uint32_t *number, eng_names_fn names)
{
    struct eng_batch *batch = &worker->narrow->batch;
    const struct eng_question *question = worker->question;
    for (uint32_t i = 0; i < batch->survivors && number; i++) {
        batch->left[i] = number[batch->left[i]];
    }
    for (uint32_t i = 0; i < batch->survivors; i += NAMES) {
        struct pccd_pair name[NAMES];
        uint32_t count = batch->survivors - i < NAMES ? batch->survivors - i : NAMES;
        names(worker, (enum pccd_kind)pairs->kind, batch->left + i, count, name);
        question->weigh(question->weigher, name, count);
    }
}

static void test_contacts(struct eng_worker *worker, const struct eng_pairs *pairs,
                          const uint32_t *number, eng_names_fn names)
{
    struct eng_batch *batch = &worker->narrow->batch;
    if (pairs->count == 0 || (!pairs->radius && !eng_solvers[pairs->kind].search)) {
        return; /* what keeps no distance is not tested */
    }
    eng_batch_test(batch, pairs);
    if (worker->question->mode != PCCD_MODE_PAIRS) {
        worker->record.tests += pairs->count;
        worker->tally.survivors += batch->survivors;
    }
    if (worker->question->brief && (pairs->radius || batch->unsure_count > 0)) {
        eng_worker_give_up(worker);
    }
    if (worker->question->weigh) {
        weigh(worker, pairs, number, names);
    } else {
        if (eng_asks_touching(worker->question)) {
            eng_narrow_touching(worker, pairs);
        }
        keep(worker, pairs, number, names);
    }
}

/* Those that meet at a distance, then the others. */
static void test_parts(struct eng_worker *worker, const struct eng_pairs *pairs,
                       eng_names_fn names)
{
    struct eng_narrow_thick *thick = worker->narrow->thick;
    struct eng_pairs parts[2];
    eng_narrow_split(worker, pairs, parts);
    test_contacts(worker, &parts[0], thick->number[0], names);
    if (parts[0].count > 0 && worker->question->mode != PCCD_MODE_PAIRS) {
        thick->survivors += worker->narrow->batch.survivors;
    }
    if (!eng_stop_is_set(worker->stop)) {
        test_contacts(worker, &parts[1], thick->number[1], names);
    }
}

void eng_narrow_test(struct eng_worker *worker, struct eng_pairs *pairs,
                     eng_names_fn names)
{
    pairs->question = worker->question;
    pairs->t_end = worker->time_bound;
    pairs->radius = NULL;
    if (eng_asks_near(worker->question)) {
        eng_near_test(worker, pairs, names);
    } else if (worker->scene->thickness.is_on) {
        test_parts(worker, pairs, names);
    } else {
        test_contacts(worker, pairs, NULL, names);
    }
}

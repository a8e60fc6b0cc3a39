/* narrow_near.c - pairs that are near, as they were asked for. */
#include <assert.h>
#include <string.h>

#include "narrow.h"

/* Records are those of contacts, with other meanings: all that puts them in order, merges
 * and hashes them serves both. */
static_assert(sizeof(struct pccd_near) == sizeof(struct pccd_contact) &&
                  offsetof(struct pccd_near, d_lo) ==
                      offsetof(struct pccd_contact, toi) &&
                  offsetof(struct pccd_near, count) ==
                      offsetof(struct pccd_contact, reserved),
              "records");

struct eng_name_range eng_near_range(const struct eng_scene *scene)
{
    struct eng_name_range range;
    eng_name_range_init(&range);
    for (uint32_t i = 0; i < scene->object_capacity; i++) {
        const struct eng_object *object = &scene->objects[i];
        if (object->mesh) {
            const struct eng_mesh_info *info = &object->mesh->info;
            uint32_t most = info->edge_count > info->triangle_count
                                ? info->edge_count
                                : info->triangle_count;
            most = object->vertices.count > most ? object->vertices.count : most;
            struct eng_name low = {{0, object->id, 0, object->id, 0}};
            struct eng_name high = {{PCCD_EF, object->id, most, object->id, most}};
            eng_name_range_add(&range, &low);
            eng_name_range_add(&range, &high);
        }
    }
    return range;
}

static void forget_recent(struct eng_narrow_near *work)
{
    if (work->has_recent) {
        memset(work->recent, 0, sizeof work->recent);
        work->has_recent = false;
    }
}

/* The range of all names saves looking at each. Of objects whose handles need many bits
 * it is not taken, so that the fewer that are near may have keys of one word. */
void eng_near_begin(struct eng_worker *worker, const struct eng_name_range *range)
{
    struct eng_narrow_near *work = worker->narrow->near;
    (void)eng_found_expect(&worker->found, range);
    forget_recent(work);
    memset(&work->edges, 0, sizeof work->edges);
    work->least = 2e18;
    work->greatest = 0;
    work->pairs = work->crossings = 0;
}

static void write_record(struct pccd_near *record, const struct pccd_pair *name,
                         const struct eng_distance *distance)
{
    *record = (struct pccd_near){
        .kind = name->kind,
        .flags = (uint32_t)distance->type << 8,
        .object_a = name->object_a,
        .feature_a = name->feature_a,
        .object_b = name->object_b,
        .feature_b = name->feature_b,
        .d_lo = distance->lo,
        .d_hi = distance->hi,
        .param = {(float)distance->param[0], (float)distance->param[1]},
        .direction = {(float)distance->direction[0], (float)distance->direction[1],
                      (float)distance->direction[2]},
        .count = 1};
}

/* One more record, wherever the list has a place for it; a full one says so itself. */
static void keep_anywhere(struct eng_worker *worker, const struct pccd_pair *name,
                          const struct eng_distance *distance)
{
    forget_recent(worker->narrow->near); /* they may be moved */
    struct pccd_near *record = eng_found_add(&worker->found, name);
    if (record) {
        write_record(record, name, distance);
    }
}

static uint64_t key_of(const struct eng_found *found, const struct pccd_pair *name)
{
    struct eng_name words;
    memcpy(&words, name, sizeof words);
    return eng_order_key(&found->order, &words);
}

/* Room for some of `count` records, the first of them of this name, with a key each; 0:
 * there are no keys, and the first is kept by itself. */
static uint32_t open_records(struct eng_worker *worker, uint32_t count,
                             const struct pccd_pair *name,
                             const struct eng_distance *distance, void **records,
                             uint64_t **keys)
{
    struct eng_found *found = &worker->found;
    uint32_t n = found->has_keys ? eng_found_open(found, count, records, keys) : 0;
    if (n == 0) {
        keep_anywhere(worker, name, distance);
    }
    return n;
}

static void keep_records(struct eng_worker *worker, const struct pccd_pair *names,
                         const struct eng_distance *distances, uint32_t count)
{
    struct eng_found *found = &worker->found;
    for (uint32_t i = 0; i < count;) {
        void *slots;
        uint64_t *keys;
        uint32_t n =
            open_records(worker, count - i, &names[i], &distances[i], &slots, &keys);
        if (n == 0) {
            i++;
            continue;
        }
        struct pccd_near *records = slots;
        for (uint32_t k = 0; k < n; k++) {
            keys[k] = key_of(found, &names[i + k]);
            __builtin_prefetch((const unsigned char *)&records[k] + ENG_FETCHED_AHEAD, 1);
            write_record(&records[k], &names[i + k], &distances[i + k]);
        }
        eng_found_close(found, n);
        i += n;
    }
}

/* Where a record of that key was put last. */
static struct eng_near_recent *recent_of(struct eng_narrow_near *work, uint64_t key)
{
    return &work->recent[key * 0x9e3779b97f4a7c15u >> (64 - ENG_NEAR_RECENT_BITS)];
}

/* All that is said of a feature is a function of it alone, so another record of its name
 * only adds to the count of the first. Which do cannot be foreseen: each is written, to
 * the place of the next one if it is of no use. */
static uint32_t write_features(struct eng_worker *worker, uint32_t first, uint32_t count,
                               struct pccd_near *records, uint64_t *keys)
{
    struct eng_narrow_near *work = worker->narrow->near;
    uint32_t written = 0;
    for (uint32_t i = first; i < first + count; i++) {
        uint64_t key = key_of(&worker->found, &work->names[i]);
        struct eng_near_recent *recent = recent_of(work, key);
        struct pccd_near *record = &records[written];
        struct pccd_near *const slots[2] = {record, recent->record};
        bool is_known = recent->record && recent->key == key;
        write_record(record, &work->names[i], &worker->narrow->batch.near[i]);
        record->count = 0;
        keys[written] = key;
        *recent = (struct eng_near_recent){key, slots[is_known]};
        recent->record->count++;
        written += !is_known;
    }
    return written;
}

static void keep_features(struct eng_worker *worker, uint32_t count)
{
    struct eng_narrow_near *work = worker->narrow->near;
    for (uint32_t i = 0; i < count;) {
        void *slots;
        uint64_t *keys;
        uint32_t n = open_records(worker, count - i, &work->names[i],
                                  &worker->narrow->batch.near[i], &slots, &keys);
        if (n == 0) {
            i++;
            continue;
        }
        eng_found_close(&worker->found, write_features(worker, i, n, slots, keys));
        work->has_recent = true;
        i += n;
    }
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

static void keep_bounds(struct eng_worker *worker, const struct eng_pairs *pairs)
{
    const struct eng_batch *batch = &worker->narrow->batch;
    _Atomic uint64_t *bounds = worker->question->sought.bounds;
    for (uint32_t i = 0; i < batch->found; i++) {
        const uint32_t *quad = pairs->quads[batch->index[i]];
        uint64_t bits;
        memcpy(&bits, &batch->near[i].lo, sizeof bits);
        for (uint32_t k = 0; k < 4; k++) {
            keep_bound(&bounds[(uint32_t)pairs->points[quad[k]].word0], bits);
        }
    }
}

/* The least and the greatest of all that was found. */
static void keep_range(struct eng_narrow *narrow)
{
    struct eng_narrow_near *work = narrow->near;
    double least = work->least;
    double greatest = work->greatest;
    for (uint32_t i = 0; i < narrow->batch.found; i++) {
        const struct eng_distance *distance = &narrow->batch.near[i];
        least = distance->lo < least ? distance->lo : least;
        greatest = distance->hi > greatest ? distance->hi : greatest;
    }
    work->least = least;
    work->greatest = greatest;
}

/* CROSSINGS: some features cross or touch. */
static void tell_meeting(struct eng_worker *worker)
{
    if (worker->narrow->batch.found > 0) {
        atomic_store_explicit(worker->question->sought.meets, true, memory_order_relaxed);
    }
}

/* Those of what was found stay that are within their own radii, too. */
static void keep_within(struct eng_worker *worker, const struct eng_pairs *pairs)
{
    struct eng_batch *batch = &worker->narrow->batch;
    uint32_t kept = 0;
    for (uint32_t i = 0; i < batch->found; i++) {
        if (eng_narrow_is_within(worker, pairs, batch->index[i], &batch->near[i])) {
            batch->index[kept] = batch->index[i];
            batch->near[kept++] = batch->near[i];
        }
    }
    batch->found = kept;
}

/* Where along the edge it passes through the face, in a record's terms. */
static struct eng_distance passage(struct eng_distances *distances,
                                   const struct eng_pairs *pairs, uint32_t number)
{
    struct eng_distance at = {.type = ENG_NEAREST_VF};
    double x[5][3];
    for (int i = 0; i < 5; i++) {
        const struct eng_point *point = &pairs->points[pairs->fives[number][i]];
        memcpy(x[i], pairs->question->end == 0 ? point->x0 : point->x1, sizeof x[i]);
    }
    at.param[0] = eng_distance_crossing(distances, (const double(*)[3])x);
    return at;
}

/* Edges that pass through faces. Beside other questions than CROSSINGS they are counted
 * alone. */
static void keep_crossings(struct eng_worker *worker, const struct eng_pairs *pairs,
                           eng_names_fn names)
{
    struct eng_narrow_near *work = worker->narrow->near;
    const struct eng_batch *batch = &worker->narrow->batch;
    const uint64_t *integers = &work->distances.decided[ENG_DISTANCE_BY_INTEGERS];
    work->crossings += batch->found;
    if (pairs->question->verb != PCCD_NEAR_CROSSINGS || pairs->question->counts_only) {
        return;
    }
    work->least = batch->found > 0 ? 0 : work->least;
    tell_meeting(worker);
    names(worker, (enum pccd_kind)PCCD_EF, batch->index, batch->found, work->names);
    for (uint32_t i = 0; i < batch->found; i++) {
        uint64_t before = *integers;
        struct eng_distance at = passage(&work->distances, pairs, batch->index[i]);
        keep_records(worker, &work->names[i], &at, 1);
        if (*integers > before && eng_worker_should_stop(worker)) {
            return;
        }
    }
}

static void keep_near(struct eng_worker *worker, const struct eng_pairs *pairs,
                      eng_names_fn names)
{
    struct eng_narrow_near *work = worker->narrow->near;
    struct eng_batch *batch = &worker->narrow->batch;
    const enum pccd_kind kind = (enum pccd_kind)pairs->kind;
    if (pairs->question->sought.is_thick) {
        keep_within(worker, pairs);
    }
    work->pairs += batch->found;
    if (pairs->question->counts_only) {
        return;
    }
    keep_range(worker->narrow);
    if (pairs->question->verb == PCCD_NEAR_VERTICES) {
        keep_bounds(worker, pairs);
        return;
    }
    names(worker, kind, batch->index, batch->found, work->names);
    if (pairs->question->verb == PCCD_NEAR_FEATURES) {
        eng_closest_features(worker, pairs);
        keep_features(worker, batch->found);
    } else {
        keep_records(worker, work->names, batch->near, batch->found);
    }
}

/* Tell whoever weighs a step of the pairs by which it says how it begins. */
static void weigh(struct eng_worker *worker, const struct eng_pairs *pairs,
                  eng_names_fn names)
{
    struct eng_narrow *narrow = worker->narrow;
    names(worker, (enum pccd_kind)pairs->kind, narrow->batch.index, narrow->batch.found,
          narrow->near->names);
    pairs->question->weigh(pairs->question->weigher, narrow->near->names,
                           narrow->batch.found);
}

void eng_near_test(struct eng_worker *worker, struct eng_pairs *pairs, eng_names_fn names)
{
    pairs->reach = pairs->question->sought.reach;
    worker->record.tests += pairs->count;
    worker->tally.survivors += eng_batch_test(&worker->narrow->batch, pairs);
    if (pairs->question->weigh) {
        weigh(worker, pairs, names);
    }
    if (pairs->kind == PCCD_EF) {
        keep_crossings(worker, pairs, names);
    } else if (pairs->question->verb == PCCD_NEAR_CROSSINGS) {
        tell_meeting(worker);
    } else {
        keep_near(worker, pairs, names);
    }
}

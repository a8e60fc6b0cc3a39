/* answer_cache.c - records of what stands still, from the last answer. */
#include "answer_cache.h"

#include <assert.h>
#include <string.h>

#include "kinds.h"
#include "memory.h"
#include "moving.h"
#include "thickness.h"

/* Records of a brief step that are looked at, at most: some 10 us. */
#define BRIEF_RECORDS 1024u

void eng_answer_cache_deinit(struct eng_answer_cache *cache)
{
    eng_free(cache->stands);
    memset(cache, 0, sizeof *cache);
}

uint64_t eng_answer_cache_bytes(const struct eng_answer_cache *cache)
{
    return cache->stands_size;
}

static bool reserve(struct eng_answer_cache *cache)
{
    cache->has_all = !cache->objects_changed;
    if (cache->count > cache->stands_size) {
        uint64_t size = cache->count + cache->count / 8;
        unsigned char *stands = eng_alloc(size, 1);
        if (!stands) {
            return false;
        }
        eng_free(cache->stands);
        cache->stands = stands;
        cache->stands_size = size;
    }
    cache->objects_changed = false;
    return true;
}

/* ---- what stands ------------------------------------------------------------------- */

static bool vertex_moves(const struct eng_scene *scene, const struct eng_object *object,
                         uint32_t vertex)
{
    return object->moves == ENG_MOVES_ALL ||
           scene->moving.moves[object->vertices.first + vertex] != 0;
}

/* A feature of so many points, by its index, stands if all of its corners do. */
static bool feature_stands(const struct eng_scene *scene, const struct eng_object *object,
                           uint32_t points, uint32_t feature)
{
    assert(points >= 1 && points <= 3);
    if (object->moves == ENG_STANDS) {
        return true;
    }
    const uint32_t *corners = points == 1   ? &feature
                              : points == 2 ? object->mesh->edges[feature]
                                            : object->mesh->leaves[feature].v;
    for (uint32_t i = 0; i < points; i++) {
        if (vertex_moves(scene, object, corners[i])) {
            return false;
        }
    }
    return true;
}

/* The objects of a record: mostly those of the one before it. NULL: not looked for yet,
 * or gone. */
struct owners {
    uint32_t id[2];
    const struct eng_object *object[2];
    bool may_stand; /* neither is gone, nor moves as a whole */
};

static void find_owners(const struct eng_scene *scene, struct owners *owners)
{
    owners->may_stand = true;
    for (uint32_t side = 0; side < 2; side++) {
        uint32_t found = eng_ids_find(&scene->ids, owners->id[side]);
        const struct eng_object *object =
            found == ENG_NO_OBJECT ? NULL : &scene->objects[found];
        owners->object[side] = object;
        owners->may_stand &= object && object->moves != ENG_MOVES_ALL;
    }
}

static void look_up(const struct eng_scene *scene, uint32_t a, uint32_t b,
                    struct owners *owners)
{
    if (!owners->object[0] || a != owners->id[0] || b != owners->id[1]) {
        owners->id[0] = a;
        owners->id[1] = b;
        find_owners(scene, owners);
    }
}

static bool record_stands(const struct eng_scene *scene, const unsigned char *record,
                          uint32_t bytes, struct owners *owners)
{
    look_up(scene, eng_name_word(record, bytes, 1), eng_name_word(record, bytes, 3),
            owners);
    if (!owners->may_stand) {
        return false;
    }
    const uint32_t *points = common_kinds[eng_name_word(record, bytes, 0)].points;
    return feature_stands(scene, owners->object[0], points[0],
                          eng_name_word(record, bytes, 2)) &&
           feature_stands(scene, owners->object[1], points[1],
                          eng_name_word(record, bytes, 4));
}

bool eng_answer_cache_fits(const struct eng_answer_cache *cache,
                           const struct eng_scene *scene,
                           const struct eng_question *question, uint64_t number)
{
    /* What becomes of a pair that touches depends on what is around it, too; and of what
     * touches, mode first-per-pair has forgotten all but one for each two objects. */
    return cache->is_valid && !eng_asks_touching(question) &&
           question->mode != PCCD_MODE_FIRST_PER_PAIR &&
           question->tuning.still == ENG_STILL_KEPT && cache->number == number &&
           cache->mode == question->mode && cache->tolerance == question->tolerance &&
           cache->masks_version == scene->masks.version &&
           cache->thickness == scene->thickness.number &&
           cache->separation == question->distance &&
           cache->approach == question->approach && cache->no_hash == question->no_hash &&
           !scene->thickness.has_changed;
}

bool eng_answer_cache_is_brief(const struct eng_answer_cache *cache)
{
    return cache->count <= BRIEF_RECORDS;
}

bool eng_answer_cache_begin(struct eng_answer_cache *cache, const struct eng_scene *scene,
                            const struct eng_question *question, bool is_apart,
                            const struct eng_records *records)
{
    assert(!cache->is_valid || cache->mode == PCCD_MODE_ANY ||
           records->count == cache->count);
    (void)records;
    if (!eng_answer_cache_fits(cache, scene, question, scene->moving.number - 1) ||
        (question->brief && !eng_answer_cache_is_brief(cache)) || question->weigh ||
        !(is_apart || eng_moves_little(scene))) {
        return false;
    }
    if (!reserve(cache)) {
        return false;
    }
    if (question->mode == PCCD_MODE_ANY) {
        return cache->verdict == PCCD_VERDICT_NO ||
               (cache->verdict == PCCD_VERDICT_YES &&
                eng_answer_cache_decides(cache, scene));
    }
    return true;
}

bool eng_answer_cache_decides(const struct eng_answer_cache *cache,
                              const struct eng_scene *scene)
{
    struct owners owners = {.may_stand = false};
    return cache->verdict == PCCD_VERDICT_YES &&
           record_stands(scene, (const void *)&cache->proof, sizeof cache->proof,
                         &owners);
}

/* ---- the part of the last answer --------------------------------------------------- */

static void count_record(const unsigned char *record, uint32_t record_bytes,
                         struct eng_counts *counts, double *bound)
{
    if (record_bytes == sizeof(struct pccd_pair)) {
        counts->kind[eng_name_word(record, record_bytes, 0)]++;
        return;
    }
    const struct pccd_contact *contact = (const void *)record;
    eng_counts_contact(counts, contact);
    if ((contact->flags & PCCD_PROVED) && contact->toi_hi < *bound) {
        *bound = contact->toi_hi;
    }
}

/* Mark what stands; returns how many do. */
static uint64_t mark(struct eng_answer_cache *cache, const struct eng_scene *scene,
                     const struct eng_records *records, struct eng_counts *counts,
                     double *bound)
{
    struct owners owners = {.may_stand = false};
    uint64_t standing = 0;
    for (uint64_t i = 0; i < records->count; i++) {
        const unsigned char *record = records->data + i * records->record_bytes;
        bool stands = record_stands(scene, record, records->record_bytes, &owners);
        cache->stands[i] = stands;
        if (stands) {
            standing++;
            count_record(record, records->record_bytes, counts, bound);
        }
    }
    return standing;
}

/* The end of the run of records from `first` on that are marked as the first one is. */
static uint64_t end_of_run(const struct eng_answer_cache *cache, uint64_t first,
                           uint64_t count)
{
    const unsigned char *stands = cache->stands;
    const void *other = memchr(stands + first, !stands[first], count - first);
    return other ? (uint64_t)((const unsigned char *)other - stands) : count;
}

double eng_answer_cache_select(struct eng_answer_cache *cache,
                               const struct eng_scene *scene, struct eng_records *records,
                               struct eng_counts *counts)
{
    double bound = 1;
    uint32_t bytes = records->record_bytes;
    cache->is_valid = false; /* until the step has ended */
    if (cache->has_all && scene->moving.objects == 0) {
        *counts = cache->counts;
        return bound;
    }
    *counts = ENG_COUNTS_NONE;
    uint64_t standing = mark(cache, scene, records, counts, &bound);
    /* Hash whichever are fewer; the hash of those that go is taken from that of all. */
    bool by_loss = 2 * standing > records->count && !cache->no_hash;
    bool by_gain = !by_loss && !cache->no_hash;
    eng_hash_sum sum = by_loss ? cache->counts.hash : 0;
    unsigned char *to = records->data;
    for (uint64_t i = 0; i < records->count;) {
        uint64_t end = end_of_run(cache, i, records->count);
        const unsigned char *run = records->data + i * bytes;
        if (!cache->stands[i]) {
            sum -= by_loss ? eng_hash_records(run, end - i, bytes) : 0;
        } else {
            sum += by_gain ? eng_hash_records(run, end - i, bytes) : 0;
            if (to != run) {
                memmove(to, run, (end - i) * bytes);
            }
            to += (end - i) * bytes;
        }
        i = end;
    }
    records->count = standing;
    counts->hash = sum;
    return bound;
}

void eng_answer_cache_count(const struct eng_records *records, struct eng_counts *counts)
{
    double bound = 1;
    *counts = ENG_COUNTS_NONE;
    for (uint64_t i = 0; i < records->count; i++) {
        count_record(records->data + i * records->record_bytes, records->record_bytes,
                     counts, &bound);
    }
    counts->hash = eng_hash_records(records->data, records->count, records->record_bytes);
}

bool eng_answer_cache_is_crowded(const struct eng_scene *scene,
                                 const struct eng_records *records,
                                 const struct eng_counts *counts)
{
    uint64_t within = counts->initial + counts->inside;
    const uint64_t half = records->count / 2;
    struct owners owners = {.may_stand = false};
    if (!scene->thickness.is_on || within <= half) {
        return false;
    }
    for (uint64_t i = 0; i < records->count && within > half; i++) {
        const struct pccd_contact *contact =
            (const void *)(records->data + i * sizeof *contact);
        if ((contact->flags & (PCCD_INITIAL | PCCD_INSIDE)) != 0) {
            look_up(scene, contact->object_a, contact->object_b, &owners);
            within -= !eng_thickness_is_within(scene, owners.object[0]) &&
                      !eng_thickness_is_within(scene, owners.object[1]);
        }
    }
    return within > half;
}

/* Where among the records [count] one of this name belongs: from the end on, as those to
 * be placed come from the end. */
static uint64_t place_among(const struct eng_records *records, uint64_t count,
                            const struct eng_name *name)
{
    uint64_t low = 0;
    uint64_t high = count;
    for (uint64_t step = 1; high > 0; step *= 2) { /* gallop */
        uint64_t at = step < high ? high - step : 0;
        struct eng_name other = eng_name_of(records->data + at * records->record_bytes,
                                            records->record_bytes);
        if (eng_name_compare(&other, name) < 0) {
            low = at + 1;
            break;
        }
        high = at;
    }
    while (low < high) {
        uint64_t middle = low + (high - low) / 2;
        struct eng_name other = eng_name_of(
            records->data + middle * records->record_bytes, records->record_bytes);
        bool is_below = eng_name_compare(&other, name) < 0;
        low = is_below ? middle + 1 : low;
        high = is_below ? high : middle;
    }
    return low;
}

int eng_answer_cache_merge(struct eng_records *records, const struct eng_records *found)
{
    uint32_t bytes = records->record_bytes;
    uint64_t left = records->count;
    uint64_t end = left + found->count;
    if (found->count == 0) {
        return PCCD_OK;
    }
    assert(found->record_bytes == bytes);
    int status = eng_records_extend(records, end);
    if (status != PCCD_OK) {
        return status;
    }
    records->count = end;
    for (uint64_t i = found->count; i-- > 0;) {
        const unsigned char *record = found->data + i * bytes;
        struct eng_name name = eng_name_of(record, bytes);
        uint64_t at = place_among(records, left, &name);
        memmove(records->data + (at + i + 1) * bytes, records->data + at * bytes,
                (left - at) * bytes);
        memcpy(records->data + (at + i) * bytes, record, bytes);
        left = at;
    }
    return PCCD_OK;
}

void eng_answer_cache_finish(struct eng_answer_cache *cache,
                             const struct eng_scene *scene,
                             const struct eng_question *question,
                             const struct eng_step_result *result,
                             const struct eng_counts *counts,
                             const struct pccd_pair *proof)
{
    cache->is_valid = result->incomplete == PCCD_COMPLETE && !question->weigh &&
                      !eng_asks_touching(question);
    cache->number = scene->moving.number;
    cache->mode = question->mode;
    cache->tolerance = question->tolerance;
    cache->masks_version = scene->masks.version;
    cache->thickness = scene->thickness.number;
    cache->separation = question->distance;
    cache->approach = question->approach;
    cache->no_hash = question->no_hash;
    cache->count = result->count;
    cache->counts = *counts;
    cache->verdict = result->verdict;
    if (proof) {
        cache->proof = *proof;
    }
}

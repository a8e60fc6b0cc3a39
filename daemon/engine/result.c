/* daemon/engine/result.c - the records of a step: kept, sorted, hashed.
 *
 * Room:     engine.
 * Does:     sort indices by a 129-bit key (kind first, as two runs), then gather.
 * Threads:  one thread for one list.
 */
#include "result.h"

#include <assert.h>
#include <string.h>
#include <xxhash.h>

#include "memory.h"

static_assert(sizeof(struct eng_contact) == 64 && sizeof(struct eng_pair) == 20, "records");

void eng_records_begin(struct eng_records *records, uint32_t record_bytes, uint64_t limit)
{
    records->record_bytes = record_bytes;
    records->capacity = records->capacity_bytes / record_bytes;
    records->count = 0;
    records->limit = limit;
    records->overflowed = false;
}

void eng_records_deinit(struct eng_records *records)
{
    eng_free(records->data);
    memset(records, 0, sizeof *records);
}

/* Room for `capacity` records; the old ones are kept. */
static int reserve(struct eng_records *records, uint64_t capacity)
{
    if (capacity <= records->capacity) {
        return ENG_OK;
    }
    unsigned char *data = eng_realloc(records->data, capacity, records->record_bytes);
    if (!data) {
        return ENG_E_NOMEM;
    }
    records->data = data;
    records->capacity = capacity;
    records->capacity_bytes = capacity * records->record_bytes;
    return ENG_OK;
}

void *eng_records_add(struct eng_records *records)
{
    if (records->count == records->capacity) {
        uint64_t capacity = records->capacity ? records->capacity * 2 : 1024;
        if (records->count >= records->limit || reserve(records, capacity) != ENG_OK) {
            records->overflowed = true;
            return NULL;
        }
    }
    if (records->count >= records->limit) {
        records->overflowed = true;
        return NULL;
    }
    return records->data + records->count++ * records->record_bytes;
}

void eng_sorter_deinit(struct eng_sorter *sorter)
{
    eng_free(sorter->items);
    eng_free(sorter->spare);
    memset(sorter, 0, sizeof *sorter);
}

static int reserve_sorter(struct eng_sorter *sorter, uint64_t count)
{
    if (count <= sorter->capacity) {
        return ENG_OK;
    }
    uint64_t capacity = count + count / 2;
    struct eng_radix_item *items = eng_alloc(capacity, sizeof *items);
    struct eng_radix_item *spare = eng_alloc(capacity, sizeof *spare);
    if (!items || !spare) {
        eng_free(items);
        eng_free(spare);
        return ENG_E_NOMEM;
    }
    eng_sorter_deinit(sorter);
    sorter->items = items;
    sorter->spare = spare;
    sorter->capacity = capacity;
    return ENG_OK;
}

/* The five words of the order, wherever the record keeps them. */
static struct eng_pair key_of(const struct eng_records *records, uint64_t i)
{
    const unsigned char *record = records->data + i * records->record_bytes;
    struct eng_pair pair;
    if (records->record_bytes == sizeof pair) {
        memcpy(&pair, record, sizeof pair);
    } else {
        memcpy(&pair.kind, record + offsetof(struct eng_contact, kind), sizeof pair.kind);
        memcpy(&pair.object_a, record + offsetof(struct eng_contact, object_a),
               4 * sizeof pair.object_a);
    }
    return pair;
}

/* Where a record is, in the index of a sort item. */
#define LIST_SHIFT 48
#define RECORD_MASK ((UINT64_C(1) << LIST_SHIFT) - 1)

/* Append the keys of the records of one kind of one list. */
static size_t collect(struct eng_radix_item *items, size_t count,
                      const struct eng_records *list, uint64_t list_idx, uint32_t kind)
{
    for (uint64_t i = 0; i < list->count; i++) {
        struct eng_pair key = key_of(list, i);
        if (key.kind == kind) {
            struct eng_radix_item *item = &items[count++];
            item->hi = (uint64_t)key.object_a << 32 | key.feature_a;
            item->lo = (uint64_t)key.object_b << 32 | key.feature_b;
            item->index = list_idx << LIST_SHIFT | i;
        }
    }
    return count;
}

/* Sort the records of one kind behind out->count. */
static void sort_kind(struct eng_sorter *sorter, struct eng_records *const *lists,
                      uint32_t list_count, struct eng_records *out, uint32_t kind)
{
    size_t count = 0;
    for (uint32_t i = 0; i < list_count; i++) {
        count = collect(sorter->items, count, lists[i], i, kind);
    }
    const struct eng_radix_item *sorted =
        eng_radix_sort(sorter->items, sorter->spare, count);
    for (size_t i = 0; i < count; i++) {
        const struct eng_records *list = lists[sorted[i].index >> LIST_SHIFT];
        memcpy(out->data + (out->count + i) * out->record_bytes,
               list->data + (sorted[i].index & RECORD_MASK) * out->record_bytes,
               out->record_bytes);
    }
    out->count += count;
}

int eng_records_sort(struct eng_sorter *sorter, struct eng_records *const *lists,
                     uint32_t list_count, struct eng_records *out)
{
    uint64_t total = 0;
    bool overflowed = false;
    for (uint32_t i = 0; i < list_count; i++) {
        total += lists[i]->count;
        overflowed |= lists[i]->overflowed;
    }
    eng_records_begin(out, lists[0]->record_bytes, lists[0]->limit);
    int status = reserve_sorter(sorter, total);
    if (status == ENG_OK && total > out->capacity) {
        status = reserve(out, total + total / 2);
    }
    if (status != ENG_OK) {
        return status;
    }
    sort_kind(sorter, lists, list_count, out, ENG_VF);
    sort_kind(sorter, lists, list_count, out, ENG_EE);
    assert(out->count == total);
    out->overflowed = overflowed;
    return ENG_OK;
}

void eng_hash(const void *data, size_t bytes, uint64_t hash[2])
{
    XXH128_hash_t h = XXH3_128bits(data, bytes);
    hash[0] = h.high64;
    hash[1] = h.low64;
}

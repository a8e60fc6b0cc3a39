/* daemon/engine/result/result.c - the records of a step: kept, sorted, hashed.
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

static_assert(sizeof(struct eng_contact) == 64 && sizeof(struct eng_pair) == 20,
              "records");

void eng_found_begin(struct eng_found *found, struct eng_pool *pool,
                     uint32_t record_bytes, uint64_t limit)
{
    *found = (struct eng_found){.pool = pool,
                                .record_bytes = record_bytes,
                                .per_block = sizeof found->first->data / record_bytes,
                                .limit = limit};
}

/* The block that takes the next record, or NULL: no memory. */
static struct eng_block *open_block(struct eng_found *found)
{
    if (found->last && found->last->count < found->per_block) {
        return found->last;
    }
    struct eng_block *block = eng_pool_take(found->pool);
    if (!block) {
        return NULL;
    }
    if (found->last) {
        found->last->next = block;
    } else {
        found->first = block;
    }
    found->last = block;
    return block;
}

void *eng_found_add(struct eng_found *found)
{
    struct eng_block *block = found->count < found->limit ? open_block(found) : NULL;
    if (!block) {
        found->overflowed = true;
        return NULL;
    }
    found->count++;
    return block->data + (size_t)block->count++ * found->record_bytes;
}

void eng_records_deinit(struct eng_records *records)
{
    eng_free(records->data);
    memset(records, 0, sizeof *records);
}

static int reserve(struct eng_records *records, uint64_t count)
{
    if (count * records->record_bytes <= records->capacity_bytes) {
        return ENG_OK;
    }
    uint64_t capacity = count + count / 2;
    unsigned char *data = eng_alloc(capacity, records->record_bytes);
    if (!data) {
        return ENG_E_NOMEM;
    }
    eng_free(records->data);
    records->data = data;
    records->capacity_bytes = capacity * records->record_bytes;
    return ENG_OK;
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
static struct eng_pair key_of(const unsigned char *record, uint32_t record_bytes)
{
    struct eng_pair pair;
    if (record_bytes == sizeof pair) {
        memcpy(&pair, record, sizeof pair);
    } else {
        memcpy(&pair.kind, record + offsetof(struct eng_contact, kind), sizeof pair.kind);
        memcpy(&pair.object_a, record + offsetof(struct eng_contact, object_a),
               4 * sizeof pair.object_a);
    }
    return pair;
}

/* Append the keys of the records of one kind; an item's index is the record's address. */
static size_t collect(struct eng_radix_item *items, size_t count,
                      const struct eng_found *found, uint32_t kind)
{
    for (const struct eng_block *block = found->first; block; block = block->next) {
        for (uint32_t i = 0; i < block->count; i++) {
            const unsigned char *record = block->data + (size_t)i * found->record_bytes;
            struct eng_pair key = key_of(record, found->record_bytes);
            if (key.kind == kind) {
                struct eng_radix_item *item = &items[count++];
                item->hi = (uint64_t)key.object_a << 32 | key.feature_a;
                item->lo = (uint64_t)key.object_b << 32 | key.feature_b;
                item->index = (uintptr_t)record;
            }
        }
    }
    return count;
}

/* Sort the records of one kind behind out->count. */
static void sort_kind(struct eng_sorter *sorter, struct eng_found *const *lists,
                      uint32_t list_count, struct eng_records *out, uint32_t kind)
{
    size_t count = 0;
    for (uint32_t i = 0; i < list_count; i++) {
        count = collect(sorter->items, count, lists[i], kind);
    }
    const struct eng_radix_item *sorted =
        eng_radix_sort(sorter->items, sorter->spare, count);
    unsigned char *to = out->data + out->count * out->record_bytes;
    for (size_t i = 0; i < count; i++) {
        memcpy(to, (const void *)(uintptr_t)sorted[i].index, out->record_bytes);
        to += out->record_bytes;
    }
    out->count += count;
}

int eng_records_sort(struct eng_sorter *sorter, struct eng_found *const *lists,
                     uint32_t list_count, struct eng_records *out, bool *overflowed)
{
    uint64_t total = 0;
    *overflowed = false;
    for (uint32_t i = 0; i < list_count; i++) {
        total += lists[i]->count;
        *overflowed |= lists[i]->overflowed;
    }
    out->record_bytes = lists[0]->record_bytes;
    out->count = 0;
    if (total == 0) {
        return ENG_OK; /* out->data may be NULL, which has no places to write to */
    }
    int status = reserve_sorter(sorter, total);
    if (status == ENG_OK) {
        status = reserve(out, total);
    }
    if (status != ENG_OK) {
        return status;
    }
    sort_kind(sorter, lists, list_count, out, ENG_VF);
    sort_kind(sorter, lists, list_count, out, ENG_EE);
    assert(out->count == total);
    if (out->count > lists[0]->limit) {
        out->count = lists[0]->limit;
        *overflowed = true;
    }
    return ENG_OK;
}

void eng_hash(const void *data, size_t bytes, uint64_t hash[2])
{
    XXH128_hash_t h = XXH3_128bits(data, bytes);
    hash[0] = h.high64;
    hash[1] = h.low64;
}

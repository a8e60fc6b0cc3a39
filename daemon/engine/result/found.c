/* found.c - the records of a step as they are found, and the memory that they are in. */
#include "result.h"

#include <assert.h>
#include <stdbool.h>
#include <stddef.h>
#include <string.h>

#include "memory.h"
#include "merge.h"
#include "pccd_types.h"

/* ---- blocks ------------------------------------------------------------------------ */

void eng_pool_init(struct eng_pool *pool)
{
    pool->blocks = pool->lent = NULL;
    pool->capacity = pool->lent_count = 0;
    atomic_init(&pool->taken, 0);
    atomic_init(&pool->spilled, NULL);
}

static void free_spilled(struct eng_pool *pool)
{
    struct eng_block *block = atomic_load_explicit(&pool->spilled, memory_order_relaxed);
    while (block) {
        struct eng_block *next = block->spill_next;
        eng_free(block);
        block = next;
    }
    atomic_store_explicit(&pool->spilled, NULL, memory_order_relaxed);
}

void eng_pool_deinit(struct eng_pool *pool)
{
    free_spilled(pool);
    eng_free(pool->blocks);
    eng_pool_init(pool);
}

void eng_pool_reset(struct eng_pool *pool, uint32_t workers)
{
    assert(workers >= 1);
    uint32_t taken = atomic_load_explicit(&pool->taken, memory_order_relaxed);
    taken = taken > pool->lent_count ? taken - pool->lent_count : 0;
    free_spilled(pool);
    if (taken > pool->capacity || pool->capacity < workers) {
        uint32_t capacity = taken + taken / 4 + 2 * workers;
        struct eng_block *blocks = eng_alloc(capacity, sizeof *blocks);
        if (blocks) {
            eng_free(pool->blocks);
            pool->blocks = blocks;
            pool->capacity = capacity;
        }
    }
    atomic_store_explicit(&pool->taken, 0, memory_order_relaxed);
}

void eng_pool_lend(struct eng_pool *pool, void *memory, uint64_t bytes)
{
    assert(atomic_load_explicit(&pool->taken, memory_order_relaxed) == 0);
    assert((uintptr_t)memory % ENG_BLOCK_HEADER_BYTES == 0);
    uint64_t count = memory ? bytes / sizeof *pool->lent : 0;
    pool->lent = memory;
    pool->lent_count = count < UINT32_MAX / 2 ? (uint32_t)count : UINT32_MAX / 2;
}

/* A block that the pool did not foresee. */
static struct eng_block *spill(struct eng_pool *pool)
{
    struct eng_block *block = eng_alloc(1, sizeof *block);
    if (!block) {
        return NULL;
    }
    block->spill_next = atomic_load_explicit(&pool->spilled, memory_order_relaxed);
    /* Release: whoever walks the list after the region sees the link. */
    while (!atomic_compare_exchange_weak_explicit(&pool->spilled, &block->spill_next,
                                                  block, memory_order_release,
                                                  memory_order_relaxed)) {
    }
    return block;
}

struct eng_block *eng_pool_take(struct eng_pool *pool)
{
    /* Relaxed: each number is handed out once; the block is nobody else's. */
    uint32_t i = atomic_fetch_add_explicit(&pool->taken, 1, memory_order_relaxed);
    bool is_lent = i < pool->lent_count;
    uint32_t own = i - pool->lent_count; /* if it is not */
    struct eng_block *block = is_lent                ? &pool->lent[i]
                              : own < pool->capacity ? &pool->blocks[own]
                                                     : spill(pool);
    if (block) {
        block->next = NULL;
        block->count = 0;
    }
    return block;
}

uint64_t eng_pool_bytes(const struct eng_pool *pool)
{
    return (uint64_t)pool->capacity * sizeof *pool->blocks;
}

/* ---- records as they are found ----------------------------------------------------- */

static_assert(sizeof(struct pccd_contact) == 64 && sizeof(struct pccd_pair) == 20,
              "records");

void eng_found_begin(struct eng_found *found, struct eng_pool *pool,
                     uint32_t record_bytes, uint64_t limit)
{
    assert(record_bytes == sizeof(struct pccd_contact) ||
           record_bytes == sizeof(struct pccd_pair));
    *found = (struct eng_found){.pool = pool,
                                .record_bytes = record_bytes,
                                .per_block = sizeof found->first->data / record_bytes,
                                .limit = limit};
    eng_name_range_init(&found->range);
}

bool eng_found_expect(struct eng_found *found, const struct eng_name_range *range)
{
    assert(found->count == 0 && !found->first);
    struct eng_order order;
    eng_order_set(&order, range);
    found->has_keys = order.words == 1;
    if (found->has_keys) {
        found->range = *range;
        found->order = order;
        size_t bytes = found->record_bytes + sizeof(uint64_t);
        found->per_block = (uint32_t)(sizeof found->first->data / bytes);
        found->per_block -= found->per_block % 2; /* keys begin at 8 bytes */
    }
    return found->has_keys;
}

/* The block that takes the next record, or NULL: no memory. */
static struct eng_block *open_block(struct eng_found *found)
{
    if (found->last && found->last->count < found->per_block) {
        return found->last;
    }
    struct eng_block *block = found->last ? found->last->next : NULL;
    if (block) { /* a cut has emptied it */
        found->last = block;
        return block;
    }
    block = eng_pool_take(found->pool);
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

/* Fill the blocks with `count` records from `sorted`, >= 1; the rest of them is empty. */
static void refill(struct eng_found *found, const unsigned char *sorted, uint64_t count)
{
    uint64_t left = count;
    for (struct eng_block *block = found->first; block; block = block->next) {
        block->count = left < found->per_block ? (uint32_t)left : found->per_block;
        memcpy(block->data, sorted, (size_t)block->count * found->record_bytes);
        for (uint32_t i = 0; i < block->count && found->has_keys; i++) {
            eng_found_keys(found, block)[i] =
                eng_order_key_of(&found->order, sorted + (size_t)i * found->record_bytes,
                                 found->record_bytes);
        }
        sorted += (size_t)block->count * found->record_bytes;
        left -= block->count;
        if (block->count > 0) {
            found->last = block;
        }
    }
    found->count = count;
}

/* times[count] is a heap, the latest on top. */
static void push_time(double *times, uint64_t count, double time)
{
    uint64_t at = count;
    for (; at > 0 && times[(at - 1) / 2] < time; at = (at - 1) / 2) {
        times[at] = times[(at - 1) / 2];
    }
    times[at] = time;
}

/* `time` in the place of the latest. */
static void replace_latest(double *times, uint64_t count, double time)
{
    uint64_t at = 0;
    for (uint64_t below = 1; below < count; below = 2 * at + 1) {
        below += below + 1 < count && times[below + 1] > times[below];
        if (times[below] <= time) {
            break;
        }
        times[at] = times[below];
        at = below;
    }
    times[at] = time;
}

/* Keep those contacts in order that may be among the first `limit` of all up to some
 * time, and one more, so that it shows that there were more: those that are not preceded
 * by so many that are as early. Returns how many; they come first. PCCD_E_NOMEM: < 0. */
static int64_t keep_early(struct eng_records *sorted, uint64_t limit)
{
    struct pccd_contact *contacts = (void *)sorted->data;
    uint64_t most = limit + 1;
    uint64_t heap = 0;
    int64_t kept = 0;
    double *times = eng_alloc(most, sizeof *times);
    if (!times) {
        return PCCD_E_NOMEM;
    }
    for (uint64_t i = 0; i < sorted->count; i++) {
        if (heap < most) {
            push_time(times, heap++, contacts[i].toi);
        } else if (contacts[i].toi < times[0]) {
            replace_latest(times, heap, contacts[i].toi);
        } else {
            continue;
        }
        contacts[kept++] = contacts[i];
    }
    eng_free(times);
    return kept;
}

/* Fold the records, if that is to be, and keep the first `limit` in order, or of the
 * earliest those that may be. PCCD_E_NOMEM: all stay. */
static int cut(struct eng_found *found)
{
    struct eng_found *const lists[1] = {found};
    struct eng_records sorted = {0};
    struct eng_merge merge;
    struct eng_counts counts;
    const uint64_t limit = found->limit;
    eng_merge_init(&merge);
    found->limit = found->is_of_earliest ? UINT64_MAX : limit;
    int status = eng_merge_begin(&merge, lists, 1, &sorted);
    if (status == PCCD_OK) {
        status = eng_merge_end(&merge, &counts);
    }
    found->limit = limit;
    if (status == PCCD_OK && found->is_of_earliest) {
        int64_t kept = keep_early(&sorted, limit);
        status = kept < 0 ? PCCD_E_NOMEM : PCCD_OK;
        sorted.count = kept < 0 ? sorted.count : (uint64_t)kept;
        found->most = sorted.count + sorted.count / 4 + found->per_block;
    }
    if (status == PCCD_OK) {
        refill(found, sorted.data, sorted.count);
    }
    if (status == PCCD_OK && merge.is_cut) {
        const unsigned char *end = sorted.data + sorted.count * found->record_bytes;
        found->cut_at = eng_name_of(end - found->record_bytes, found->record_bytes);
        found->is_cut = true;
        found->overflowed = true;
    }
    eng_records_deinit(&sorted);
    eng_merge_deinit(&merge);
    return status;
}

/* Return how many a list may have before it is cut: a quarter more than its limit and one
 * block, so that cutting costs each record little. */
static uint64_t most_of(const struct eng_found *found)
{
    uint64_t most = found->limit + found->limit / 4 + found->per_block;
    return found->most > most ? found->most : most;
}

/* Return whether a record of that name is kept. */
static bool has_room(struct eng_found *found, const struct eng_name *name)
{
    bool is_full = found->count >= most_of(found);
    if (found->limit == 0 || (is_full && cut(found) != PCCD_OK)) {
        return false;
    }
    /* One more of the last name adds to its count. */
    return !found->is_cut || eng_name_compare(name, &found->cut_at) < found->folds;
}

void *eng_found_add(struct eng_found *found, const struct pccd_pair *name)
{
    struct eng_name words;
    memcpy(&words, name, sizeof words);
    struct eng_block *block = has_room(found, &words) ? open_block(found) : NULL;
    if (!block) {
        found->overflowed = true;
        return NULL;
    }
    if (found->has_keys) {
        eng_found_keys(found, block)[block->count] = eng_order_key(&found->order, &words);
    } else {
        eng_name_range_add(&found->range, &words);
    }
    found->count++;
    unsigned char *record = block->data + (size_t)block->count++ * found->record_bytes;
    eng_name_write(&words, record, found->record_bytes);
    return record;
}

uint32_t eng_found_open(struct eng_found *found, uint32_t count, void **slots,
                        uint64_t **keys)
{
    assert(count >= 1);
    uint64_t most = most_of(found);
    if (found->limit == 0 || found->is_cut || found->count >= most) {
        return 0;
    }
    struct eng_block *block = open_block(found);
    if (!block) {
        return 0;
    }
    uint32_t room = found->per_block - block->count;
    room = most - found->count < room ? (uint32_t)(most - found->count) : room;
    *slots = block->data + (size_t)block->count * found->record_bytes;
    if (found->has_keys) {
        *keys = eng_found_keys(found, block) + block->count;
    }
    return count < room ? count : room;
}

void eng_found_close(struct eng_found *found, uint32_t count)
{
    assert(count <= found->per_block - found->last->count);
    found->last->count += count;
    found->count += count;
}

void eng_found_keep(struct eng_found *found, uint64_t count)
{
    uint64_t left = count;
    if (found->count <= count) {
        return;
    }
    for (struct eng_block *block = found->first; block; block = block->next) {
        block->count = left < block->count ? (uint32_t)left : block->count;
        left -= block->count;
        if (block->count > 0) {
            found->last = block;
        }
    }
    found->count = count;
}

/* ---- the memory of an answer ------------------------------------------------------- */

void eng_records_deinit(struct eng_records *records)
{
    eng_free(records->data);
    memset(records, 0, sizeof *records);
}

int eng_records_reserve(struct eng_records *records, uint64_t count)
{
    assert(records->record_bytes > 0);
    if (count * records->record_bytes <= records->capacity_bytes) {
        return PCCD_OK;
    }
    uint64_t capacity = count + count / 2;
    unsigned char *data = eng_alloc(capacity, records->record_bytes);
    if (!data) {
        return PCCD_E_NOMEM;
    }
    eng_free(records->data);
    records->data = data;
    records->capacity_bytes = capacity * records->record_bytes;
    return PCCD_OK;
}

int eng_records_extend(struct eng_records *records, uint64_t count)
{
    assert(records->record_bytes > 0);
    if (count * records->record_bytes <= records->capacity_bytes) {
        return PCCD_OK;
    }
    uint64_t capacity = count + count / 2;
    unsigned char *data = eng_realloc(records->data, capacity, records->record_bytes);
    if (!data) {
        return PCCD_E_NOMEM;
    }
    records->data = data;
    records->capacity_bytes = capacity * records->record_bytes;
    return PCCD_OK;
}

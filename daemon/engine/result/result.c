/* daemon/engine/result/result.c - the records of a step, as they are found.
 *
 * Room:     engine.
 * Does:     fill blocks; grow the memory of the answer.
 * Threads:  one thread for one list.
 */
#include "result.h"

#include <assert.h>
#include <string.h>

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
    eng_name_range_init(&found->range);
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

void *eng_found_add(struct eng_found *found, const struct eng_pair *name)
{
    struct eng_block *block = found->count < found->limit ? open_block(found) : NULL;
    if (!block) {
        found->overflowed = true;
        return NULL;
    }
    struct eng_name words;
    memcpy(&words, name, sizeof words);
    eng_name_range_add(&found->range, &words);
    found->count++;
    unsigned char *record = block->data + (size_t)block->count++ * found->record_bytes;
    eng_name_write(&words, record, found->record_bytes);
    return record;
}

void eng_records_deinit(struct eng_records *records)
{
    eng_free(records->data);
    memset(records, 0, sizeof *records);
}

int eng_records_reserve(struct eng_records *records, uint64_t count)
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

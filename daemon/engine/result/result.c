/* result.c - the memory of an answer. */
#include "result.h"

#include <assert.h>
#include <string.h>

#include "memory.h"
#include "pccd_types.h"

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

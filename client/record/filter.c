/* filter.c - the attributes of an object, as FILTER has them. */
#include "filter.h"

#include <assert.h>
#include <stddef.h>
#include <string.h>

void record_filter_make(struct record_filter *filter, uint32_t scene, uint32_t object,
                        uint32_t what, const struct common_attributes *given)
{
    *filter = (struct record_filter){.scene = scene,
                                     .object = object,
                                     .what = COMMON_OBJECT_BITS(what),
                                     .self = given->self_collision};
    common_attributes_pack(given, filter->words);
}

void record_filter_read(const void *payload, uint64_t bytes, struct record_filter *filter,
                        struct common_attributes *given)
{
    uint64_t read = bytes < sizeof *filter ? bytes : sizeof *filter;
    uint64_t count = (read - offsetof(struct record_filter, words)) / sizeof(uint64_t);

    assert(bytes >= RECORD_FILTER_BYTES);
    *filter = (struct record_filter){.what = 0};
    memcpy(filter, payload, read);
    if (count == COMMON_WORD_SELF) { /* of before */
        filter->words[count++] = filter->self;
    }
    *given = (struct common_attributes)COMMON_ATTRIBUTES_AT_FIRST;
    common_attributes_unpack(given, filter->words, count);
}

/* array.c - arrays that grow. */
#include "array.h"

#include <assert.h>
#include <string.h>

#include "memory.h"

uint32_t eng_array_grown(uint32_t capacity, uint32_t end)
{
    uint64_t more = (uint64_t)capacity + capacity / 8;
    return more > UINT32_MAX || more < end ? end : (uint32_t)more;
}

int eng_array_grow(void *array, uint32_t capacity, size_t bytes)
{
    assert(array && bytes > 0);
    /* Pointers to different types may not be accessed as void *; their bytes may. */
    void *block;
    memcpy(&block, array, sizeof block);
    block = eng_realloc(block, capacity, bytes);
    if (!block) {
        return PCCD_E_NOMEM;
    }
    memcpy(array, &block, sizeof block);
    return PCCD_OK;
}

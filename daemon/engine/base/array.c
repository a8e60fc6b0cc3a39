/* array.c - arrays that grow. A file of its own: tests bring another memory.c. */
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

int eng_array_fit(void *array, uint32_t *capacity, uint32_t count, size_t bytes)
{
    if (count <= *capacity) {
        return PCCD_OK;
    }
    int status = eng_array_grow(array, count, bytes);
    *capacity = status == PCCD_OK ? count : *capacity;
    return status;
}

int eng_array_extend(void *array, uint32_t *capacity, uint32_t count, size_t bytes)
{
    return count <= *capacity
               ? PCCD_OK
               : eng_array_fit(array, capacity, eng_array_grown(*capacity, count), bytes);
}

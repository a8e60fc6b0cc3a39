/* handles.c - numbers that stand for things, safe against reuse. */
#include "handles.h"

#include <stdbool.h>
#include <string.h>

#include "invariant.h"
#include "pccd_types.h"

#define NO_INDEX       UINT32_MAX
#define CAPACITY_FIRST 16u

void srv_handles_init(struct srv_handles *handles, uint32_t max,
                      uint32_t generation_first)
{
    PCCD_ASSERT(max >= 1 && max <= SRV_HANDLE_INDEX_MAX + 1u);
    *handles = (struct srv_handles){
        .max = max,
        .free_first = NO_INDEX,
        .free_last = NO_INDEX,
        .generation_first = generation_first % SRV_HANDLE_GENERATION_MAX + 1u,
    };
}

struct srv_handle_slot *srv_handles_deinit(struct srv_handles *handles)
{
    struct srv_handle_slot *slots = handles->slots;
    *handles = (struct srv_handles){.free_first = NO_INDEX, .free_last = NO_INDEX};
    return slots;
}

/* Return whether a handle can lead to a place of the table. */
static bool is_possible(const struct srv_handles *handles, uint32_t want)
{
    return want >> SRV_HANDLE_INDEX_BITS != 0 && srv_handle_index(want) < handles->max;
}

uint32_t srv_handles_needs(const struct srv_handles *handles, uint32_t want)
{
    uint32_t count = want == 0 ? handles->used + (handles->free_first == NO_INDEX)
                     : is_possible(handles, want) ? srv_handle_index(want) + 1
                                                  : 0;
    if (count <= handles->capacity || count > handles->max) {
        return 0;
    }
    uint32_t capacity = handles->capacity == 0 ? CAPACITY_FIRST : handles->capacity * 2;
    while (capacity < count) { /* ends: an index has 20 bits */
        capacity *= 2;
    }
    return capacity < handles->max ? capacity : handles->max;
}

struct srv_handle_slot *srv_handles_move(struct srv_handles *handles,
                                         struct srv_handle_slot *slots, uint32_t capacity)
{
    struct srv_handle_slot *before = handles->slots;
    PCCD_ASSERT(capacity > handles->capacity && capacity <= handles->max);
    if (handles->used > 0) {
        memcpy(slots, before, handles->used * sizeof *slots);
    }
    handles->slots = slots;
    handles->capacity = capacity;
    return before;
}

void *srv_handles_get(const struct srv_handles *handles, uint32_t handle)
{
    uint32_t index = srv_handle_index(handle);
    if (index >= handles->used ||
        handles->slots[index].generation != handle >> SRV_HANDLE_INDEX_BITS) {
        return NULL;
    }
    return handles->slots[index].item; /* NULL while the slot is free */
}

/* Put an empty slot at the end of the free list. */
static void append_free(struct srv_handles *handles, uint32_t index)
{
    struct srv_handle_slot *slot = &handles->slots[index];
    slot->item = NULL;
    slot->free_before = handles->free_last;
    slot->free_behind = NO_INDEX;
    if (handles->free_last == NO_INDEX) {
        handles->free_first = index;
    } else {
        handles->slots[handles->free_last].free_behind = index;
    }
    handles->free_last = index;
}

/* Take a slot that is in the free list out of it. */
static void unlink_free(struct srv_handles *handles, uint32_t index)
{
    const struct srv_handle_slot *slot = &handles->slots[index];
    if (slot->free_before == NO_INDEX) {
        handles->free_first = slot->free_behind;
    } else {
        handles->slots[slot->free_before].free_behind = slot->free_behind;
    }
    if (slot->free_behind == NO_INDEX) {
        handles->free_last = slot->free_before;
    } else {
        handles->slots[slot->free_behind].free_before = slot->free_before;
    }
}

/* A place that is in use for the first time; those before it that were not are free. */
static void use_new(struct srv_handles *handles, uint32_t index)
{
    PCCD_ASSERT(index < handles->capacity);
    for (; handles->used <= index; handles->used++) {
        handles->slots[handles->used].generation = handles->generation_first;
        if (handles->used < index) {
            append_free(handles, handles->used);
        }
    }
}

int srv_handles_add(struct srv_handles *handles, void *item, uint32_t want,
                    uint32_t *handle)
{
    uint32_t index = want != 0                         ? srv_handle_index(want)
                     : handles->free_first != NO_INDEX ? handles->free_first
                                                       : handles->used;
    PCCD_ASSERT(item != NULL);
    if (want == 0 && handles->count >= handles->max) {
        return PCCD_E_LIMIT;
    }
    if (want != 0 && (!is_possible(handles, want) ||
                      (index < handles->used && handles->slots[index].item != NULL))) {
        return PCCD_E_HANDLE;
    }
    if (index < handles->used) {
        unlink_free(handles, index);
    } else {
        use_new(handles, index);
    }
    handles->slots[index].item = item;
    if (want != 0) {
        handles->slots[index].generation = want >> SRV_HANDLE_INDEX_BITS;
    }
    handles->count++;
    *handle = srv_handles_at(handles, index);
    return 0;
}

/* Take the item out of a used slot and put the slot at the end of the free list. */
static void *vacate(struct srv_handles *handles, uint32_t index)
{
    struct srv_handle_slot *slot = &handles->slots[index];
    void *item = slot->item;
    PCCD_ASSERT(item != NULL && handles->count > 0);
    slot->generation = slot->generation % SRV_HANDLE_GENERATION_MAX + 1u;
    append_free(handles, index);
    handles->count--;
    return item;
}

void *srv_handles_remove(struct srv_handles *handles, uint32_t handle)
{
    if (srv_handles_get(handles, handle) == NULL) {
        return NULL;
    }
    return vacate(handles, srv_handle_index(handle));
}

uint32_t srv_handles_at(const struct srv_handles *handles, uint32_t index)
{
    PCCD_ASSERT(index < handles->used && handles->slots[index].item != NULL);
    return handles->slots[index].generation << SRV_HANDLE_INDEX_BITS | index;
}

void *srv_handles_next(const struct srv_handles *handles, uint32_t *cursor)
{
    while (*cursor < handles->used) {
        uint32_t index = (*cursor)++;
        if (handles->slots[index].item != NULL) {
            return handles->slots[index].item;
        }
    }
    return NULL;
}

void *srv_handles_pop(struct srv_handles *handles, uint32_t *cursor)
{
    while (*cursor < handles->used) {
        uint32_t index = (*cursor)++;
        if (handles->slots[index].item != NULL) {
            return vacate(handles, index);
        }
    }
    return NULL;
}

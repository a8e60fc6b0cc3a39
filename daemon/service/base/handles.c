/* handles.c - numbers that stand for things, safe against reuse.
 *
 * Room:     service. See handles.h.
 * Does:     a growing array of slots with a first-in first-out list of free ones in it.
 * Does not: shrink: a session's tables go with the session.
 * Threads:  one at a time.
 */
#include "handles.h"

#include <stdlib.h>

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

void srv_handles_deinit(struct srv_handles *handles)
{
    free(handles->slots);
    *handles = (struct srv_handles){.free_first = NO_INDEX, .free_last = NO_INDEX};
}

/* Room for at least `count` slots, of which there are at most `max`. */
static int grow(struct srv_handles *handles, uint32_t count)
{
    uint32_t capacity = handles->capacity == 0 ? CAPACITY_FIRST : handles->capacity * 2;
    while (capacity < count) { /* ends: an index has 20 bits */
        capacity *= 2;
    }
    if (capacity > handles->max) {
        capacity = handles->max;
    }
    PCCD_ASSERT(capacity >= count);
    struct srv_handle_slot *slots =
        realloc(handles->slots, (size_t)capacity * sizeof *slots);
    if (slots == NULL) {
        return PCCD_E_NOMEM;
    }
    handles->slots = slots;
    handles->capacity = capacity;
    return 0;
}

int srv_handles_add(struct srv_handles *handles, void *item, uint32_t *handle)
{
    PCCD_ASSERT(item != NULL);
    if (handles->count >= handles->max) {
        return PCCD_E_LIMIT;
    }
    uint32_t index = handles->free_first;
    if (index != NO_INDEX) {
        handles->free_first = handles->slots[index].next_free;
        if (handles->free_first == NO_INDEX) {
            handles->free_last = NO_INDEX;
        }
    } else {
        if (handles->used == handles->capacity && grow(handles, handles->used + 1) != 0) {
            return PCCD_E_NOMEM;
        }
        index = handles->used++;
        handles->slots[index].generation = handles->generation_first;
    }
    handles->slots[index].item = item;
    handles->slots[index].next_free = NO_INDEX;
    handles->count++;
    *handle = handles->slots[index].generation << SRV_HANDLE_INDEX_BITS | index;
    return 0;
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
    handles->slots[index].item = NULL;
    handles->slots[index].next_free = NO_INDEX;
    if (handles->free_last == NO_INDEX) {
        handles->free_first = index;
    } else {
        handles->slots[handles->free_last].next_free = index;
    }
    handles->free_last = index;
}

/* Take a slot that is in the free list out of it. */
static void unlink_free(struct srv_handles *handles, uint32_t index)
{
    uint32_t before = NO_INDEX;
    for (uint32_t at = handles->free_first; at != index;
         at = handles->slots[at].next_free) {
        PCCD_ASSERT(at != NO_INDEX);
        before = at;
    }
    uint32_t next = handles->slots[index].next_free;
    if (before == NO_INDEX) {
        handles->free_first = next;
    } else {
        handles->slots[before].next_free = next;
    }
    if (handles->free_last == index) {
        handles->free_last = before;
    }
}

int srv_handles_add_at(struct srv_handles *handles, void *item, uint32_t handle,
                       uint32_t skip_max, uint32_t *skipped)
{
    uint32_t index = srv_handle_index(handle);
    uint32_t generation = handle >> SRV_HANDLE_INDEX_BITS;
    PCCD_ASSERT(item != NULL);
    *skipped = 0;
    if (generation == 0 || index >= handles->max ||
        (index < handles->used && handles->slots[index].item != NULL)) {
        return PCCD_E_HANDLE;
    }
    if (index < handles->used) {
        unlink_free(handles, index);
    } else {
        if (index - handles->used > skip_max) {
            return PCCD_E_LIMIT;
        }
        if (index >= handles->capacity && grow(handles, index + 1) != 0) {
            return PCCD_E_NOMEM;
        }
        for (; handles->used < index; handles->used++, (*skipped)++) {
            handles->slots[handles->used].generation = handles->generation_first;
            append_free(handles, handles->used);
        }
        handles->used++;
    }
    handles->slots[index] = (struct srv_handle_slot){
        .item = item, .generation = generation, .next_free = NO_INDEX};
    handles->count++;
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

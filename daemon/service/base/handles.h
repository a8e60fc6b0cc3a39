/* handles.h - handles: the 32-bit numbers by which clients name their scenes, meshes and
 * objects.
 *
 * Map u32 handles to pointers: index in the low 20 bits, generation (1 .. 4095) in the
 * high 12. A handle is never 0; a removed one stays unknown until its index has been
 * reused 4095 times.
 *
 * Threads: one at a time.
 */
#ifndef SRV_HANDLES_H
#define SRV_HANDLES_H

#include <stdint.h>

#define SRV_HANDLE_INDEX_BITS     20u
#define SRV_HANDLE_INDEX_MAX      ((1u << SRV_HANDLE_INDEX_BITS) - 1u)
#define SRV_HANDLE_GENERATION_MAX 4095u

/* `generation_first` of what a session makes; of objects it is small. So a handle of one
 * kind is none of another, and an argument in the wrong place is told. */
#define SRV_SCENES_GENERATION 0x1ffu
#define SRV_MESHES_GENERATION 0x3ffu

struct srv_handle_slot {
    void *item;           /* NULL: free */
    uint32_t generation;  /* of the item here, or of the next one */
    uint32_t free_before; /* indices, when free */
    uint32_t free_behind;
};

struct srv_handles {
    struct srv_handle_slot *slots;
    uint32_t capacity;   /* slots that there are */
    uint32_t used;       /* slots ever used: [0, used) are initialised */
    uint32_t max;        /* items at most */
    uint32_t count;      /* items now */
    uint32_t free_first; /* oldest free index: indices are reused in turn, so that */
    uint32_t free_last;  /* generations last as long as they can */
    uint32_t generation_first; /* of every index */
};

static inline uint32_t srv_handle_index(uint32_t handle)
{
    return handle & SRV_HANDLE_INDEX_MAX;
}

/* Make an empty table. `max` 1 .. 2^20. Tables whose `generation_first` (reduced to 1 ..
 * 4095) differ do not share handles until an index has been reused often. */
void srv_handles_init(struct srv_handles *handles, uint32_t max,
                      uint32_t generation_first);
/* Empty it for good; returns its slots, which are the caller's again. */
struct srv_handle_slot *srv_handles_deinit(struct srv_handles *handles);

/* Return how many slots it needs before an item can be added, with the handle `want` or,
 * 0, with any. No more than `capacity`: it has them. */
uint32_t srv_handles_needs(const struct srv_handles *handles, uint32_t want);
/* Give it so many slots, more than it has. Returns those that it had, the caller's to
 * free. */
struct srv_handle_slot *srv_handles_move(struct srv_handles *handles,
                                         struct srv_handle_slot *slots,
                                         uint32_t capacity);

/* Make a handle for `item` (not NULL): `want`, or, 0, any. It has the slots that it
 * needs. Returns 0, PCCD_E_LIMIT (`max` are in use) or PCCD_E_HANDLE (the place of `want`
 * is in use, or no handle is like that). */
int srv_handles_add(struct srv_handles *handles, void *item, uint32_t want,
                    uint32_t *handle);

/* Return the item, or NULL for an unknown or stale handle. */
void *srv_handles_get(const struct srv_handles *handles, uint32_t handle);

/* Forget a handle and return its item, or NULL for an unknown or stale one. */
void *srv_handles_remove(struct srv_handles *handles, uint32_t handle);

/* Return the handle of the item at an index that is in use. */
uint32_t srv_handles_at(const struct srv_handles *handles, uint32_t index);

/* Return the items in the order of their indices; NULL after the last. `*cursor` starts
 * at 0. */
void *srv_handles_next(const struct srv_handles *handles, uint32_t *cursor);

/* Forget and return any item, the one of the lowest index; NULL when empty. `*cursor`
 * starts at 0 and makes a run over all of them linear. */
void *srv_handles_pop(struct srv_handles *handles, uint32_t *cursor);

#endif

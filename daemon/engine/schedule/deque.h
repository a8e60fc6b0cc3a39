/* daemon/engine/schedule/deque.h - a bounded work-stealing deque.
 *
 * Room:     engine. May include: the C library.
 * Does:     the owner pushes and pops tasks at the bottom, anyone takes them from the
 *           top: the owner works depth first on what is in its cache, a thief gets the
 *           oldest, which is the largest.
 * Threads:  push and pop: the owner, or one thread while the owner waits; steal: any
 *           thread of the team.
 * Source:   Chase and Lev 2005; the C11 form of Le, Pop, Cohen and Zappa Nardelli 2013,
 *           with sequentially consistent accesses in place of its fences (tasks are
 *           coarse, and thread sanitizers do not model fences).
 */
#ifndef ENG_DEQUE_H
#define ENG_DEQUE_H

#include <stdatomic.h>
#include <stdbool.h>
#include <stdint.h>

/* Capacity, a power of two. */
#define ENG_DEQUE_MAX 1024u

struct eng_deque {
    _Alignas(128) atomic_int_fast64_t top;    /* next to be stolen; only grows */
    _Alignas(128) atomic_int_fast64_t bottom; /* next free place; owner's */
    _Alignas(128) atomic_uint_fast64_t tasks[ENG_DEQUE_MAX];
};

void eng_deque_init(struct eng_deque *deque);

/* False: full. */
bool eng_deque_push(struct eng_deque *deque, uint64_t task);

/* The newest task; false: empty. */
bool eng_deque_pop(struct eng_deque *deque, uint64_t *task);

/* Is there a task to be stolen? A hint that writes nothing. [any] */
static inline bool eng_deque_has_task(struct eng_deque *deque)
{
    return atomic_load_explicit(&deque->top, memory_order_relaxed) <
           atomic_load_explicit(&deque->bottom, memory_order_relaxed);
}

/* The oldest task; false: empty, or another thread was faster. */
bool eng_deque_steal(struct eng_deque *deque, uint64_t *task);

#endif

/* deque.h - a queue of tasks from which idle threads steal.
 *
 * Let the owner push and pop tasks at the bottom, and anyone take them from the top. The
 * owner works depth first on what is in its cache; a thief gets the oldest task, which is
 * the largest.
 *
 * Threads: push and pop: the owner, or one thread while the owner waits; steal: any
 * thread of the team.
 * Source: Chase and Lev 2005; the C11 form of Le, Pop, Cohen and Zappa Nardelli 2013,
 * with sequentially consistent accesses in place of its fences (tasks are coarse, and
 * thread sanitizers do not model fences).
 */
#ifndef ENG_DEQUE_H
#define ENG_DEQUE_H

#include <stdatomic.h>
#include <stdbool.h>
#include <stdint.h>

/* Capacity, a power of two: twice the tasks that a method has waiting. Those of wide are
 * most, a block's pairs of each kind. */
#define ENG_DEQUE_MAX 4096u

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

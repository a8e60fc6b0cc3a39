/* deque.h - work that threads share: a queue of tasks from which idle threads steal, and
 * the parts of a loop.
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

/* Push a task. False: the deque is full. */
bool eng_deque_push(struct eng_deque *deque, uint64_t task);

/* Pop the newest task; false: there is none. */
bool eng_deque_pop(struct eng_deque *deque, uint64_t *task);

/* Return whether there is a task to be stolen. A hint that writes nothing. [any] */
static inline bool eng_deque_has_task(struct eng_deque *deque)
{
    return atomic_load_explicit(&deque->top, memory_order_relaxed) <
           atomic_load_explicit(&deque->bottom, memory_order_relaxed);
}

/* Steal the oldest task; false: there is none, or another thread was faster. */
bool eng_deque_steal(struct eng_deque *deque, uint64_t *task);

/* ---- a loop in equal parts --------------------------------------------------------- */

/* Items 0 .. count - 1 in one run for each thread of a team. A thread takes its own run
 * first, then what others have left. So it finds in its cache what it wrote a step
 * before, and threads compete for a counter only at the end. */
struct eng_partition {
    _Alignas(128) atomic_uint next; /* that nobody has taken */
    uint32_t end;
};

/* Return where the run of thread `i` of `threads` begins; i = threads: where all end. */
static inline uint32_t eng_partition_begin(uint32_t count, uint32_t i, uint32_t threads)
{
    return (uint32_t)((uint64_t)count * i / threads);
}

/* Return whose run item `i` is in, give or take one. */
static inline uint32_t eng_partition_of(uint32_t count, uint32_t i, uint32_t threads)
{
    return (uint32_t)((uint64_t)i * threads / count);
}

/* Give a thread its run, before the region. [compute] */
static inline void eng_partition_init(struct eng_partition *share, uint32_t count,
                                      uint32_t i, uint32_t threads)
{
    atomic_init(&share->next, eng_partition_begin(count, i, threads));
    share->end = eng_partition_begin(count, i + 1, threads);
}

/* Take an item of a run; false: nothing is left. Relaxed: what is taken was made before
 * the region. [team] */
static inline bool eng_partition_take(struct eng_partition *share, uint32_t *item)
{
    if (atomic_load_explicit(&share->next, memory_order_relaxed) >= share->end) {
        return false;
    }
    *item = atomic_fetch_add_explicit(&share->next, 1, memory_order_relaxed);
    return *item < share->end;
}

#endif

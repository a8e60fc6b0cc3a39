/* units.h - a bounded queue of task units that one thread has still to do.
 *
 * Threads: one.
 * Source: paper section 4.3.
 */
#ifndef ENG_UNITS_H
#define ENG_UNITS_H

#include <assert.h>
#include <stdint.h>

/* Task units that wait: a ring, of at most as many as a worker can have that takes the
 * newest first. The method paper has one for each level, wide a block's pairs of each
 * (wide_method.c), and those of the initial assignment. */
#define ENG_UNITS_MAX 4096u

/* Its owner takes the newest, so that a unit finds in the cache what the one above it has
 * touched: a third less time than the oldest first on a recorded cloth, over the same
 * pairs. The front one stays the largest, as section 4.3 of the paper wants it, and is
 * what is given to others. A unit is a task of the method (method.h), for `paper` a
 * node. */
struct eng_task_queue {
    uint32_t head; /* free-running */
    uint32_t tail;
    uint64_t tasks[ENG_UNITS_MAX];
};

static inline uint32_t eng_units_count(const struct eng_task_queue *units)
{
    return units->tail - units->head;
}

static inline void eng_units_push(struct eng_task_queue *units, uint64_t task)
{
    assert(eng_units_count(units) < ENG_UNITS_MAX);
    units->tasks[units->tail++ % ENG_UNITS_MAX] = task;
}

/* Of a queue that has more than k: the one behind k others at the front. */
static inline uint64_t eng_units_look(const struct eng_task_queue *units, uint32_t k)
{
    return units->tasks[(units->head + k) % ENG_UNITS_MAX];
}

/* Take the newest, or the front one, of a queue that is not empty. */
static inline uint64_t eng_units_take_newest(struct eng_task_queue *units)
{
    return units->tasks[--units->tail % ENG_UNITS_MAX];
}

static inline uint64_t eng_units_take_front(struct eng_task_queue *units)
{
    return units->tasks[units->head++ % ENG_UNITS_MAX];
}

#endif

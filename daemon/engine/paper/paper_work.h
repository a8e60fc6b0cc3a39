/* paper_work.h - what one thread needs while it works for the method `paper`.
 *
 * Threads: [team]; it belongs to one thread.
 */
#ifndef ENG_PAPER_WORK_H
#define ENG_PAPER_WORK_H

#include <assert.h>

#include "batch.h"
#include "median.h"
#include "trees.h"
#include "worker.h"

/* Candidates of one kind on their way from traversal to tests. Global indices, in
 * the order of records. */
struct eng_chunk {
    uint32_t count;
    uint32_t a[ENG_CHUNK_MAX];
    uint32_t b[ENG_CHUNK_MAX];
};

/* Collision test pairs, taken from the end: each refinement goes down a level on either
 * side and puts four pairs in the place of one. */
#define ENG_PAIRS_MAX 256u

static_assert(3 * ENG_LEVELS_MAX + 1 <= ENG_PAIRS_MAX, "pairs");
static_assert(5 * ENG_LEVELS_MAX + 1 <= ENG_DEQUE_MAX / 2, "tasks");

struct eng_pair_queue {
    uint32_t count;
    uint32_t n[ENG_PAIRS_MAX];
    uint32_t m[ENG_PAIRS_MAX];
};

/* Nodes whose task units wait: a ring. The owner takes the newest, so that a unit finds
 * in the cache what the one above it has touched: a third less time than the oldest first
 * on a recorded cloth, over the same pairs. The front one stays the largest, as section
 * 4.3 of the paper wants it, and is what is given to others. */
#define ENG_UNITS_MAX 128u

/* One waits on each level, and one that was assigned. */
static_assert(ENG_UNITS_MAX > ENG_LEVELS_MAX + 2, "task units");

struct eng_unit_queue {
    uint32_t head; /* free-running */
    uint32_t tail;
    uint32_t nodes[ENG_UNITS_MAX];
};

static inline uint32_t eng_units_count(const struct eng_unit_queue *units)
{
    return units->tail - units->head;
}

static inline void eng_units_push(struct eng_unit_queue *units, uint32_t node)
{
    assert(eng_units_count(units) < ENG_UNITS_MAX);
    units->nodes[units->tail++ % ENG_UNITS_MAX] = node;
}

/* Of a queue that has more than k: the one behind k others at the front. */
static inline uint32_t eng_units_peek(const struct eng_unit_queue *units, uint32_t k)
{
    return units->nodes[(units->head + k) % ENG_UNITS_MAX];
}

/* Take the newest, or the front one, of a queue that is not empty. */
static inline uint32_t eng_units_take_newest(struct eng_unit_queue *units)
{
    return units->nodes[--units->tail % ENG_UNITS_MAX];
}

static inline uint32_t eng_units_take_front(struct eng_unit_queue *units)
{
    return units->nodes[units->head++ % ENG_UNITS_MAX];
}

struct eng_paper_work {
    struct eng_unit_queue units;
    struct eng_pair_queue pairs;
    struct eng_chunk chunks[COMMON_KIND_COUNT];
    uint32_t group_first; /* the first candidate of those that are tested together */
    struct eng_split_item *split_items; /* [split_capacity] to reconstruct a region */
    uint32_t split_capacity;
};

static inline struct eng_paper_work *eng_paper_work_of(const struct eng_worker *worker)
{
    return worker->work[PCCD_METHOD_PAPER];
}

/* Memory for a worker, and for the triangles of a region of the scene. PCCD_E_NOMEM: it
 * can be tried again. [compute] */
int eng_paper_work_reserve(struct eng_worker *worker, const struct eng_scene *scene);
void eng_paper_work_free(struct eng_worker *worker);
uint64_t eng_paper_work_bytes(const struct eng_worker *worker);

/* Get ready for a step: nothing waits. [compute] */
void eng_paper_work_begin(struct eng_worker *worker);

/* Test and empty one of the worker's chunks. [team] */
void eng_test_chunk(struct eng_worker *worker, enum pccd_kind kind);

#endif

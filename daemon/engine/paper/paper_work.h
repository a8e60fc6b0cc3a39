/* paper_work.h - what one thread needs while it works for the method `paper`.
 *
 * Threads: [team]; it belongs to one thread.
 */
#ifndef ENG_PAPER_WORK_H
#define ENG_PAPER_WORK_H

#include <assert.h>

#include "batch.h"
#include "sort.h"
#include "team.h"
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

/* Return the unit behind k others at the front of a queue that has more than k. */
static inline uint32_t eng_units_peek(const struct eng_unit_queue *units, uint32_t k)
{
    return units->nodes[(units->head + k) % ENG_UNITS_MAX];
}

/* Take the newest unit of a queue that is not empty. */
static inline uint32_t eng_units_take_newest(struct eng_unit_queue *units)
{
    return units->nodes[--units->tail % ENG_UNITS_MAX];
}

/* Take the front one of a queue that is not empty. */
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

/* Allocate memory for a worker, and for the triangles of a region of the scene.
 * PCCD_E_NOMEM: it can be tried again. [compute] */
int eng_paper_work_reserve(struct eng_worker *worker, const struct eng_scene *scene);
void eng_paper_work_free(struct eng_worker *worker);
uint64_t eng_paper_work_bytes(const struct eng_worker *worker);

/* Get ready for a step: nothing waits. [compute] */
void eng_paper_work_begin(struct eng_worker *worker);

/* Test and empty one of the worker's chunks. [team] */
void eng_test_chunk(struct eng_worker *worker, enum pccd_kind kind);

/* ---- the paper's scheduler --------------------------------------------------------- */

/* Choose low-level and high-level nodes, and deal out the former. [team], one thread */
void eng_schedule_paper_begin(struct eng_team *team, struct eng_worker *worker);

/* Perform the low-level nodes by dynamic assignment, then the high-level ones. [team],
 * each thread */
void eng_schedule_paper(struct eng_team *team, struct eng_worker *worker);

/* Refine the pair of a high-level node's children breadth-first until there are enough to
 * deal out round robin: in the assignment's `pairs`. By the first thread. [team] */
void eng_highlevel_expand(struct eng_team *team, struct eng_worker *worker,
                          uint32_t node);

/* ---- task units -------------------------------------------------------------------- */

/* Return whether features below a node may meet each other: not where they are all of an
 * object whose self-collision is off (masks.h), or foreign (mesh.h): nothing below it is
 * worth a task unit then. */
bool eng_taskunit_is_wanted(struct eng_worker *worker, uint32_t node);

/* Perform the task unit of `node`. The setup phase pushes its children to the worker's
 * task unit queue if `push_children`; the detection phase works through all pairs that
 * (left, right) leads to. A leaf has neither, nor has what is not wanted. Stops early
 * when worker->stop says so. */
void eng_taskunit_perform(struct eng_worker *worker, uint32_t node, bool push_children);

/* Work through the pairs that (n, m), two nodes neither of which is below the other,
 * leads to. */
void eng_taskunit_pairs(struct eng_worker *worker, uint32_t n, uint32_t m);

/* Test the boxes of (n, m) and refine it once: the pairs that may overlap are written to
 * n_out, m_out [4] without having been tested. Returns their number: 4, in the order LL,
 * LR, RL, RR; 2 if one of both is a leaf and stands for itself; 0 if the boxes are apart
 * or their objects may not meet, and for two leaves, which are dealt with. */
uint32_t eng_taskunit_refine(struct eng_worker *worker, uint32_t n, uint32_t m,
                             uint32_t n_out[4], uint32_t m_out[4]);

/* Refine (n, m) in the same way, uncounted, for a pair that another thread or phase
 * counts: 0 for two leaves, which are left to it. */
uint32_t eng_taskunit_peek(struct eng_worker *worker, uint32_t n, uint32_t m,
                           uint32_t n_out[4], uint32_t m_out[4]);

/* Test what is left in the worker's chunks. */
void eng_taskunit_flush(struct eng_worker *worker);

/* Perform all task units from the root on, depth-first, by the only worker: the paper's
 * serial method. */
void eng_taskunit_perform_all(struct eng_worker *worker);

#endif

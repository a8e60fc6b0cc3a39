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
#define ENG_PAIRS_MAX 512u

static_assert(3 * ENG_LEVELS_MAX + 1 <= ENG_PAIRS_MAX, "pairs");
static_assert(5 * ENG_LEVELS_MAX + 1 <= ENG_DEQUE_MAX / 2, "tasks");

struct eng_pair_queue {
    uint32_t count;
    uint32_t n[ENG_PAIRS_MAX];
    uint32_t m[ENG_PAIRS_MAX];
};

static_assert(ENG_UNITS_MAX > ENG_LEVELS_MAX + 1, "task units of the method paper");

struct eng_paper_work {
    struct eng_pair_queue pairs;
    struct eng_chunk chunks[COMMON_KIND_COUNT];
    uint32_t group_first; /* the first candidate of those that are tested together */
    struct eng_batch batch;
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

#endif

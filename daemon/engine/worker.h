/* daemon/engine/worker.h - what one thread of a step owns.
 *
 * Room:     engine. May include: exact.h, filter.h, result.h, world.h.
 * Does:     hold the queues of the scheduler, the chunks between traversal and tests, the
 *           scratch of the solver and the records found: the one interface through which
 *           schedule, traversal, filter, solver and results meet. A step's workers share
 *           nothing but the scene (read-only) and struct eng_stop.
 * Threads:  [team]; a worker belongs to one thread.
 */
#ifndef ENG_WORKER_H
#define ENG_WORKER_H

#include "exact.h"
#include "filter.h"
#include "result.h"
#include "world.h"

/* Candidates of one kind on their way from traversal to tests: 8 KiB, so that a chunk and
 * what its queries touch stay in the cache. Global indices; VF: vertex and triangle, EE: two
 * edges, the one that records name first in front. */
#define ENG_CHUNK_MAX 1024u

struct eng_chunk {
    uint32_t count;
    uint32_t a[ENG_CHUNK_MAX];
    uint32_t b[ENG_CHUNK_MAX];
};

/* Collision test pairs, taken from the end: with four pairs pushed for one taken, a tree pair
 * of depth d needs 3 d + 1 places. Median splits bound d by 32 for an object and 17 for the
 * tree over objects (65 536 of them), on either side of a pair. */
#define ENG_PAIRS_MAX 512u

struct eng_pair_queue {
    uint32_t count;
    uint32_t n[ENG_PAIRS_MAX];
    uint32_t m[ENG_PAIRS_MAX];
};

/* Nodes whose self-CD task unit is to be done, first in first out: breadth-first, so the
 * front node is never smaller than one behind it (paper 4.3). A ring of a power of two. */
struct eng_task_queue {
    uint32_t *nodes;
    uint32_t capacity;
    uint32_t head; /* free-running */
    uint32_t tail;
};

/* Why and until when all workers go on. */
struct eng_stop {
    const atomic_bool *cancel;
    uint64_t deadline_ns;
    enum eng_incomplete reason; /* set by the worker that saw it */
    bool stopped;               /* by deadline, cancel or a proved contact in mode any */
};

struct eng_worker {
    const struct eng_scene *scene;
    const struct eng_step_settings *settings;
    struct eng_stop *stop;
    double time_bound; /* mode first: no contact after it is wanted; else 1 */
    float box_bound;   /* the same, rounded up */
    struct eng_task_queue units;
    struct eng_pair_queue pairs;
    struct eng_chunk vf;
    struct eng_chunk ee;
    struct eng_records records;
    struct eng_exact exact;
    struct eng_step_counters counters;
    uint64_t possible_seen; /* mode any */
    uint64_t proved_seen;
    uint64_t tests_ns;
};

int eng_worker_init(struct eng_worker *worker);
void eng_worker_deinit(struct eng_worker *worker);

/* Get ready for a step. ENG_E_NOMEM: the task queue cannot hold the scene's nodes. */
int eng_worker_begin(struct eng_worker *worker, const struct eng_scene *scene,
                     const struct eng_step_settings *settings, struct eng_stop *stop);

/* Should the worker stop? Looks at the clock and at the cancel flag. */
bool eng_worker_should_stop(struct eng_worker *worker);

#endif

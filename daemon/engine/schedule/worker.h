/* daemon/engine/schedule/worker.h - what one thread of a step owns.
 *
 * Room:     engine. May include: batch.h, clock.h, deque.h, exact.h, result.h, share.h,
 *           trace.h, units.h, world.h.
 * Does:     hold the queues of the scheduler, the chunks between traversal and tests, the
 *           scratch of reconstruction and solver and the records found: the one interface
 *           through which schedule, traversal, filter, solver and results meet. A step's
 *           workers share nothing but the scene and struct eng_stop.
 * Threads:  [team]; a worker belongs to one thread.
 */
#ifndef ENG_WORKER_H
#define ENG_WORKER_H

#include "batch.h"
#include "clock.h"
#include "deque.h"
#include "exact.h"
#include "result.h"
#include "share.h"
#include "trace.h"
#include "units.h"
#include "world.h"

/* Candidates of one kind on their way from traversal to tests. Global indices; VF: vertex
 * and triangle, EE: two edges, the one that records name first in front. */
struct eng_chunk {
    uint32_t count;
    uint32_t a[ENG_CHUNK_MAX];
    uint32_t b[ENG_CHUNK_MAX];
};

/* Levels of a scene's tree, at most. An object of n triangles has ceil(log2 n) levels by
 * medians, 16 more by the other build quality, one more in a reconstructed region
 * (build.h, rebuild.h); k objects have ceil(log2 k) above them. With n + k <= 2^31 the
 * sum is largest for n = k = 2^30. */
#define ENG_LEVELS_MAX (30u + 30u + 16u + 1u)

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

/* Where the threads of a region wait for each other (wait.h). */
struct eng_meeting {
    _Alignas(128) atomic_uint arrived;
    _Alignas(128) atomic_uint round; /* how often all have been there */
};

/* What the workers of a step share besides the scene. */
struct eng_stop {
    struct eng_meeting meeting;
    const atomic_bool *cancel;
    uint64_t deadline_ns;
    atomic_int reason;   /* enum eng_incomplete, set by the worker that saw it */
    atomic_bool stopped; /* by deadline, cancel or a proved contact in mode any */
    bool gave_up;        /* of a brief step, by the one thread that it has */
    /* Mode first: no contact after this time is wanted; else 1. The bits of a double: for
     * positive numbers they have the order of the numbers, so a minimum is
     * an integer's. */
    atomic_uint_fast64_t time_bound;
};

/* What a worker counts besides its record; struct eng_step_counters says what each is. */
struct eng_tally {
    uint64_t leaf_pairs;
    uint64_t candidates_vf;
    uint64_t candidates_ee;
    uint64_t survivors;
    uint64_t rebuilt_triangles;
};

/* Every access is relaxed: these are hints that only save work, and the end of the
 * parallel region orders them before anybody reads the outcome. */
static inline bool eng_stop_is_set(const struct eng_stop *stop)
{
    return atomic_load_explicit(&stop->stopped, memory_order_relaxed);
}

struct eng_wide_work; /* wide_test.h */

struct eng_worker {
    struct eng_scene *scene; /* written to only behind gates (rebuild.h) */
    const struct eng_step_settings *settings;
    const struct eng_kernels *kernels; /* of the settings, never NULL */
    struct eng_stop *stop;
    uint32_t thread;                         /* place in the team */
    double time_bound;                       /* the shared one as last seen */
    float box_bound;                         /* the same and the tolerance, rounded up */
    struct eng_share shares[ENG_WIDE_KINDS]; /* method wide: chunks of the refit */
    struct eng_deque deque;                  /* work stealing: tasks others may take */
    uint32_t victim;                         /* whom to rob next */
    bool is_dealt;                           /* the step began with tasks for it */
    struct eng_task_queue units;
    struct eng_pair_queue pairs;
    struct eng_chunk vf;
    struct eng_chunk ee;
    struct eng_wide_work *wide; /* method wide; NULL until a step needs it */
    struct eng_found found;
    struct eng_exact exact;
    struct eng_batch batch;
    struct eng_split_item *split_items; /* [split_capacity] to reconstruct a region */
    uint32_t split_capacity;
    struct eng_thread_record record;
    struct eng_tally tally;
    uint64_t low_end_ns;    /* the paper's scheduler: when it knew that all were done with
                             * low-level nodes; else 0 */
    uint64_t possible_seen; /* mode any */
    uint64_t proved_seen;
};

void eng_worker_init(struct eng_worker *worker);
void eng_worker_deinit(struct eng_worker *worker);

/* Room for the nodes of the scene's tree in the task queue, and for the triangles of a
 * region. ENG_E_NOMEM: as before. */
int eng_worker_reserve_tree(struct eng_worker *worker, const struct eng_scene *scene);

/* Get ready for a step. */
void eng_worker_begin(struct eng_worker *worker, struct eng_scene *scene,
                      const struct eng_step_settings *settings, struct eng_stop *stop,
                      struct eng_pool *pool);

/* The bound as it stands; after the region: the final one. */
double eng_stop_time_bound(const struct eng_stop *stop);

void eng_stop_init(struct eng_stop *stop, const struct eng_step_settings *settings);

/* Should the worker stop? Looks at the clock and at the cancel flag. */
bool eng_worker_should_stop(struct eng_worker *worker);

/* The same for one that is about to do what cannot be stopped and takes `ns`. True only
 * for a deadline or a cancel. */
bool eng_worker_is_late(struct eng_worker *worker, uint64_t ns);

/* When a slice of the trace begins; 0 without a trace, so that nobody asks the clock. */
static inline uint64_t eng_worker_slice(const struct eng_worker *worker)
{
    return worker->settings->trace ? eng_now_ns() : 0;
}

/* End it now. */
static inline void eng_worker_trace(const struct eng_worker *worker,
                                    enum eng_trace_kind kind, uint64_t begin_ns,
                                    uint32_t a, uint32_t b)
{
    if (worker->settings->trace) {
        eng_trace_add(worker->settings->trace, worker->thread, kind, begin_ns,
                      eng_now_ns(), a, b);
    }
}

/* The worker was without work since `begin_ns`. */
void eng_worker_waited(struct eng_worker *worker, uint64_t begin_ns);

/* The step is to be brief, and is not. */
void eng_worker_give_up(struct eng_worker *worker);

/* Mode first: a proved contact has certainly begun at `time`. */
void eng_worker_tighten(struct eng_worker *worker, double time);

#endif

/* worker.h - what one thread needs to compute its part of a step, whatever the method.
 *
 * Hold its tasks, the records that it has found, its counters and times, the scratch of
 * exact arithmetic, and a slot for the state of the method. The workers of a step share
 * nothing but the scene and struct eng_stop.
 *
 * Threads: [team]; a worker belongs to one thread.
 */
#ifndef ENG_WORKER_H
#define ENG_WORKER_H

#include "clock.h"
#include "deque.h"
#include "exact.h"
#include "per_pair.h"
#include "query.h"
#include "question.h"
#include "result.h"
#include "step_result.h"
#include "trace.h"

struct eng_kernels;
struct eng_narrow;
struct eng_scene;
struct eng_straight;
struct eng_turning;

/* Where the threads of a region wait for each other (wait.h). */
struct eng_barrier {
    _Alignas(128) atomic_uint arrived;
    _Alignas(128) atomic_uint round; /* how often all have been there */
};

/* The state that the workers of a step share besides the scene. */
struct eng_stop {
    struct eng_barrier barrier;
    const atomic_bool *cancel;
    bool (*is_stopped)(void *asked); /* of the question */
    void *asked;
    uint64_t deadline_ns;
    atomic_int reason;   /* enum pccd_incomplete, set by the worker that saw it */
    atomic_bool stopped; /* by deadline, cancel or a proved contact in mode any */
    bool gave_up;        /* of a brief step, by the one thread that it has */
    /* Mode first: no contact after this time is wanted; else 1. The bits of a double: for
     * positive numbers they have the order of the numbers, so a minimum is
     * an integer's. */
    atomic_uint_fast64_t time_bound;
};

/* The counts of a worker besides its record: as in struct pccd_step_counters. */
struct eng_tally {
    uint64_t leaf_pairs;
    uint64_t candidates[PCCD_KINDS_MAX];
    uint64_t survivors;
    uint64_t rebuilt_triangles;
    uint64_t still_features;
    uint64_t still_pairs;
    uint64_t touching[3]; /* pairs that enter, slide and leave */
};

/* Return whether the step is to stop. Every access is relaxed: these are hints that only
 * save work, and the end of the parallel region orders them before anybody reads the
 * outcome. */
static inline bool eng_stop_is_set(const struct eng_stop *stop)
{
    return atomic_load_explicit(&stop->stopped, memory_order_relaxed);
}

struct eng_worker {
    struct eng_scene *scene; /* written to only behind gates (rebuild.h) */
    const struct eng_question *question;
    const struct eng_kernels *kernels; /* of the question, never NULL */
    struct eng_stop *stop;
    uint32_t thread;   /* place in the team */
    double time_bound; /* the shared one as last seen */
    float box_bound;   /* the same and the tolerance, rounded up, as boxes know it: of
                             * a part of the step in the time of the part */
    struct eng_deque deque; /* work stealing: tasks others may take */
    uint32_t victim;        /* whom to rob next */
    bool is_dealt;          /* the step began with tasks for it */
    bool prunes;            /* that of the team */
    struct eng_found found; /* records */
    struct eng_per_pair firsts; /* mode first-per-pair: what it has found so far */
    struct eng_exact exact;
    void *work[PCCD_METHOD_COUNT]; /* by method, which casts it; NULL: none yet */
    struct eng_narrow *narrow;     /* of the narrow phase (narrow.h); NULL: none yet */
    struct eng_turning *turning;   /* of objects that turn (turning.h); NULL: none yet */
    struct eng_straight *straight; /* of those that go straight (straight.h); the same */
    struct eng_thread_record record;
    struct eng_tally tally;
    uint64_t low_end_ns;    /* the paper's scheduler: when it knew that all were done with
                             * low-level nodes; else 0 */
    uint64_t possible_seen; /* mode any */
    uint64_t proved_seen;
    struct pccd_pair proof; /* the last of these */
};

/* Begin with nothing in `work`, which its methods free before deinit. PCCD_E_NOMEM: there
 * is no worker. */
int eng_worker_init(struct eng_worker *worker);
void eng_worker_deinit(struct eng_worker *worker);

/* Get ready for a step. */
void eng_worker_begin(struct eng_worker *worker, struct eng_scene *scene,
                      const struct eng_question *question, struct eng_stop *stop,
                      struct eng_pool *pool);

/* Return the bound of mode first as it stands; after the region: the final one. */
double eng_stop_time_bound(const struct eng_stop *stop);

void eng_stop_init(struct eng_stop *stop, const struct eng_question *question);

/* Return whether the worker should stop. Looks at the clock and at the cancel flag; the
 * first thread also asks whoever is to be asked. */
bool eng_worker_should_stop(struct eng_worker *worker);

/* Return whether the worker should stop that is about to do what cannot be stopped and
 * takes `ns`. True only for a deadline or a cancel. */
bool eng_worker_is_late(struct eng_worker *worker, uint64_t ns);

/* Stop the step if that is asked for, while the worker waits for others: the first thread
 * asks whoever is to be asked. */
void eng_worker_ask(struct eng_worker *worker);

/* Return when a slice of the trace begins; 0 without a trace, so that nobody asks the
 * clock. */
static inline uint64_t eng_worker_slice(const struct eng_worker *worker)
{
    return worker->question->trace ? common_now_ns() : 0;
}

/* End it. */
static inline void eng_worker_trace_until(const struct eng_worker *worker,
                                          enum pccd_trace_kind kind, uint64_t begin_ns,
                                          uint64_t end_ns, uint32_t a, uint32_t b)
{
    uint32_t track = worker->question->track + worker->thread;
    eng_trace_add(worker->question->trace,
                  (struct pccd_trace_event){begin_ns, end_ns, kind, track, a, b});
}

/* End it now. */
static inline void eng_worker_trace(const struct eng_worker *worker,
                                    enum pccd_trace_kind kind, uint64_t begin_ns,
                                    uint32_t a, uint32_t b)
{
    if (worker->question->trace) {
        eng_worker_trace_until(worker, kind, begin_ns, common_now_ns(), a, b);
    }
}

/* Record that the worker was without work from `begin_ns` until now. */
void eng_worker_waited(struct eng_worker *worker, uint64_t begin_ns);

/* Stop the step for a reason that the worker has found. */
void eng_worker_stop(struct eng_worker *worker, enum pccd_incomplete reason);
/* Note that something is not known, without stopping. */
void eng_worker_lack(struct eng_worker *worker, enum pccd_incomplete reason);

/* Stop a step that is to be brief, and is not. */
void eng_worker_give_up(struct eng_worker *worker);

/* Lower the bound of mode first: a proved contact has certainly begun at `time`. */
void eng_worker_tighten(struct eng_worker *worker, double time);

/* ---- what a test found ------------------------------------------------------------- */

/* The names of candidates index[count] of those that a method has at hand. */
typedef void (*eng_names_fn)(const struct eng_worker *worker, enum pccd_kind kind,
                             const uint32_t *index, uint32_t count,
                             struct pccd_pair *names);

/* Count candidates whose boxes overlap, tested or not. */
void eng_count_candidates(struct eng_worker *worker, enum pccd_kind kind,
                          uint32_t candidates);

/* Record that the tests of a chunk, `tested` of them, began at `begin_ns` and end now. */
void eng_count_test_time(struct eng_worker *worker, enum pccd_kind kind, uint32_t tested,
                         uint64_t begin_ns);

/* Keep what a test has found, as the mode of the step wants it. */
void eng_record_contact(struct eng_worker *worker, const struct pccd_pair *name,
                        const struct eng_hit *hit);

#endif

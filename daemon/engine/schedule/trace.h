/* trace.h - what the threads of a step did, when.
 *
 * Room:     engine. May include: the C library.
 * Does:     keep the newest events of every thread in a ring of its own, so that
 *           recording takes no lock; without a trace it costs a test of a pointer for
 *           each task.
 * Does not: write files or know a format: the reader does.
 * Threads:  add: the thread whose lane it is; the rest: [compute], between steps.
 */
#ifndef ENG_TRACE_H
#define ENG_TRACE_H

#include <stdint.h>

enum eng_trace_kind {
    ENG_TRACE_STEP = 0,    /* a whole step; a: triangles, b: threads */
    ENG_TRACE_REFIT = 1,   /* a thread's part of it */
    ENG_TRACE_UNIT = 2,    /* self-CD task unit; a: node, b: triangles below it. Method
                            * wide: a task; a, b: its nodes */
    ENG_TRACE_SUBTREE = 3, /* a task: all units below a node; a: node, b: triangles */
    ENG_TRACE_PAIRS = 4,   /* a task: what a pair of nodes leads to; a, b: nodes */
    ENG_TRACE_HIGH = 5,    /* a thread's part of a high-level unit, which has no slice
                            * of its own; a: node, b: pairs */
    ENG_TRACE_TESTS = 6,   /* a chunk of elementary tests; a: kind, b: candidates */
    ENG_TRACE_REBUILD = 7, /* reconstruction in the traversal; a: node, b: triangles */
    ENG_TRACE_ASIDE = 8,   /* a share of a subtree built aside; a: node, b: triangles.
                            * Method wide: of new orders; a: object, b: features of all */
    ENG_TRACE_WAIT = 9,    /* without work, asleep or searching */
    ENG_TRACE_MERGE = 10,  /* sort, gather, hash */
    ENG_TRACE_KINDS
};

struct eng_trace_event {
    uint64_t begin_ns; /* CLOCK_MONOTONIC */
    uint64_t end_ns;
    uint32_t kind;
    uint32_t thread;
    uint32_t a;
    uint32_t b;
};

/* One thread's ring. */
struct eng_trace_lane {
    _Alignas(128) struct eng_trace_event *events;
    uint64_t added; /* since the start; the newest `capacity` are kept */
};

struct eng_trace {
    struct eng_trace_lane *lanes; /* [lane_count] */
    uint32_t lane_count;          /* threads; those beyond are not recorded */
    uint32_t capacity;            /* events of a lane, a power of two */
    uint64_t min_ns; /* task units, subtrees and pairs that took less are left out */
};

/* Memory for `lanes` threads of `capacity` events each (rounded up to a power of two).
 * ENG_E_NOMEM, ENG_E_INVAL (0 of either). */
int eng_trace_init(struct eng_trace *trace, uint32_t lanes, uint32_t capacity,
                   uint64_t min_ns);
void eng_trace_deinit(struct eng_trace *trace);

/* Append an event to the lane of `thread`; nothing if `trace` is NULL. [team] */
void eng_trace_add(struct eng_trace *trace, uint32_t thread, enum eng_trace_kind kind,
                   uint64_t begin_ns, uint64_t end_ns, uint32_t a, uint32_t b);

/* Events of a lane that are still there, and the i-th of them, oldest first. */
uint64_t eng_trace_count(const struct eng_trace *trace, uint32_t lane);
const struct eng_trace_event *eng_trace_at(const struct eng_trace *trace, uint32_t lane,
                                           uint64_t i);

#endif

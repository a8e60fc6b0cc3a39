/* trace.h - records what each thread of a step did, and when.
 *
 * Keep the newest events of every thread in a ring of its own, so that recording takes no
 * lock. Without a trace it costs one test of a pointer for each task.
 *
 * Threads: add: the thread whose track it is; the rest: [compute], between steps.
 */
#ifndef ENG_TRACE_H
#define ENG_TRACE_H

#include <stdint.h>

#include "pccd_trace.h"

/* One thread's ring. */
struct eng_trace_track {
    _Alignas(128) struct pccd_trace_event *events;
    uint64_t added; /* since the start; the newest `capacity` are kept */
};

struct eng_trace {
    struct eng_trace_track *tracks; /* [track_count] */
    uint32_t track_count;           /* threads; those beyond are not recorded */
    uint32_t capacity;              /* events of a track, a power of two */
    uint64_t min_ns; /* task units, subtrees and pairs that took less are left out */
};

/* Allocate memory for `tracks` threads of `capacity` events each (rounded up to a power
 * of two). PCCD_E_NOMEM, PCCD_E_INVAL (0 of either, or a capacity above 2^30). */
int eng_trace_init(struct eng_trace *trace, uint32_t tracks, uint32_t capacity,
                   uint64_t min_ns);
void eng_trace_deinit(struct eng_trace *trace);

/* Append an event to the track of its thread; nothing if `trace` is NULL. [team] */
void eng_trace_add(struct eng_trace *trace, struct pccd_trace_event event);

/* Return how many events of a track are still there. */
uint64_t eng_trace_count(const struct eng_trace *trace, uint32_t track);
/* Return the i-th of them, oldest first. */
const struct pccd_trace_event *eng_trace_at(const struct eng_trace *trace, uint32_t track,
                                            uint64_t i);

#endif

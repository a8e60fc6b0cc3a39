/* tracing.h - a trace: a recording of what the daemon's threads do, and when (`pccdctl
 * trace`).
 *
 * While the trace records, the loop writes its ring; the first thread that computes, or
 * its team, writes the engine's. At rest only the thread that computes reads both.
 */
#ifndef SRV_TRACING_H
#define SRV_TRACING_H

#include <stdbool.h>
#include <stdint.h>

#include "codec.h"
#include "engine.h"
#include "pccd_trace.h"
#include "resource.h"

struct srv_service;
struct srv_session;

struct srv_tracing {
    struct srv_resource resource; /* first; its session owns the recording */
    uint32_t tracks;              /* threads of the team */
    uint32_t capacity; /* events of each track, and of the ring; power of two */
    uint64_t min_ns;
    struct eng_trace engine; /* [compute]; no tracks until work_start */
    bool is_recording;       /* [loop] the ring is written */
    bool is_stopped;         /* [loop] nothing more will be, once trace.stop has run */
    struct pccd_trace_event *ring; /* [loop], at rest [compute]; [capacity] */
    uint64_t added;                /* to the ring; the newest `capacity` are there */
};

/* Make a recording that is not on yet, as the loop's only one. events: of each thread and
 * of the loop, 0: as many as are usual and fit. Returns 0, or PCCD_E_LIMIT or
 * PCCD_E_NOMEM with *error set. [loop] */
int srv_tracing_new(struct srv_session *session, uint32_t events, uint64_t min_ns,
                    struct srv_tracing **tracing, struct proto_error *error);
/* End the session's recording, if it has one. [loop] */
void srv_tracing_drop(struct srv_session *session);

/* Let steps be recorded, and no more. Start returns a wire status; stop waits for a step
 * that is being recorded. [compute] */
int srv_tracing_start(struct srv_tracing *tracing);
void srv_tracing_stop(struct srv_tracing *tracing);

/* Lend the recorder to a step that begins, to be returned when it has ended; NULL:
 * nothing, as on threads beside the first one that computes: a track belongs to one
 * thread. [compute] */
struct eng_trace *srv_tracing_lend(void);
void srv_tracing_return(struct eng_trace *trace);

/* Return how many events can be read; *lost: how many were overwritten. At rest.
 * [compute] */
uint64_t srv_tracing_count(const struct srv_tracing *tracing, uint64_t *lost);
/* Copy events first .. first+count-1: the threads' one after the other, then the loop's,
 * each oldest first. At rest. [compute] */
void srv_tracing_copy(const struct srv_tracing *tracing, uint64_t first, uint64_t count,
                      struct pccd_trace_event *events);

/* Record what the loop did with a request, if anything is recorded. [loop] */
void srv_tracing_add(struct srv_service *service, enum pccd_trace_kind kind,
                     const struct srv_session *session, uint64_t begin_ns, int method,
                     uint32_t id);

#endif

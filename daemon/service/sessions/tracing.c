/* tracing.c - a recording of what the daemon does. */
#include "tracing.h"

#include <pthread.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "engine.h"
#include "invariant.h"
#include "now.h"
#include "proto_limits.h"
#include "service.h"
#include "session.h"

/* The recorder of steps; there is one recording in a process. */
static pthread_mutex_t recorder_lock = PTHREAD_MUTEX_INITIALIZER;
static struct eng_trace *_Atomic recorder; /* NULL: nothing. Written with the lock */
static bool is_lent;                       /* to a step; locked */

struct eng_trace *srv_tracing_lend(void)
{
    srv_assert_compute();
    if (atomic_load_explicit(&recorder, memory_order_relaxed) == NULL ||
        eng_payer()->number != 0) {
        return NULL;
    }
    pthread_mutex_lock(&recorder_lock);
    struct eng_trace *trace = atomic_load_explicit(&recorder, memory_order_relaxed);
    is_lent = trace != NULL;
    pthread_mutex_unlock(&recorder_lock);
    return trace;
}

void srv_tracing_return(struct eng_trace *trace)
{
    if (trace != NULL) {
        pthread_mutex_lock(&recorder_lock);
        is_lent = false;
        pthread_mutex_unlock(&recorder_lock);
    }
}

/* Nobody writes to the one before any more. */
static void set_recorder(struct eng_trace *trace)
{
    pthread_mutex_lock(&recorder_lock);
    atomic_store_explicit(&recorder, trace, memory_order_relaxed);
    while (is_lent) { /* for the rest of a step; seldom, so that nobody is woken for it */
        const struct timespec pause = {0, 1000000};
        pthread_mutex_unlock(&recorder_lock);
        nanosleep(&pause, NULL);
        pthread_mutex_lock(&recorder_lock);
    }
    pthread_mutex_unlock(&recorder_lock);
}

static void free_engine(struct srv_job *job)
{
    struct srv_tracing *tracing = (struct srv_tracing *)job;
    srv_tracing_stop(tracing);
    eng_trace_deinit(&tracing->engine);
}

static void free_rest(struct srv_job *job)
{
    struct srv_tracing *tracing = (struct srv_tracing *)job;
    struct srv_owner *owner = tracing->resource.owner;
    free(tracing->ring);
    free(tracing);
    srv_owner_release(owner);
}

/* Bytes of the engine's tracks and of the loop's ring. */
static uint64_t bytes_of(uint32_t tracks, uint32_t capacity)
{
    return ((uint64_t)tracks + 1) * capacity * sizeof(struct pccd_trace_event);
}

/* The capacity for a request of that many events. Returns 0 or PCCD_E_LIMIT. */
static int capacity_for(uint32_t tracks, uint32_t events, uint32_t *capacity,
                        struct proto_error *error)
{
    uint32_t wanted = events == 0 ? PROTO_TRACE_EVENTS : events;
    uint32_t most = PROTO_TRACE_EVENTS_MAX;
    while (bytes_of(tracks, most) > PROTO_TRACE_BYTES_MAX) { /* ends: tracks are few */
        most /= 2;
    }
    if (events > most) {
        return proto_error_set(error, PCCD_E_LIMIT,
                               "%u events for each of %u threads, there can be %u",
                               events, tracks, most);
    }
    *capacity = 1;
    while (*capacity < wanted && *capacity < most) {
        *capacity *= 2;
    }
    return 0;
}

int srv_tracing_new(struct srv_session *session, uint32_t events, uint64_t min_ns,
                    struct srv_tracing **tracing, struct proto_error *error)
{
    srv_assert_loop();
    struct srv_service *service = session->service;
    PCCD_ASSERT(service->tracing == NULL);
    uint32_t threads = service->options->threads_max;
    uint32_t tracks = threads < ENG_THREADS_MAX ? threads : ENG_THREADS_MAX;
    uint32_t capacity = 0;
    int status = capacity_for(tracks, events, &capacity, error);
    if (status != 0) {
        return status;
    }
    struct srv_tracing *new = calloc(1, sizeof *new);
    if (new != NULL) {
        new->ring = malloc(capacity * sizeof *new->ring);
    }
    if (new == NULL || new->ring == NULL) {
        free(new);
        return proto_error_set(error, PCCD_E_NOMEM, "no memory for %u events", capacity);
    }
    srv_resource_init(&new->resource, &session->owner, free_engine, free_rest);
    new->tracks = tracks;
    new->capacity = capacity;
    new->min_ns = min_ns;
    service->tracing = new;
    *tracing = new;
    return 0;
}

void srv_tracing_drop(struct srv_session *session)
{
    srv_assert_loop();
    struct srv_tracing *tracing = session->service->tracing;
    if (tracing != NULL && tracing->resource.owner == &session->owner) {
        session->service->tracing = NULL;
        srv_resource_drop(&tracing->resource);
    }
}

int srv_tracing_start(struct srv_tracing *tracing)
{
    srv_assert_compute();
    int status = eng_trace_init(&tracing->engine, tracing->tracks, tracing->capacity,
                                tracing->min_ns);
    if (status == 0) {
        set_recorder(&tracing->engine);
    }
    return status;
}

void srv_tracing_stop(struct srv_tracing *tracing)
{
    srv_assert_compute();
    if (atomic_load_explicit(&recorder, memory_order_relaxed) == &tracing->engine) {
        set_recorder(NULL);
    }
}

static uint64_t ring_count(const struct srv_tracing *tracing)
{
    return tracing->added < tracing->capacity ? tracing->added : tracing->capacity;
}

uint64_t srv_tracing_count(const struct srv_tracing *tracing, uint64_t *lost)
{
    srv_assert_compute();
    const struct eng_trace *engine = &tracing->engine;
    uint64_t count = ring_count(tracing);
    *lost = tracing->added - count;
    for (uint32_t track = 0; track < engine->track_count; track++) {
        uint64_t of_track = eng_trace_count(engine, track);
        count += of_track;
        *lost += engine->tracks[track].added - of_track;
    }
    return count;
}

/* The i-th event of the ring, oldest first. */
static const struct pccd_trace_event *ring_at(const struct srv_tracing *tracing,
                                              uint64_t i)
{
    uint64_t oldest = tracing->added - ring_count(tracing);
    return &tracing->ring[(oldest + i) & (tracing->capacity - 1)];
}

void srv_tracing_copy(const struct srv_tracing *tracing, uint64_t first, uint64_t count,
                      struct pccd_trace_event *events)
{
    srv_assert_compute();
    const struct eng_trace *engine = &tracing->engine;
    uint64_t done = 0;
    for (uint32_t track = 0; track < engine->track_count && done < count; track++) {
        uint64_t of_track = eng_trace_count(engine, track);
        for (; first < of_track && done < count; first++) {
            memcpy(&events[done++], eng_trace_at(engine, track, first), sizeof *events);
        }
        first -= of_track;
    }
    for (; done < count; first++) {
        PCCD_ASSERT(first < ring_count(tracing));
        events[done++] = *ring_at(tracing, first);
    }
}

void srv_tracing_add(struct srv_service *service, enum pccd_trace_kind kind,
                     const struct srv_session *session, uint64_t begin_ns, int method,
                     uint32_t id)
{
    struct srv_tracing *tracing = service->tracing;
    if (tracing == NULL || !tracing->is_recording) {
        return;
    }
    tracing->ring[tracing->added++ & (tracing->capacity - 1)] =
        (struct pccd_trace_event){.begin_ns = begin_ns,
                                  .end_ns = common_now_ns(),
                                  .kind = kind,
                                  .thread = (uint32_t)session->id,
                                  .a = method >= 0 ? (uint32_t)method : UINT32_MAX,
                                  .b = id};
}

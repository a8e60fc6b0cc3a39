/* trace.c - what the threads of a step did, when. */
#include "trace.h"

#include <assert.h>
#include <stddef.h>
#include <string.h>

#include "memory.h"
#include "pccd_types.h"

int eng_trace_init(struct eng_trace *trace, uint32_t tracks, uint32_t capacity,
                   uint64_t min_ns)
{
    if (tracks == 0 || capacity == 0 || capacity > 1u << 30) {
        return PCCD_E_INVAL;
    }
    memset(trace, 0, sizeof *trace);
    trace->capacity = 1;
    while (trace->capacity < capacity) {
        trace->capacity *= 2;
    }
    trace->min_ns = min_ns;
    trace->tracks = eng_alloc(tracks, sizeof *trace->tracks);
    if (!trace->tracks) {
        return PCCD_E_NOMEM;
    }
    while (trace->track_count < tracks) {
        struct eng_trace_track *track = &trace->tracks[trace->track_count];
        track->added = 0;
        track->events = eng_alloc(trace->capacity, sizeof *track->events);
        if (!track->events) {
            eng_trace_deinit(trace);
            return PCCD_E_NOMEM;
        }
        trace->track_count++;
    }
    return PCCD_OK;
}

void eng_trace_deinit(struct eng_trace *trace)
{
    for (uint32_t i = 0; i < trace->track_count; i++) {
        eng_free(trace->tracks[i].events);
    }
    eng_free(trace->tracks);
    memset(trace, 0, sizeof *trace);
}

void eng_trace_add(struct eng_trace *trace, struct pccd_trace_event event)
{
    assert(event.kind < PCCD_TRACE_KIND_COUNT);
    if (!trace || event.thread >= trace->track_count) {
        return;
    }
    if (event.kind >= PCCD_TRACE_UNIT && event.kind <= PCCD_TRACE_PAIRS &&
        event.end_ns - event.begin_ns < trace->min_ns) {
        return;
    }
    struct eng_trace_track *track = &trace->tracks[event.thread];
    track->events[track->added++ & (trace->capacity - 1)] = event;
}

uint64_t eng_trace_count(const struct eng_trace *trace, uint32_t track)
{
    assert(track < trace->track_count);
    uint64_t added = trace->tracks[track].added;
    return added < trace->capacity ? added : trace->capacity;
}

const struct pccd_trace_event *eng_trace_at(const struct eng_trace *trace, uint32_t track,
                                            uint64_t i)
{
    const struct eng_trace_track *of = &trace->tracks[track];
    assert(i < eng_trace_count(trace, track));
    uint64_t oldest = of->added - eng_trace_count(trace, track);
    return &of->events[(oldest + i) & (trace->capacity - 1)];
}

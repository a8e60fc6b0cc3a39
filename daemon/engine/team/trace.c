/* trace.c - what the threads of a step did, when. */
#include "trace.h"

#include <assert.h>
#include <stddef.h>
#include <string.h>

#include "memory.h"
#include "pccd_types.h"

int eng_trace_init(struct eng_trace *trace, uint32_t lanes, uint32_t capacity,
                   uint64_t min_ns)
{
    if (lanes == 0 || capacity == 0 || capacity > 1u << 30) {
        return PCCD_E_INVAL;
    }
    memset(trace, 0, sizeof *trace);
    trace->capacity = 1;
    while (trace->capacity < capacity) {
        trace->capacity *= 2;
    }
    trace->min_ns = min_ns;
    trace->lanes = eng_alloc(lanes, sizeof *trace->lanes);
    if (!trace->lanes) {
        return PCCD_E_NOMEM;
    }
    while (trace->lane_count < lanes) {
        struct eng_trace_lane *lane = &trace->lanes[trace->lane_count];
        lane->added = 0;
        lane->events = eng_alloc(trace->capacity, sizeof *lane->events);
        if (!lane->events) {
            eng_trace_deinit(trace);
            return PCCD_E_NOMEM;
        }
        trace->lane_count++;
    }
    return PCCD_OK;
}

void eng_trace_deinit(struct eng_trace *trace)
{
    for (uint32_t i = 0; i < trace->lane_count; i++) {
        eng_free(trace->lanes[i].events);
    }
    eng_free(trace->lanes);
    memset(trace, 0, sizeof *trace);
}

void eng_trace_add(struct eng_trace *trace, struct pccd_trace_event event)
{
    assert(event.kind < PCCD_TRACE_KIND_COUNT);
    if (!trace || event.thread >= trace->lane_count) {
        return;
    }
    if (event.kind >= PCCD_TRACE_UNIT && event.kind <= PCCD_TRACE_PAIRS &&
        event.end_ns - event.begin_ns < trace->min_ns) {
        return;
    }
    struct eng_trace_lane *lane = &trace->lanes[event.thread];
    lane->events[lane->added++ & (trace->capacity - 1)] = event;
}

uint64_t eng_trace_count(const struct eng_trace *trace, uint32_t lane)
{
    assert(lane < trace->lane_count);
    uint64_t added = trace->lanes[lane].added;
    return added < trace->capacity ? added : trace->capacity;
}

const struct pccd_trace_event *eng_trace_at(const struct eng_trace *trace, uint32_t lane,
                                            uint64_t i)
{
    const struct eng_trace_lane *of = &trace->lanes[lane];
    assert(i < eng_trace_count(trace, lane));
    uint64_t oldest = of->added - eng_trace_count(trace, lane);
    return &of->events[(oldest + i) & (trace->capacity - 1)];
}

/* step_trace.c - what a daemon's threads did in one step. */
#include "play.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define EVENTS_OF_THREAD 16384u
#define FIRST_ROOM       1024u

static void keep_failure(struct step_trace *trace, struct pccd_client *client, int status)
{
    trace->status = status;
    snprintf(trace->text, sizeof trace->text, "%s", pccd_error_text(client));
}

void step_trace_begin(struct step_trace *trace, struct pccd_client *client)
{
    trace->count = 0;
    trace->begin_ns = trace->end_ns = trace->lost = 0;
    trace->status = PCCD_OK;
    trace->text[0] = '\0';
    int status = pccd_trace_start(client, EVENTS_OF_THREAD, 0, NULL);
    if (status == PCCD_E_LIMIT) { /* of so many threads: as many as fit */
        status = pccd_trace_start(client, 0, 0, NULL);
    }
    if (status != PCCD_OK) {
        keep_failure(trace, client, status);
    }
}

static bool make_room(struct step_trace *trace, uint32_t count)
{
    uint64_t room = trace->room == 0 ? FIRST_ROOM : trace->room;
    while (room < (uint64_t)trace->count + count) {
        room *= 2;
    }
    if (room > UINT32_MAX) {
        return false;
    }
    if (room > trace->room) {
        void *grown = realloc(trace->events, room * sizeof *trace->events);
        if (grown == NULL) {
            return false;
        }
        trace->events = grown;
        trace->room = (uint32_t)room;
    }
    return true;
}

static void take(void *context, const struct pccd_trace_event *events, uint32_t count)
{
    struct step_trace *trace = context;
    if (!make_room(trace, count)) {
        trace->status = PCCD_E_NOMEM;
        return;
    }
    for (uint32_t i = 0; i < count; i++) {
        const struct pccd_trace_event *event = &events[i];
        if (event->kind >= PCCD_TRACE_REQUEST) {
            continue;
        }
        if (event->kind == PCCD_TRACE_STEP && event->begin_ns >= trace->begin_ns) {
            trace->begin_ns = event->begin_ns; /* the last one, if there are several */
            trace->end_ns = event->end_ns;
        }
        trace->events[trace->count++] = *event;
    }
}

/* The events of the step itself that can be seen. */
static void sift(struct step_trace *trace)
{
    uint64_t least_ns = (trace->end_ns - trace->begin_ns) / STEP_TRACE_PARTS;
    uint32_t kept = 0;
    for (uint32_t i = 0; i < trace->count; i++) {
        const struct pccd_trace_event *event = &trace->events[i];
        if (event->begin_ns >= trace->begin_ns && event->end_ns <= trace->end_ns &&
            event->end_ns >= event->begin_ns &&
            event->end_ns - event->begin_ns >= least_ns) {
            trace->events[kept++] = *event;
        }
    }
    trace->count = kept;
}

void step_trace_end(struct step_trace *trace, struct pccd_client *client)
{
    struct pccd_trace_info info;
    if (trace->status != PCCD_OK) {
        return;
    }
    int status = pccd_trace_stop(client, &info);
    if (status == PCCD_OK) {
        trace->lost = info.lost;
        status = pccd_trace_dump(client, take, trace);
    }
    if (status != PCCD_OK) {
        keep_failure(trace, client, status);
    }
    if (trace->status != PCCD_OK) {
        trace->count = 0;
        return;
    }
    sift(trace);
}

void step_trace_deinit(struct step_trace *trace)
{
    free(trace->events);
    memset(trace, 0, sizeof *trace);
}

/* step_trace.h - traces what a daemon's threads do during one step.
 *
 * Threads: one.
 */
#ifndef CTL_STEP_TRACE_H
#define CTL_STEP_TRACE_H

#include "pccd.h"

/* Shorter events than this part of the step are less than a pixel of any drawing. */
#define STEP_TRACE_PARTS 4000u
#define STEP_TRACE_TEXT  160u

struct step_trace {
    struct pccd_trace_event *events; /* ours; of one thread after those of another */
    uint32_t count, room;
    uint64_t begin_ns, end_ns; /* of the step; both 0: it was not recorded */
    uint64_t lost;             /* events that the daemon had no room for */
    int status;                /* why there are none: of pccd_trace_start, stop or dump */
    char text[STEP_TRACE_TEXT];
};

/* Around a step. What fails is kept in `status` and `text`: a step without a trace is
 * still a step. */
void step_trace_begin(struct step_trace *trace, struct pccd_client *client);
void step_trace_end(struct step_trace *trace, struct pccd_client *client);
void step_trace_deinit(struct step_trace *trace);

#endif

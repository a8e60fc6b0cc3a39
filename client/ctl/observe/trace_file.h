/* trace_file.h - writes a trace as a file that Perfetto and Chrome open.
 *
 * Write one track for each thread of the daemon's team and one for its loop; for each
 * client a group with as many tracks as it had requests at the same time.
 */
#ifndef CTL_TRACE_FILE_H
#define CTL_TRACE_FILE_H

#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>

#include "error.h"
#include "pccd.h"
#include "whole_file.h"

#define TRACE_EVENTS_MAX (1u << 20)
#define TRACE_MIN_US_MAX 1000000u

/* What a command was asked for. */
struct trace_options {
    const char *path; /* "-": the standard output; NULL: no recording */
    uint32_t events;  /* 0: the daemon decides */
    uint64_t min_us;
};

struct trace_file {
    const char *path;
    FILE *file;
    struct whole_file whole; /* what `file` goes to; tests give another */
    uint64_t origin_ns; /* of the file's times, CLOCK_MONOTONIC */
    uint32_t pid;       /* of the daemon */
    uint64_t count;     /* entries written */
    struct pccd_trace_info info;
    uint32_t threads; /* of the team that were seen */
    bool has_loop;
    bool is_short;                     /* of memory: requests are missing */
    struct pccd_trace_event *requests; /* ours */
    uint64_t request_count;
    uint64_t request_capacity;
};

/* Begin to record, with the file open already so that a wrong name costs nothing else. */
int trace_file_begin(struct trace_file *trace, const struct trace_options *options,
                     struct pccd_client *client, struct ctl_error *error);
/* End the recording and write the file. */
int trace_file_end(struct trace_file *trace, struct pccd_client *client,
                   struct ctl_error *error);
/* Print what the file holds, after trace_file_end. */
void trace_file_report(const struct trace_file *trace, FILE *to, bool is_json);
/* Give back what the trace has, after trace_file_begin, also when it failed; what
 * trace_file_report needs stays. */
void trace_file_deinit(struct trace_file *trace);

/* Take a page of events; a part of trace_file_end, for tests. */
void trace_file_add(void *trace_file, const struct pccd_trace_event *events,
                    uint32_t count);
/* Write what is known only after the last page; a part of it, too. */
void trace_file_finish(struct trace_file *trace, uint64_t lost);

#endif

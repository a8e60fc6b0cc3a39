/* trace_file.c - a recording as a file that Perfetto and Chrome open. */
#include "trace_file.h"

#include <inttypes.h>
#include <jansson.h>
#include <stdlib.h>
#include <time.h>

#include "clock.h"
#include "output.h"
#include "printable.h"

#define LOOP_TID   1u
#define TEAM_TID   2u         /* of the team's first thread */
#define CLIENT_PID 1000000000 /* plus the session: no process has such a number */
#define LANES_MAX  64u        /* requests of a client that are shown at a time */
#define FIRST_ROOM 4096u

static const struct {
    const char *name;
    const char *a; /* NULL: says nothing */
    const char *b;
} kinds[PCCD_TRACE_KIND_COUNT] = {
    [PCCD_TRACE_STEP] = {"step", "triangles", "threads"},
    [PCCD_TRACE_REFIT] = {"refit", "moving_vertices", NULL},
    [PCCD_TRACE_UNIT] = {"unit", "node", "triangles"},
    [PCCD_TRACE_SUBTREE] = {"subtree", "node", "triangles"},
    [PCCD_TRACE_PAIRS] = {"pairs", "node", "other"},
    [PCCD_TRACE_HIGH] = {"high-level node", "node", "pairs"},
    [PCCD_TRACE_TESTS] = {"tests", "kind", "candidates"},
    [PCCD_TRACE_REBUILD] = {"rebuild", "node", "triangles"},
    [PCCD_TRACE_BACKGROUND] = {"built in the background", "node", "triangles"},
    [PCCD_TRACE_WAIT] = {"wait", NULL, NULL},
    [PCCD_TRACE_MERGE] = {"merge", "kept_records", NULL},
    [PCCD_TRACE_REQUEST] = {NULL, NULL, "id"}, /* these have the method's name */
    [PCCD_TRACE_RECEIVE] = {"receive ", NULL, "id"},
    [PCCD_TRACE_ANSWER] = {"answer ", NULL, "id"},
};

/* ---- events ------------------------------------------------------------------------ */

/* Microseconds with the nanoseconds behind the point, which a double would round. */
static void print_us(FILE *to, uint64_t ns)
{
    fprintf(to, "%" PRIu64 ".%03u", ns / 1000, (unsigned)(ns % 1000));
}

/* The names are ours or the library's: nothing in them needs an escape. */
static void print_name(FILE *to, const struct pccd_trace_event *event)
{
    const char *name =
        event->kind < PCCD_TRACE_KIND_COUNT ? kinds[event->kind].name : "unknown";
    fputs(name != NULL ? name : "", to);
    if (event->kind >= PCCD_TRACE_REQUEST && event->kind < PCCD_TRACE_KIND_COUNT) {
        const char *method = pccd_method_name(event->a);
        fputs(method != NULL ? method : "unknown method", to);
    }
}

static void print_args(FILE *to, const struct pccd_trace_event *event)
{
    if (event->kind >= PCCD_TRACE_KIND_COUNT) {
        fprintf(to, "{\"kind\":%" PRIu32 "}", event->kind);
        return;
    }
    const char *a = kinds[event->kind].a, *b = kinds[event->kind].b;
    fputc('{', to);
    if (a != NULL) {
        fprintf(to, "\"%s\":%" PRIu32, a, event->a);
    }
    if (b != NULL) {
        fprintf(to, "%s\"%s\":%" PRIu32, a != NULL ? "," : "", b, event->b);
    }
    if (event->kind >= PCCD_TRACE_REQUEST) {
        fprintf(to, ",\"client\":%" PRIu32, event->thread);
    }
    fputc('}', to);
}

static void print_slice(struct trace_file *trace, const struct pccd_trace_event *event,
                        uint64_t pid, uint32_t tid)
{
    FILE *to = trace->file;
    /* A request that was on its way when the recording began is cut there. */
    uint64_t begin_ns =
        event->begin_ns > trace->origin_ns ? event->begin_ns : trace->origin_ns;
    uint64_t end_ns = event->end_ns > begin_ns ? event->end_ns : begin_ns;
    fprintf(to, "%s{\"ph\":\"X\",\"pid\":%" PRIu64 ",\"tid\":%" PRIu32 ",\"ts\":",
            trace->count++ == 0 ? "" : ",\n", pid, tid);
    print_us(to, begin_ns - trace->origin_ns);
    fputs(",\"dur\":", to);
    print_us(to, end_ns - begin_ns);
    fputs(",\"name\":\"", to);
    print_name(to, event);
    fputs("\",\"args\":", to);
    print_args(to, event);
    fputc('}', to);
}

/* Keep a request until all are known. */
static void keep(struct trace_file *trace, const struct pccd_trace_event *event)
{
    if (trace->request_count == trace->request_capacity) {
        uint64_t capacity =
            trace->request_capacity == 0 ? FIRST_ROOM : 2 * trace->request_capacity;
        void *grown = realloc(trace->requests, capacity * sizeof *trace->requests);
        if (grown == NULL) {
            trace->is_short = true;
            return;
        }
        trace->requests = grown;
        trace->request_capacity = capacity;
    }
    trace->requests[trace->request_count++] = *event;
}

void trace_file_add(void *trace_file, const struct pccd_trace_event *events,
                    uint32_t count)
{
    struct trace_file *trace = trace_file;
    for (uint32_t i = 0; i < count; i++) {
        struct pccd_trace_event event = events[i];
        if (event.kind == PCCD_TRACE_REQUEST) {
            keep(trace, &event);
        } else if (event.kind == PCCD_TRACE_RECEIVE || event.kind == PCCD_TRACE_ANSWER) {
            trace->has_loop = true;
            print_slice(trace, &event, trace->pid, LOOP_TID);
        } else {
            if (event.thread >= trace->threads && event.thread < UINT16_MAX) {
                trace->threads = event.thread + 1;
            }
            print_slice(trace, &event, trace->pid, TEAM_TID + event.thread);
        }
    }
}

/* ---- the clients' requests --------------------------------------------------------- */

static int by_client_and_begin(const void *left, const void *right)
{
    const struct pccd_trace_event *a = left, *b = right;
    if (a->thread != b->thread) {
        return a->thread < b->thread ? -1 : 1;
    }
    return a->begin_ns < b->begin_ns ? -1 : a->begin_ns > b->begin_ns;
}

static void print_label(struct trace_file *trace, const char *what, uint64_t pid,
                        uint32_t tid, const char *name, uint64_t number)
{
    fprintf(trace->file,
            "%s{\"ph\":\"M\",\"pid\":%" PRIu64 ",\"tid\":%" PRIu32 ",\"name\":\"%s\","
            "\"args\":{\"name\":\"%s",
            trace->count++ == 0 ? "" : ",\n", pid, tid, what, name);
    if (number != UINT64_MAX) {
        fprintf(trace->file, " %" PRIu64, number);
    }
    fputs("\"}}", trace->file);
}

/* The requests first .. end-1 of one client: each goes to the first track where the one
 * before it has ended. */
static void print_client(struct trace_file *trace, uint64_t first, uint64_t end)
{
    uint64_t ends_ns[LANES_MAX] = {0};
    uint64_t pid = CLIENT_PID + (uint64_t)trace->requests[first].thread;
    uint32_t lanes = 0;
    print_label(trace, "process_name", pid, 1, "client", trace->requests[first].thread);
    for (uint64_t i = first; i < end; i++) {
        const struct pccd_trace_event *event = &trace->requests[i];
        uint32_t lane = 0;
        while (lane + 1 < LANES_MAX && ends_ns[lane] > event->begin_ns) {
            lane++;
        }
        if (ends_ns[lane] > event->begin_ns) {
            continue; /* a daemon takes fewer at a time */
        }
        ends_ns[lane] = event->end_ns;
        lanes = lane >= lanes ? lane + 1 : lanes;
        print_slice(trace, event, pid, lane + 1);
    }
    for (uint32_t lane = 0; lane < lanes; lane++) {
        print_label(trace, "thread_name", pid, lane + 1, "requests", lane);
    }
}

void trace_file_finish(struct trace_file *trace, uint64_t lost)
{
    if (trace->request_count > 0) {
        qsort(trace->requests, trace->request_count, sizeof *trace->requests,
              by_client_and_begin);
    }
    for (uint64_t first = 0; first < trace->request_count;) {
        uint64_t end = first + 1;
        while (end < trace->request_count &&
               trace->requests[end].thread == trace->requests[first].thread) {
            end++;
        }
        print_client(trace, first, end);
        first = end;
    }
    print_label(trace, "process_name", trace->pid, LOOP_TID, "pccdd", trace->pid);
    if (trace->has_loop) {
        print_label(trace, "thread_name", trace->pid, LOOP_TID, "loop", UINT64_MAX);
    }
    for (uint32_t thread = 0; thread < trace->threads; thread++) {
        print_label(trace, "thread_name", trace->pid, TEAM_TID + thread, "team", thread);
    }
    fprintf(trace->file, "\n],\n\"otherData\":{\"lost_events\":%" PRIu64 "}}\n", lost);
}

/* ---- recording --------------------------------------------------------------------- */

static int fail(struct pccd_client *client, int status, struct ctl_error *error)
{
    return ctl_error_set(error, status, "trace: %s", pccd_error_text(client));
}

int trace_file_begin(struct trace_file *trace, const struct trace_options *options,
                     struct pccd_client *client, struct ctl_error *error)
{
    *trace = (struct trace_file){.path = options->path};
    int status = output_open(&trace->whole, options->path, true, error);
    if (status != PCCD_OK) {
        return status;
    }
    trace->file = trace->whole.to;
    trace->pid = pccd_daemon_pid(client);
    trace->origin_ns = common_now_ns();
    fputs("{\"displayTimeUnit\":\"ms\",\n\"traceEvents\":[\n", trace->file);
    status = pccd_trace_start(client, options->events, options->min_us * 1000, NULL);
    return status == PCCD_OK ? PCCD_OK : fail(client, status, error);
}

int trace_file_end(struct trace_file *trace, struct pccd_client *client,
                   struct ctl_error *error)
{
    int status = pccd_trace_stop(client, &trace->info);
    if (status == PCCD_OK) {
        status = pccd_trace_dump(client, trace_file_add, trace);
    }
    if (status != PCCD_OK) {
        return fail(client, status, error);
    }
    trace_file_finish(trace, trace->info.lost);
    if (trace->is_short) {
        return ctl_error_set(error, PCCD_E_NOMEM, "no memory for the clients' requests");
    }
    trace->file = NULL;
    return output_finish(&trace->whole, trace->path, error);
}

void trace_file_report(const struct trace_file *trace, FILE *to, bool is_json)
{
    if (is_json) {
        json_t *object = json_pack("{s:o, s:I, s:I}", "file", json_text(trace->path),
                                   "events", (json_int_t)trace->info.events, "lost",
                                   (json_int_t)trace->info.lost);
        (void)output_json(object, true, to);
        return;
    }
    fprintf(to, "trace      %s: %" PRIu64 " %s\n", tool_shown(trace->path),
            trace->info.events, proto_plural(trace->info.events, "event", "events"));
    if (trace->info.lost > 0) {
        fprintf(to,
                "           %" PRIu64 " %s lost: leave out more with "
                "--min-us, or keep more with --events\n",
                trace->info.lost,
                proto_plural(trace->info.lost, "older one was", "older ones were"));
    }
}

void trace_file_deinit(struct trace_file *trace)
{
    if (trace->file != NULL && trace->file != trace->whole.to) {
        fclose(trace->file);
    }
    whole_file_discard(&trace->whole);
    free(trace->requests);
    trace->file = NULL;
    trace->requests = NULL;
}

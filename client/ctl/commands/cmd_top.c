/* client/ctl/commands/cmd_top.c - pccdctl top.
 *
 * Room:     client/ctl.
 * Does:     tells again and again what the clients of a daemon do: steps a second,
 *           milliseconds a step by phase, bytes.
 * Does not: draw over what is there, unless the standard output is a terminal.
 * Threads:  one.
 * Source:   sessions.h; the manner of pw-top.
 */
#include <inttypes.h>
#include <jansson.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "counters.h"
#include "ctl.h"
#include "format.h"
#include "link.h"
#include "sessions.h"
#include "terminal.h"

#define COUNT_MAX        1000000000u
#define INTERVAL_DEFAULT 1.0
#define ROWS_MAX         10000
#define LINE_MAX_CHARS   300u

enum { OPTION_ONCE = 256 + 64, OPTION_COUNT, OPTION_INTERVAL, OPTION_SORT, OPTION_JSON };

enum sort { SORT_ms, SORT_steps, SORT_triangles, SORT_bytes, SORT_queue, SORT_COUNT };
static const char *const sort_names[] = {"ms", "steps", "triangles", "bytes", "queue"};

struct top_options {
    struct ctl_link link;
    uint64_t count; /* 0: for ever */
    double interval_s;
    enum sort sort;
    bool is_json;
};

static const struct argp_option option_list[] = {
    {"once", OPTION_ONCE, NULL, 0, "The same as --count 1", 0},
    {"count", OPTION_COUNT, "N", 0,
     "End after N times (default: on a terminal for ever, otherwise 1)", 0},
    {"interval", OPTION_INTERVAL, "SECONDS", 0, "Between them (default: 1)", 0},
    {"sort", OPTION_SORT, "ms|steps|triangles|bytes|queue", 0,
     "What the busiest session is: milliseconds of computing (the default), steps, "
     "triangles, bytes in and out, or requests in flight",
     0},
    {"json", OPTION_JSON, NULL, 0, "One JSON object a time, each on a line", 0},
    {0},
};

static error_t parse(int key, char *text, struct argp_state *state)
{
    struct top_options *options = state->input;
    switch (key) {
    case ARGP_KEY_INIT:
        state->child_inputs[0] = &options->link;
        return 0;
    case OPTION_ONCE:
        options->count = 1;
        return 0;
    case OPTION_COUNT:
        options->count = ctl_option_count(state, "count", text, 1, COUNT_MAX);
        return 0;
    case OPTION_INTERVAL:
        options->interval_s = ctl_option_real(state, "interval", text, 0.01, 3600.0);
        return 0;
    case OPTION_SORT:
        options->sort =
            (enum sort)ctl_option_name(state, "sort", text, sort_names, SORT_COUNT);
        return 0;
    case OPTION_JSON:
        options->is_json = true;
        return 0;
    default:
        return ARGP_ERR_UNKNOWN;
    }
}

static const struct argp_child children[] = {{&ctl_link_argp, 0, "Daemon:", 10}, {0}};
const struct argp ctl_argp_top = {
    .options = option_list,
    .parser = parse,
    .doc = "Tell again and again what the clients of a daemon do: those of this user, or "
           "all of them for the daemon's own user and root.\v"
           "A step's milliseconds are those of the compute thread. An interrupt (Ctrl-C) "
           "ends it.",
    .children = children};

/* ---- what is told ------------------------------------------------------------------ */

enum phase { INGEST, REFIT, TRAVERSAL, TESTS, MERGE, PHASE_COUNT };
static const char *const phase_names[] = {"ingest", "refit", "traversal", "tests",
                                          "merge"};

/* What a session has done between two looks. */
struct rate {
    const struct session_row *row; /* of the later one */
    double steps_per_s, in_per_s, out_per_s;
    double ms_per_s; /* of computing */
    double ms_step;  /* a step; 0 without any */
    double ms_phase[PHASE_COUNT];
};

static void read_phases(const struct pccd_session_info *info, uint64_t ns[PHASE_COUNT])
{
    ns[INGEST] = info->ns_ingest;
    ns[REFIT] = info->ns_refit;
    ns[TRAVERSAL] = info->ns_traversal;
    ns[TESTS] = info->ns_tests;
    ns[MERGE] = info->ns_merge;
}

static struct rate rate_of(const struct session_row *now, const struct session_row *then,
                           double seconds)
{
    static const struct pccd_session_info nothing;
    const struct pccd_session_info *a = then != NULL ? &then->info : &nothing;
    const struct pccd_session_info *b = &now->info;
    uint64_t before[PHASE_COUNT], after[PHASE_COUNT];
    double steps = (double)(b->steps - a->steps);
    struct rate rate = {.row = now,
                        .steps_per_s = steps / seconds,
                        .in_per_s = (double)(b->upload_bytes - a->upload_bytes) / seconds,
                        .out_per_s =
                            (double)(b->result_bytes - a->result_bytes) / seconds,
                        .ms_per_s = (double)(b->ns_step - a->ns_step) / 1e6 / seconds};
    read_phases(a, before);
    read_phases(b, after);
    for (int i = 0; i < PHASE_COUNT && steps > 0; i++) {
        rate.ms_phase[i] = (double)(after[i] - before[i]) / 1e6 / steps;
    }
    rate.ms_step = steps > 0 ? (double)(b->ns_step - a->ns_step) / 1e6 / steps : 0;
    return rate;
}

static double key_of(const struct rate *rate, enum sort sort)
{
    switch (sort) {
    case SORT_steps:
        return rate->steps_per_s;
    case SORT_triangles:
        return (double)rate->row->info.triangles;
    case SORT_bytes:
        return rate->in_per_s + rate->out_per_s;
    case SORT_queue:
        return rate->row->info.requests;
    default:
        return rate->ms_per_s;
    }
}

static int compare(const void *a, const void *b, void *context)
{
    const struct rate *ra = a, *rb = b;
    enum sort sort = *(const enum sort *)context;
    double ka = key_of(ra, sort), kb = key_of(rb, sort);
    if (ka != kb) {
        return ka > kb ? -1 : 1;
    }
    uint64_t ia = ra->row->info.session, ib = rb->row->info.session;
    return ia < ib ? -1 : ia > ib;
}

/* ---- output ------------------------------------------------------------------------ */

/* What the table may take: all it needs, or on a screen that is drawn anew what that
 * has. */
struct room {
    uint32_t columns; /* of a line */
    uint32_t sessions;
};

static struct room find_room(bool is_redrawn)
{
    struct room room = {LINE_MAX_CHARS, ROWS_MAX};
    uint32_t rows;
    if (is_redrawn) {
        terminal_size(STDOUT_FILENO, &room.columns, &rows);
        room.sessions = rows < 6 ? ROWS_MAX : rows - 4u;
    }
    return room;
}

/* A line, or what of it fits. */
static void print_line(const struct room *room, const char *begin, const char *end,
                       const char *format, ...) __attribute__((format(printf, 4, 5)));
static void print_line(const struct room *room, const char *begin, const char *end,
                       const char *format, ...)
{
    char line[LINE_MAX_CHARS + 1];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(line, sizeof line, format, arguments);
    va_end(arguments);
    printf("%s%.*s%s\n", begin, (int)room->columns, line, end);
}

static void print_table(const struct rate *rates, uint32_t count,
                        const struct counters *counters, const struct room *room)
{
    uint32_t shown = count < room->sessions ? count : room->sessions;
    print_line(room, "", "",
               "%" PRIu32 " sessions; %s requests wait; engine %s, shared %s", count,
               format_count((double)counters_get(counters, "jobs_queued_now")),
               format_bytes((double)counters_get(counters, "engine_bytes_now")),
               format_bytes((double)counters_get(counters, "shm_bytes_now")));
    print_line(room, terminal_begin(TERMINAL_BOLD), terminal_end(),
               "%7s %7s %-8s %-16s %6s %7s %8s %8s %7s %7s %7s %7s %7s %5s %9s %9s",
               "SESSION", "PID", "USER", "CLIENT", "SCENES", "TRIANG", "STEPS/S",
               "MS/STEP", "INGEST", "REFIT", "TRAVERS", "TESTS", "MERGE", "QUEUE", "IN/S",
               "OUT/S");
    for (uint32_t i = 0; i < shown; i++) {
        const struct rate *rate = &rates[i];
        const struct pccd_session_info *info = &rate->row->info;
        print_line(room, "", "",
                   "%7" PRIu64 " %7" PRIu32 " %-8.8s %-16.16s %6" PRIu32
                   " %7s %8.1f %8.3f %7.3f %7.3f %7.3f %7.3f %7.3f %5" PRIu32
                   " %9s %9s%s",
                   info->session, info->pid, format_user(info->uid),
                   format_name(rate->row->name), info->scenes,
                   format_count((double)info->triangles), rate->steps_per_s,
                   rate->ms_step, rate->ms_phase[INGEST], rate->ms_phase[REFIT],
                   rate->ms_phase[TRAVERSAL], rate->ms_phase[TESTS],
                   rate->ms_phase[MERGE], info->requests, format_bytes(rate->in_per_s),
                   format_bytes(rate->out_per_s), info->waiting ? " waits" : "");
    }
    if (shown < count) {
        print_line(room, "", "", "and %" PRIu32 " more", count - shown);
    }
}

static json_t *session_json(const struct rate *rate)
{
    const struct pccd_session_info *info = &rate->row->info;
    json_t *phases = json_object();
    for (int i = 0; i < PHASE_COUNT; i++) {
        json_object_set_new(phases, phase_names[i], json_real(rate->ms_phase[i]));
    }
    return json_pack(
        "{s:I, s:I, s:I, s:s, s:I, s:I, s:I, s:I, s:f, s:f, s:o, s:I, s:f, s:f, s:b}",
        "session", (json_int_t)info->session, "pid", (json_int_t)info->pid, "uid",
        (json_int_t)info->uid, "client", rate->row->name, "scenes",
        (json_int_t)info->scenes, "objects", (json_int_t)info->objects, "triangles",
        (json_int_t)info->triangles, "steps", (json_int_t)info->steps, "steps_per_s",
        rate->steps_per_s, "ms_step", rate->ms_step, "ms", phases, "requests",
        (json_int_t)info->requests, "in_per_s", rate->in_per_s, "out_per_s",
        rate->out_per_s, "waiting", info->waiting);
}

static void print_json(const struct rate *rates, uint32_t count,
                       const struct counters *counters)
{
    json_t *sessions = json_array();
    for (uint32_t i = 0; i < count; i++) {
        json_array_append_new(sessions, session_json(&rates[i]));
    }
    json_t *object = json_pack(
        "{s:I, s:I, s:I, s:o}", "jobs_queued",
        (json_int_t)counters_get(counters, "jobs_queued_now"), "engine_bytes",
        (json_int_t)counters_get(counters, "engine_bytes_now"), "shm_bytes",
        (json_int_t)counters_get(counters, "shm_bytes_now"), "sessions", sessions);
    json_dumpf(object, stdout, JSON_COMPACT);
    putchar('\n');
    json_decref(object);
}

/* ---- the command ------------------------------------------------------------------- */

static bool print(const struct sessions *now, const struct sessions *then, double seconds,
                  const struct counters *counters, const struct top_options *options)
{
    enum sort sort = options->sort;
    struct rate *rates = calloc(now->count + 1u, sizeof *rates);
    if (rates == NULL) {
        return false;
    }
    for (uint32_t i = 0; i < now->count; i++) {
        const struct session_row *row = &now->rows[i];
        rates[i] = rate_of(row, sessions_find(then, row->info.session), seconds);
    }
    qsort_r(rates, now->count, sizeof *rates, compare, &sort);
    if (options->is_json) {
        print_json(rates, now->count, counters);
    } else {
        bool is_redrawn = terminal_is_live() && options->count != 1;
        struct room room = find_room(is_redrawn);
        if (is_redrawn) {
            terminal_redraw();
        }
        print_table(rates, now->count, counters, &room);
    }
    fflush(stdout);
    free(rates);
    return ferror(stdout) == 0;
}

static int run(struct pccd_client *client, const struct top_options *options)
{
    struct sessions looks[2] = {{.rows = NULL}, {.rows = NULL}};
    struct counters counters;
    uint32_t turn = 0;
    int status = sessions_read(client, &looks[0]);
    double then_s = terminal_now_s();
    bool goes_on = true;
    for (uint64_t i = 0;
         status == PCCD_OK && goes_on && (options->count == 0 || i < options->count);
         i++) {
        terminal_sleep(options->interval_s);
        if (terminal_was_interrupted()) {
            break;
        }
        turn = 1 - turn;
        status = sessions_read(client, &looks[turn]);
        double now_s = terminal_now_s();
        if (status == PCCD_OK) {
            status = counters_read(client, &counters);
        }
        if (status == PCCD_OK) {
            goes_on =
                print(&looks[turn], &looks[1 - turn], now_s - then_s, &counters, options);
        }
        then_s = now_s;
    }
    sessions_deinit(&looks[0]);
    sessions_deinit(&looks[1]);
    return status == PCCD_OK ? CTL_DONE
                             : ctl_complain("top: %s", pccd_error_text(client));
}

int ctl_cmd_top(int argc, char **argv)
{
    struct top_options options = {.link = {.policy = CTL_LINK_EXISTING},
                                  .interval_s = INTERVAL_DEFAULT};
    struct pccd_client *client = NULL;
    if (argp_parse(&ctl_argp_top, argc, argv, 0, NULL, &options) != 0) {
        return CTL_USAGE;
    }
    if (options.count == 0 && !terminal_is_live() && !options.is_json) {
        options.count = 1;
    }
    int status = ctl_link_open(&options.link, &client);
    if (status == CTL_DONE) {
        terminal_catch_interrupts();
        status = run(client, &options);
    }
    pccd_close(client);
    ctl_link_deinit(&options.link);
    return status;
}

/* cmd_top.c - pccdctl top. */
#include <inttypes.h>
#include <jansson.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "columns.h"
#include "counters.h"
#include "ctl.h"
#include "link.h"
#include "printable.h"
#include "sessions.h"
#include "terminal.h"

#define COUNT_MAX        1000000000u
#define INTERVAL_DEFAULT 1.0
#define ROWS_MAX         10000
#define NAME_COLUMNS     16u

enum sort { SORT_ms, SORT_steps, SORT_triangles, SORT_bytes, SORT_queue };

struct top_options {
    struct ctl_link link;
    uint64_t count; /* 0: for ever */
    double interval_s;
    enum sort sort;
    bool is_json;
};

static void take_once(struct argp_state *state, const struct option_row *row,
                      const char *text, void *to)
{
    struct top_options *options = to;
    (void)state;
    (void)row;
    (void)text;
    options->count = 1;
}

#define AT(member) offsetof(struct top_options, member)
static const struct option_row rows[] = {
    CTL_OUTPUT,
    {"once", 0, NULL, "The same as --count 1", OPTION_OWN, .take = take_once},
    {"count", 0, "N", "End after N tables (default: on a terminal never, otherwise 1)",
     OPTION_U64, .at = AT(count), .min = 1, .max = COUNT_MAX},
    {"interval", 0, "SECONDS", "Time between two tables (default: 1)", OPTION_REAL,
     .at = AT(interval_s), .min = 0.01, .max = 3600},
    {"sort", 0, "ms|steps|triangles|bytes|queue",
     "Put the busiest session first, by milliseconds of computing (the default), steps, "
     "triangles, bytes in and out, or requests in flight",
     OPTION_WORD, .at = AT(sort)},
    {"json", 0, NULL, "One JSON object instead of each table, on a line of its own",
     OPTION_FLAG, .at = AT(is_json)},
    {0}};

const struct option_table ctl_table_top = {
    .rows = rows,
    .parts = (const struct option_part[]){{&ctl_link_table, AT(link)}, {0}},
    .text = "Show what the clients of a daemon do, again and again: those of this "
            "user, or all of them for the daemon's own user and root.",
    .more = "A step's milliseconds are those of the compute thread. A terminal that "
            "is too narrow for all columns shows the most important ones. The key q or "
            "an interrupt (Ctrl-C) ends it.",
    .examples = "  pccdctl top\n"
                "  pccdctl top --once --sort triangles\n",
};

/* ---- what is told ------------------------------------------------------------------ */

enum phase { INGEST, REFIT, TRAVERSAL, TESTS, MERGE, PHASE_COUNT };

/* Work of a session between two looks. */
struct rate {
    struct session_row row; /* of the later one */
    double steps_per_s, in_per_s, out_per_s;
    double ms_per_s; /* of computing */
    double ms_step;  /* a step; 0 without any */
    double ms_phase[PHASE_COUNT];
    json_t *phases; /* the same, while it is printed as JSON */
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
    struct rate rate = {.row = *now,
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
        return (double)rate->row.info.triangles;
    case SORT_bytes:
        return rate->in_per_s + rate->out_per_s;
    case SORT_queue:
        return rate->row.info.requests;
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
    uint64_t ia = ra->row.info.session, ib = rb->row.info.session;
    return ia < ib ? -1 : ia > ib;
}

/* ---- output ------------------------------------------------------------------------ */

/* Return how many sessions there is room for. */
static uint32_t find_room(bool is_redrawn)
{
    uint32_t columns, lines = 0;
    if (is_redrawn) {
        terminal_size(STDOUT_FILENO, &columns, &lines);
    }
    return lines < 7 ? ROWS_MAX : lines - 5u; /* two of sums from 40 columns on */
}

#define OF(member) COLUMN_OF(struct rate, member)
static const struct column phase_columns[] = {
    {"ingest", .type = COLUMN_REAL, OF(ms_phase[INGEST])},
    {"refit", .type = COLUMN_REAL, OF(ms_phase[REFIT])},
    {"traversal", .type = COLUMN_REAL, OF(ms_phase[TRAVERSAL])},
    {"tests", .type = COLUMN_REAL, OF(ms_phase[TESTS])},
    {"merge", .type = COLUMN_REAL, OF(ms_phase[MERGE])},
    {0}};

/* Narrow terminals show those of the first ranks. */
static const struct column session_columns[] = {
    {"session", "SESSION", COLUMN_NUMBER, OF(row.info.session), .rank = 1},
    {"pid", "PID", COLUMN_NUMBER, OF(row.info.pid), .rank = 7},
    {"uid", "USER", COLUMN_USER, OF(row.info.uid), .is_left = true, .rank = 9},
    {"client", "CLIENT", COLUMN_CHARS, OF(row.name), .is_left = true, .cut = NAME_COLUMNS,
     .rank = 2},
    {"scenes", "SCENES", COLUMN_NUMBER, OF(row.info.scenes), .rank = 12},
    {"objects", .type = COLUMN_NUMBER, OF(row.info.objects)},
    {"triangles", "TRIANG", COLUMN_COUNT, OF(row.info.triangles), .rank = 5},
    {"steps", .type = COLUMN_NUMBER, OF(row.info.steps)},
    {"steps_per_s", "STEPS/S", COLUMN_REAL_1, OF(steps_per_s), .rank = 4},
    {"ms_step", "MS/STEP", COLUMN_REAL_3, OF(ms_step), .rank = 3},
    {NULL, "INGEST", COLUMN_REAL_3, OF(ms_phase[INGEST]), .rank = 16},
    {NULL, "REFIT", COLUMN_REAL_3, OF(ms_phase[REFIT]), .rank = 15},
    {NULL, "TRAVERS", COLUMN_REAL_3, OF(ms_phase[TRAVERSAL]), .rank = 14},
    {NULL, "TESTS", COLUMN_REAL_3, OF(ms_phase[TESTS]), .rank = 13},
    {NULL, "MERGE", COLUMN_REAL_3, OF(ms_phase[MERGE]), .rank = 17},
    {"ms", .type = COLUMN_JSON, OF(phases)},
    {"requests", "QUEUE", COLUMN_NUMBER, OF(row.info.requests), .rank = 8},
    {"in_per_s", "IN/S", COLUMN_RATE, OF(in_per_s), .rank = 10},
    {"out_per_s", "OUT/S", COLUMN_RATE, OF(out_per_s), .rank = 11},
    {NULL, "", COLUMN_CHARS, OF(row.state), .is_left = true, .rank = 6},
    {"waiting", .type = COLUMN_FLAG, OF(row.info.waiting)},
    {"batch", .type = COLUMN_NUMBER, OF(row.info.batch)},
    {"batch_done", .type = COLUMN_NUMBER, OF(row.info.batch_done)},
    {0}};
#undef OF

static void print_table(const struct rate *rates, uint32_t count,
                        const struct counters *counters, uint32_t room)
{
    uint64_t queued = counters_get(counters, "jobs_queued_now");
    uint32_t shown = count < room ? count : room;
    fprintf(columns_fitted(stdout),
            "%" PRIu32 " %s; %s %s; engine %s, shared %s\n", count,
            proto_plural(count, "session", "sessions"), format_count((double)queued),
            proto_plural(queued, "request waits", "requests wait"),
            format_bytes((double)counters_get(counters, "engine_bytes_now")),
            format_bytes((double)counters_get(counters, "shm_bytes_now")));
    columns_table(session_columns, rates, sizeof *rates, shown, false);
    if (shown < count) {
        printf("and %" PRIu32 " more\n", count - shown);
    }
}

static void print_json(struct rate *rates, uint32_t count,
                       const struct counters *counters)
{
    json_t *sessions = json_array();
    for (uint32_t i = 0; i < count; i++) {
        rates[i].phases = columns_json(phase_columns, &rates[i]);
        json_array_append_new(sessions, columns_json(session_columns, &rates[i]));
    }
    json_t *object = json_pack(
        "{s:I, s:I, s:I, s:o}", "jobs_queued",
        (json_int_t)counters_get(counters, "jobs_queued_now"), "engine_bytes",
        (json_int_t)counters_get(counters, "engine_bytes_now"), "shm_bytes",
        (json_int_t)counters_get(counters, "shm_bytes_now"), "sessions", sessions);
    json_dumpf(object, stdout, JSON_COMPACT | JSON_ENSURE_ASCII);
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
        if (is_redrawn) {
            terminal_redraw();
        }
        print_table(rates, now->count, counters, find_room(is_redrawn));
    }
    fflush(stdout);
    free(rates);
    return ferror(stdout) == 0;
}

static int look_again(struct pccd_client *client, const struct top_options *options)
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
        terminal_wait(options->interval_s);
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

static int run(struct pccd_client *client, void *to)
{
    struct top_options *options = to;
    if (options->count == 0 && !terminal_is_live() && !options->is_json) {
        options->count = 1;
    }
    terminal_catch_interrupts();
    if (terminal_is_live()) {
        terminal_take_keys();
    }
    int status = look_again(client, options);
    terminal_free_keys();
    return status;
}

int ctl_cmd_top(int argc, char **argv)
{
    struct top_options options = {.link = {.policy = CTL_LINK_EXISTING, .observes = true},
                                  .interval_s = INTERVAL_DEFAULT};
    return ctl_link_command(&ctl_table_top, argc, argv, &options.link, run);
}

/* cmd_stats.c - pccdctl stats. */
#include <inttypes.h>
#include <jansson.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "ctl.h"
#include "link.h"
#include "output.h"
#include "printable.h"
#include "report.h"
#include "shown.h"

/* ---- What each thread of the daemon's last step did. */

#define COUNTERS_MAX 64u
#define TRIES        20

/* One thread's counters, in the order in which the library gives them. */
struct row {
    uint32_t count;
    const char *name[COUNTERS_MAX]; /* the library's, for ever */
    uint64_t value[COUNTERS_MAX];
};

struct table {
    struct row *rows; /* ours, [count] */
    uint32_t count;
    char tuning[PCCD_TUNING_BYTES]; /* how they shared the work */
};

static uint64_t value_of(const struct row *row, const char *name)
{
    for (uint32_t i = 0; i < row->count; i++) {
        if (strcmp(row->name[i], name) == 0) {
            return row->value[i];
        }
    }
    return 0;
}

/* What a step has not, but a batch, is left out of a step. */
static void collect(void *context, const char *name, uint64_t value, const char *text)
{
    struct row *row = context;
    (void)text;
    bool is_of_batch = strcmp(name, "scenes") == 0;
    if (row->count < COUNTERS_MAX && (!is_of_batch || value_of(row, "batch") > 0)) {
        row->name[row->count] = name;
        row->value[row->count++] = value;
    }
}

/* "ns_low" is of the step, "low_ns" of a thread; what comes before the first time says
 * which step it was; everything else counts a thread's work. */
enum kind { KIND_STEP, KIND_PHASE, KIND_TIME, KIND_WORK };

static enum kind kind_of(const struct row *row, uint32_t at)
{
    const char *name = row->name[at];
    size_t length = strlen(name);
    if (strncmp(name, "ns_", 3) == 0) {
        return KIND_PHASE;
    }
    if (length > 3 && strcmp(name + length - 3, "_ns") == 0) {
        return KIND_TIME;
    }
    for (uint32_t i = 0; i < at; i++) {
        if (strncmp(row->name[i], "ns_", 3) == 0) {
            return KIND_WORK;
        }
    }
    return KIND_STEP;
}

/* ---- reading ----------------------------------------------------------------------- */

/* All threads of one step; PCCD_E_BUSY when another came between. */
static int read_once(struct pccd_client *client, struct table *table)
{
    struct row first = {.count = 0};
    int status = pccd_stats_thread(client, true, 0, collect, &first, table->tuning);
    if (status != PCCD_OK) {
        return status;
    }
    uint32_t threads = (uint32_t)value_of(&first, "threads");
    free(table->rows);
    table->count = 0;
    table->rows = calloc((size_t)threads + 1, sizeof *table->rows);
    if (table->rows == NULL) {
        return PCCD_E_NOMEM;
    }
    table->rows[0] = first;
    for (uint32_t i = 1; i < threads; i++) {
        struct row *row = &table->rows[i];
        status = pccd_stats_thread(client, true, i, collect, row, NULL);
        if (status == PCCD_E_INVAL) {
            return PCCD_E_BUSY; /* a step of fewer threads */
        }
        if (status != PCCD_OK) {
            return status;
        }
        if (value_of(row, "number") != value_of(&first, "number")) {
            return PCCD_E_BUSY;
        }
    }
    table->count = threads;
    return PCCD_OK;
}

static int read_table(struct pccd_client *client, struct table *table)
{
    int status = PCCD_E_BUSY;
    for (int i = 0; i < TRIES && status == PCCD_E_BUSY; i++) {
        status = read_once(client, table);
    }
    return status;
}

/* ---- printing ---------------------------------------------------------------------- */

static void print_step(FILE *to, const struct table *table)
{
    const struct row *row = &table->rows[0];
    uint64_t threads = value_of(row, "threads");
    uint64_t batch = value_of(row, "batch");
    if (batch > 0) {
        fprintf(to, "batch of %" PRIu64 " %s up to ", batch,
                proto_plural(batch, "scene", "scenes"));
    }
    fprintf(to, "step %" PRIu64 " by %" PRIu64 " %s", value_of(row, "number"), threads,
            proto_plural(threads, "thread", "threads"));
    if (table->tuning[0] != '\0') {
        fprintf(to, ", tuning %s", tool_shown(table->tuning));
    }
    fputs("\n\n", to);
    for (uint32_t i = 0; i < row->count; i++) {
        if (kind_of(row, i) == KIND_PHASE) {
            fprintf(to, "  %-10s %12.3f ms\n", row->name[i] + 3,
                    (double)row->value[i] / 1e6);
        }
    }
}

/* One table of the counters of one kind: a line for each thread. */
static void print_kind(FILE *to, const struct table *table, enum kind kind)
{
    const struct row *first = &table->rows[0];
    fputs("\nthread", to);
    for (uint32_t i = 0; i < first->count; i++) {
        if (kind_of(first, i) == kind) {
            size_t length = strlen(first->name[i]) - (kind == KIND_TIME ? 3 : 0);
            fprintf(to, " %*.*s", length > 10 ? (int)length : 10, (int)length,
                    first->name[i]);
        }
    }
    fputs(kind == KIND_TIME ? "   (ms)\n" : "\n", to);
    for (uint32_t thread = 0; thread < table->count; thread++) {
        const struct row *row = &table->rows[thread];
        fprintf(to, "%6" PRIu32, thread);
        for (uint32_t i = 0; i < row->count; i++) {
            size_t length = strlen(row->name[i]);
            int width = length > 10 ? (int)length : 10;
            if (kind_of(row, i) != kind) {
                continue;
            }
            if (kind == KIND_TIME) {
                width = length > 13 ? (int)length - 3 : 10;
                fprintf(to, " %*.3f", width, (double)row->value[i] / 1e6);
            } else {
                fprintf(to, " %*" PRIu64, width, row->value[i]);
            }
        }
        fputc('\n', to);
    }
}

/* The step's own numbers at the top, an object for each thread in "thread_records". */
static int print_threads_json(FILE *to, const struct table *table)
{
    json_t *object = json_object();
    json_t *array = json_array();
    const struct row *first = &table->rows[0];
    json_object_set_new(object, "tuning",
                        table->tuning[0] != '\0' ? json_text(table->tuning)
                                                 : json_null());
    for (uint32_t i = 0; i < first->count; i++) {
        if (kind_of(first, i) == KIND_STEP || kind_of(first, i) == KIND_PHASE) {
            json_object_set_new(object, first->name[i],
                                json_integer((json_int_t)first->value[i]));
        }
    }
    for (uint32_t thread = 0; thread < table->count; thread++) {
        const struct row *row = &table->rows[thread];
        json_t *element = json_object();
        for (uint32_t i = 0; i < row->count; i++) {
            if (kind_of(row, i) == KIND_WORK || kind_of(row, i) == KIND_TIME) {
                json_object_set_new(element, row->name[i],
                                    json_integer((json_int_t)row->value[i]));
            }
        }
        json_array_append_new(array, element);
    }
    bool ok = json_object_set_new(object, "thread_records", array) == 0;
    return output_json(object, ok, to) ? PCCD_OK : PCCD_E_NOMEM;
}

/* Print what each thread of the daemon did in its last step. Returns a status;
 * pccd_error_text says more. E_BUSY: steps come so fast that no step's threads could be
 * read as a whole. */
static int stats_threads_print(struct pccd_client *client, FILE *to, bool is_json)
{
    struct table table = {.rows = NULL, .tuning = ""};
    int status = read_table(client, &table);
    if (status == PCCD_OK && is_json) {
        status = print_threads_json(to, &table);
    } else if (status == PCCD_OK && table.count == 0) {
        fputs("no step yet\n", to);
    } else if (status == PCCD_OK) {
        print_step(to, &table);
        print_kind(to, &table, KIND_WORK);
        print_kind(to, &table, KIND_TIME);
    }
    free(table.rows);
    return status;
}

/* ---- The command. */

struct stats_options {
    struct ctl_link link;
    bool is_json;
    bool of_threads;
};

static const struct option_row rows[] = {
    CTL_OUTPUT,
    {"threads", 0, NULL,
     "Show what each thread of the daemon's last step did, instead of the counters",
     OPTION_FLAG, .at = offsetof(struct stats_options, of_threads)},
    {"json", 0, NULL, "One JSON object with a member for each counter", OPTION_FLAG,
     .at = offsetof(struct stats_options, is_json)},
    {0}};

const struct option_table ctl_table_stats = {
    .rows = rows,
    .parts =
        (const struct option_part[]){
            {&ctl_link_table, offsetof(struct stats_options, link)}, {0}},
    .text = "List the daemon's counters.",
    .examples = "  pccdctl stats\n"
                "  pccdctl stats --threads\n",
};

/* The library says no name's length beforehand, so the list is walked twice: once for the
 * widths, once to print. The second walk asks again; its values are the later ones. */
struct widths {
    int name, value;
};

/* What is printed besides the counters. */
static const char cpu_text[] = "instruction set that steps use";
static const char share_text[] =
    "of the candidates, the share that took exact arithmetic";

struct shares {
    uint64_t exact, candidates;
};

struct listing {
    struct widths widths;
    struct shares shares;
};

static void widen(struct widths *widths, int name, int value)
{
    widths->name = name > widths->name ? name : widths->name;
    widths->value = value > widths->value ? value : widths->value;
}

static void measure(void *context, const char *name, uint64_t value, const char *text)
{
    struct listing *listing = context;
    (void)text;
    widen(&listing->widths, (int)strlen(name), snprintf(NULL, 0, "%" PRIu64, value));
}

static void note_share(struct shares *shares, const char *name, uint64_t value)
{
    if (strcmp(name, "exact") == 0) {
        shares->exact = value;
    } else if (strcmp(name, "candidates") == 0) {
        shares->candidates = value;
    }
}

/* 0 before the first candidate. */
static double share(const struct shares *shares)
{
    return shares->candidates ? (double)shares->exact / (double)shares->candidates : 0;
}

static void print_line(void *context, const char *name, uint64_t value, const char *text)
{
    struct listing *listing = context;
    note_share(&listing->shares, name, value);
    printf("%-*s  %*" PRIu64 "  %s\n", listing->widths.name, name, listing->widths.value,
           value, text);
}

struct members {
    json_t *object;
    struct shares shares;
};

static void add_member(void *context, const char *name, uint64_t value, const char *text)
{
    struct members *members = context;
    (void)text;
    note_share(&members->shares, name, value);
    json_object_set_new(members->object, name, json_integer((json_int_t)value));
}

static int print_json(struct pccd_client *client)
{
    struct members members = {.object = json_object()};
    int status = pccd_stats(client, add_member, &members);
    if (status == PCCD_OK) {
        json_object_set_new(members.object, "exact_share",
                            json_real(share(&members.shares)));
        json_object_set_new(members.object, "cpu", json_string(pccd_daemon_cpu(client)));
        (void)output_json(members.object, true, stdout);
    } else {
        json_decref(members.object);
    }
    return status;
}

static int print_list(struct pccd_client *client)
{
    struct listing listing = {{0, 0}, {0, 0}};
    const struct widths *widths = &listing.widths;
    const char *cpu = pccd_daemon_cpu(client);
    char number[32];
    int status = pccd_stats(client, measure, &listing);
    widen(&listing.widths, (int)strlen("exact_share"), (int)strlen(cpu));
    if (status == PCCD_OK) {
        status = pccd_stats(client, print_line, &listing);
    }
    if (status == PCCD_OK) {
        snprintf(number, sizeof number, "%.4g", share(&listing.shares));
        printf("%-*s  %*s  %s\n", widths->name, "exact_share", widths->value, number,
               share_text);
        printf("%-*s  %*s  %s\n", widths->name, "cpu", widths->value, tool_shown(cpu),
               cpu_text);
    }
    return status;
}

static int print(struct pccd_client *client, const struct stats_options *options)
{
    if (options->of_threads) {
        return stats_threads_print(client, stdout, options->is_json);
    }
    return options->is_json ? print_json(client) : print_list(client);
}

int ctl_cmd_stats(int argc, char **argv)
{
    struct stats_options options = {
        .link = {.policy = CTL_LINK_EXISTING, .observes = true}};
    struct pccd_client *client = NULL;
    if (option_parse(&ctl_table_stats, argc, argv, &options) != 0) {
        return CTL_USAGE;
    }
    int status = ctl_link_open(&options.link, &client);
    if (status == CTL_DONE && print(client, &options) != PCCD_OK) {
        status = ctl_complain("stats: %s", pccd_error_text(client));
    }
    pccd_close(client);
    ctl_link_deinit(&options.link);
    return status;
}

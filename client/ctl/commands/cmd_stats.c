/* cmd_stats.c - pccdctl stats. */
#include <inttypes.h>
#include <jansson.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "columns.h"
#include "counters.h"
#include "ctl.h"
#include "link.h"
#include "output.h"
#include "printable.h"
#include "report.h"
#include "shown.h"

/* ---- What each thread of the daemon's last step did. */

#define TRIES 20

struct thread_row {
    uint64_t thread;
    struct counters is; /* in the order of the library */
};

struct table {
    struct thread_row *rows; /* ours, [count] */
    uint32_t count;
    char tuning[PCCD_TUNING_BYTES]; /* how they shared the work */
};

/* Take a counter, unless it is one that only batches have and this is a step. */
static void collect(void *context, const char *name, uint64_t value, const char *text)
{
    if (strcmp(name, "scenes") != 0 || counters_get(context, "batch") > 0) {
        counters_take(context, name, value, text);
    }
}

/* "ns_low" is of the step, "low_ns" of a thread; what comes before the first time says
 * which step it was; everything else counts a thread's work. */
enum kind { KIND_STEP, KIND_PHASE, KIND_TIME, KIND_WORK };

static enum kind kind_of(const struct counters *row, uint32_t at)
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
    struct counters first = {.count = 0};
    int status = pccd_stats_thread(client, true, 0, collect, &first, table->tuning);
    if (status != PCCD_OK) {
        return status;
    }
    uint32_t threads = (uint32_t)counters_get(&first, "threads");
    free(table->rows);
    table->count = 0;
    table->rows = calloc((size_t)threads + 1, sizeof *table->rows);
    if (table->rows == NULL) {
        return PCCD_E_NOMEM;
    }
    table->rows[0].is = first;
    for (uint32_t i = 1; i < threads; i++) {
        struct counters *row = &table->rows[i].is;
        table->rows[i].thread = i;
        status = pccd_stats_thread(client, true, i, collect, row, NULL);
        if (status == PCCD_E_INVAL) {
            return PCCD_E_BUSY; /* a step of fewer threads */
        }
        if (status != PCCD_OK) {
            return status;
        }
        if (counters_get(row, "number") != counters_get(&first, "number")) {
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
    const struct counters *row = &table->rows[0].is;
    uint64_t threads = counters_get(row, "threads");
    uint64_t batch = counters_get(row, "batch");
    if (batch > 0) {
        fprintf(to, "batch of %" PRIu64 " %s up to ", batch,
                proto_plural(batch, "scene", "scenes"));
    }
    fprintf(to, "step %" PRIu64 " by %" PRIu64 " %s", counters_get(row, "number"),
            threads, proto_plural(threads, "thread", "threads"));
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

/* The counters of one kind: a line for each thread. */
static void print_kind(const struct table *table, enum kind kind)
{
    const struct counters *first = &table->rows[0].is;
    struct column columns[COLUMNS_MAX] = {
        {NULL, "thread", COLUMN_NUMBER, COLUMN_OF(struct thread_row, thread), .rank = 1}};
    char heads[COUNTERS_MAX][48]; /* without the unit, which stands at each time */
    uint32_t count = 1;
    for (uint32_t i = 0; i < first->count; i++) {
        if (kind_of(first, i) == kind) {
            size_t length = strlen(first->name[i]) - (kind == KIND_TIME ? 3 : 0);
            snprintf(heads[i], sizeof heads[i], "%.*s", (int)length, first->name[i]);
            columns[count] = (struct column){
                .head = heads[i],
                .type = kind == KIND_TIME ? COLUMN_NS : COLUMN_NUMBER,
                .at = offsetof(struct thread_row, is.value) + i * sizeof first->value[0],
                .bytes = sizeof first->value[0],
                .rank = count + 1};
            count++;
        }
    }
    putchar('\n');
    columns_table(columns, table->rows, sizeof *table->rows, table->count, true);
}

/* The step's own numbers at the top, an object for each thread in "thread_records". */
static int print_threads_json(FILE *to, const struct table *table)
{
    json_t *object = json_object();
    json_t *array = json_array();
    const struct counters *first = &table->rows[0].is;
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
        const struct counters *row = &table->rows[thread].is;
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
        print_kind(&table, KIND_WORK);
        print_kind(&table, KIND_TIME);
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

/* 0 before the first candidate. */
static double exact_share(const struct counters *counters)
{
    uint64_t candidates = counters_get(counters, "candidates");
    return candidates > 0 ? (double)counters_get(counters, "exact") / (double)candidates
                          : 0;
}

static bool print_json(const struct counters *counters, const char *cpu)
{
    json_t *object = json_object();
    counters_add(object, counters);
    json_object_set_new(object, "exact_share", json_real(exact_share(counters)));
    json_object_set_new(object, "cpu", json_string(cpu));
    return output_json(object, true, stdout);
}

static void print_list(const struct counters *counters, const char *cpu)
{
    struct {
        const char *name, *text;
        char value[64];
    } lines[COUNTERS_MAX + 2] = {{.name = NULL}};
    uint32_t count = counters->count;
    int name_width = 0, value_width = 0;
    for (uint32_t i = 0; i < count; i++) {
        lines[i].name = counters->name[i];
        lines[i].text = counters->text[i];
        snprintf(lines[i].value, sizeof lines[i].value, "%" PRIu64, counters->value[i]);
    }
    lines[count].name = "exact_share";
    lines[count].text = "of the candidates, the share that took exact arithmetic";
    snprintf(lines[count].value, sizeof lines[count].value, "%.4g",
             exact_share(counters));
    lines[count + 1].name = "cpu";
    lines[count + 1].text = "instruction set that steps use";
    snprintf(lines[count + 1].value, sizeof lines[count + 1].value, "%s",
             tool_shown(cpu));
    for (uint32_t i = 0; i < count + 2; i++) {
        int name = (int)strlen(lines[i].name), value = (int)strlen(lines[i].value);
        name_width = name > name_width ? name : name_width;
        value_width = value > value_width ? value : value_width;
    }
    for (uint32_t i = 0; i < count + 2; i++) {
        printf("%-*s  %*s  ", name_width, lines[i].name, value_width, lines[i].value);
        columns_text(stdout, (uint32_t)(name_width + value_width) + 4, lines[i].text);
        putchar('\n');
    }
}

static int print(struct pccd_client *client, void *to)
{
    const struct stats_options *options = to;
    struct counters counters;
    int status = options->of_threads
                     ? stats_threads_print(client, stdout, options->is_json)
                     : counters_read(client, &counters);
    if (status != PCCD_OK) {
        return ctl_complain("stats: %s", pccd_error_text(client));
    }
    if (!options->of_threads && options->is_json) {
        (void)print_json(&counters, pccd_daemon_cpu(client));
    } else if (!options->of_threads) {
        print_list(&counters, pccd_daemon_cpu(client));
    }
    return CTL_DONE;
}

int ctl_cmd_stats(int argc, char **argv)
{
    struct stats_options options = {
        .link = {.policy = CTL_LINK_EXISTING, .observes = true}};
    return ctl_link_command(&ctl_table_stats, argc, argv, &options.link, print);
}

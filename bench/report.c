/* report.c - samples, their order statistics, and how they are printed. */
#include "report.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#if defined(__clang__)
#define COMPILER __VERSION__
#else
#define COMPILER "gcc " __VERSION__
#endif

static struct {
    const char *program;
    bool json;
    unsigned failed;
    char cpu[128];
} report;

const char *bench_compiler(void)
{
    return COMPILER;
}

const char *bench_cpu(void)
{
    char line[512];
    if (report.cpu[0]) {
        return report.cpu;
    }
    FILE *file = fopen("/proc/cpuinfo", "r");
    strcpy(report.cpu, "unknown");
    while (file && fgets(line, sizeof line, file)) {
        char *value = strchr(line, ':');
        if (strncmp(line, "model name", 10) == 0 && value) {
            value += 1 + strspn(value + 1, " \t");
            value[strcspn(value, "\n")] = '\0';
            snprintf(report.cpu, sizeof report.cpu, "%.*s", (int)sizeof report.cpu - 1,
                     value);
            break;
        }
    }
    if (file) {
        fclose(file);
    }
    return report.cpu;
}

void bench_name(const char *program)
{
    report.program = program;
}

static void take_wanted(struct argp_state *state, void *to)
{
    struct bench_options *options = to;
    if (options->arguments.count > 1) {
        option_misused(state, "one name at a time: \"%s\" or \"%s\"",
                       options->arguments.list[0], options->arguments.list[1]);
    }
    options->wanted = options->arguments.count > 0 ? options->arguments.list[0] : NULL;
}

static const struct option_row rows[] = {
    {.type = OPTION_ARGUMENTS, .at = offsetof(struct bench_options, arguments)},
    {"json", 0, NULL, "a JSON object a row, on a line", OPTION_FLAG,
     .at = offsetof(struct bench_options, json)},
    {"smoke", 0, NULL, "tiny scenes, a few repeats: does it still run?", OPTION_FLAG,
     .at = offsetof(struct bench_options, smoke)},
    {0}};

void bench_begin(const char *program, const struct option_row *more, int argc,
                 char **argv, struct bench_options *options)
{
    const struct option_table added = {.rows = more};
    const struct option_part parts[] = {{more ? &added : NULL, 0}, {0}};
    const struct option_table table = {.rows = rows,
                                       .parts = parts,
                                       .check = take_wanted,
                                       .arguments = "[NAME]",
                                       .text = "Measure what has NAME in its name; all "
                                               "by default."};
    bench_name(program);
    argp_err_exit_status = 2;
    if (option_parse(&table, argc, argv, options) != 0) {
        exit(2);
    }
    report.json = options->json;
    if (!report.json) {
        printf("%s: %s; %s; %s\n", program, COMPILER, BENCH_FLAGS, bench_cpu());
    }
}

int bench_end(void)
{
    return report.failed ? 1 : 0;
}

bool bench_is_wanted(const struct bench_options *options, const char *scene)
{
    return !options->wanted || strstr(scene, options->wanted) != NULL;
}

bool bench_check(bool holds, const char *scene, const char *what)
{
    if (!holds) {
        report.failed++;
        fprintf(stderr, "%s: %s: wrong: %s\n", report.program, scene, what);
    }
    return holds;
}

void bench_need(bool holds, const char *what)
{
    if (!holds) {
        fprintf(stderr, "%s: %s; the last error of the system: %s\n", report.program,
                what, strerror(errno));
        exit(2);
    }
}

FILE *bench_create(const char *folder, const char *name)
{
    char path[4096];
    (void)snprintf(path, sizeof path, "%s/%s", folder, name);
    FILE *file = fopen(path, "w");
    bench_need(file != NULL, path);
    return file;
}

double bench_thread_ns(void)
{
    struct timespec now;
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
    return (double)now.tv_sec * 1e9 + (double)now.tv_nsec;
}

void *bench_alloc(size_t count, size_t bytes)
{
    void *block = count > SIZE_MAX / bytes ? NULL : malloc(count * bytes + 1);
    if (!block) {
        fprintf(stderr, "%s: no memory for %zu x %zu bytes\n", report.program, count,
                bytes);
        exit(2);
    }
    return block;
}

void bench_add(struct bench_samples *samples, double value)
{
    if (samples->count == samples->capacity) {
        size_t capacity = samples->capacity ? samples->capacity * 2 : 64;
        double *values = bench_alloc(capacity, sizeof *values);
        if (samples->count > 0) {
            memcpy(values, samples->values, samples->count * sizeof *values);
        }
        free(samples->values);
        samples->values = values;
        samples->capacity = capacity;
    }
    samples->values[samples->count++] = value;
}

void bench_free(struct bench_samples *samples)
{
    free(samples->values);
    memset(samples, 0, sizeof *samples);
}

static int compare(const void *a, const void *b)
{
    const double *x = a;
    const double *y = b;
    return (*x > *y) - (*x < *y);
}

/* The smallest value that `share` of all do not exceed. */
static double quantile(const double *sorted, size_t count, double share)
{
    size_t rank = (size_t)(share * (double)count);
    return sorted[rank < count ? rank : count - 1];
}

struct bench_summary bench_summarise(const struct bench_samples *samples)
{
    size_t count = samples->count;
    if (count == 0) {
        return (struct bench_summary){0, 0, 0, 0, 0};
    }
    double *sorted = bench_alloc(count, sizeof *sorted);
    memcpy(sorted, samples->values, count * sizeof *sorted);
    qsort(sorted, count, sizeof *sorted, compare);
    struct bench_summary summary = {sorted[0], quantile(sorted, count, 0.5),
                                    quantile(sorted, count, 0.95),
                                    quantile(sorted, count, 0.99), sorted[count - 1]};
    free(sorted);
    return summary;
}

double bench_take_median(struct bench_samples *samples)
{
    double median = bench_summarise(samples).p50;
    bench_free(samples);
    return median;
}

void bench_heading(const char *text)
{
    if (!report.json) {
        printf("\n%s\n%-18s %-26s %-8s %11s %11s %11s %11s %11s %6s %8s %8s %s\n", text,
               "scene", "what", "unit", "p50", "min", "max", "p95", "p99", "n", "ratio",
               "of min", "to");
        fflush(stdout);
    }
}

/* Ratios of a row to its base. A busy machine moves medians more than minima. */
struct ratios {
    double p50;
    double min;
};

/* A JSON string. */
static void print_text(const char *key, const char *text)
{
    printf("\"%s\":\"", key);
    for (; *text; text++) {
        if (*text == '"' || *text == '\\') {
            putchar('\\');
        }
        putchar((unsigned char)*text < ' ' ? ' ' : *text);
    }
    printf("\",");
}

static void print_json(const char *scene, const struct bench_side *side,
                       const struct bench_summary *s, const struct ratios *ratios)
{
    putchar('{');
    print_text("program", report.program);
    print_text("scene", scene);
    print_text("what", side->what);
    print_text("unit", side->unit);
    printf("\"p50\":%.9g,\"min\":%.9g,\"max\":%.9g,\"p95\":%.9g,\"p99\":%.9g,\"n\":%zu,",
           s->p50, s->min, s->max, s->p95, s->p99, side->samples.count);
    if (side->base_name) {
        printf("\"ratio\":%.6g,\"ratio_min\":%.6g,", ratios->p50, ratios->min);
        print_text("to", side->base_name);
    }
    print_text("compiler", COMPILER);
    print_text("flags", BENCH_FLAGS);
    print_text("cpu", bench_cpu());
    printf("\"threads\":%u}\n", side->threads ? side->threads : 1);
}

void bench_side_row(const char *scene, const struct bench_side *side,
                    const struct bench_samples *base_samples)
{
    struct bench_summary s = bench_summarise(&side->samples);
    struct ratios ratios = {0, 0};
    if (side->base_name) {
        struct bench_summary base = bench_summarise(base_samples);
        ratios.p50 = base.p50 > 0 ? s.p50 / base.p50 : 0;
        ratios.min = base.min > 0 ? s.min / base.min : 0;
    }
    if (report.json) {
        print_json(scene, side, &s, &ratios);
    } else {
        printf("%-18s %-26s %-8s %11.5g %11.5g %11.5g %11.5g %11.5g %6zu", scene,
               side->what, side->unit, s.p50, s.min, s.max, s.p95, s.p99,
               side->samples.count);
        if (side->base_name) {
            printf(" %8.3f %8.3f %s", ratios.p50, ratios.min, side->base_name);
        }
        putchar('\n');
    }
    fflush(stdout);
}

void bench_row(const char *scene, const char *what, const char *unit,
               const struct bench_samples *samples, const char *base_name,
               const struct bench_samples *base)
{
    struct bench_side side = {.unit = unit, .base_name = base_name, .samples = *samples};
    snprintf(side.what, sizeof side.what, "%s", what);
    bench_side_row(scene, &side, base);
}

void bench_sides_end(const char *scene, struct bench_side *sides, size_t count,
                     bool are_right)
{
    for (size_t i = 0; i < count && are_right; i++) {
        if (sides[i].samples.count > 0) {
            bench_side_row(scene, &sides[i], &sides[sides[i].base].samples);
        }
    }
    for (size_t i = 0; i < count; i++) {
        bench_free(&sides[i].samples);
    }
}

void bench_number(const char *scene, const char *what, const char *unit, double value)
{
    bench_row(scene, what, unit, &(struct bench_samples){&value, 1, 1}, NULL, NULL);
}

void bench_skip(const char *scene, const char *reason)
{
    fprintf(stderr, "%s: %s: skipped: %s\n", report.program, scene, reason);
}

/* report.h - collects measured samples and prints them as a table or as JSON.
 *
 * Threads: one.
 */
#ifndef BENCH_REPORT_H
#define BENCH_REPORT_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <time.h>

#include "clock.h"

struct bench_options {
    bool smoke;         /* tiny scenes, a few repeats: does it still run? */
    bool json;          /* one JSON line a row instead of the table */
    const char *wanted; /* only scenes whose name contains this; NULL: all */
    uint32_t threads;   /* --threads, at least 2; 0: not given */
};

/* Values of one quantity in the order they came; memory grows, never shrinks. */
struct bench_samples {
    double *values;
    size_t count;
    size_t capacity;
};

struct bench_summary {
    double min, p50, p95, p99, max;
};

struct bench_row {
    const char *scene;
    const char *what;
    const char *unit;
    const struct bench_samples *samples;
    const char *base_name; /* what the ratio is to; NULL: no ratio */
    const struct bench_samples *base;
    uint32_t threads;     /* 0 reads as 1 */
    const uint64_t *hash; /* [2] of the answer; NULL: none */
};

/* False: the program is to end with *exit_status. Sets up the report of `program`. */
bool bench_begin(const char *program, int argc, char **argv,
                 struct bench_options *options, int *exit_status);
/* The same for a program that takes --threads as well. */
bool bench_begin_with_threads(const char *program, int argc, char **argv,
                              struct bench_options *options, int *exit_status);
/* For a program with options of its own: whose checks they are. */
void bench_name(const char *program);
/* The exit status: 1 when a check failed. */
int bench_end(void);

/* With its version, and the model of the processor. */
const char *bench_compiler(void);
const char *bench_cpu(void);

bool bench_is_wanted(const struct bench_options *options, const char *scene);

/* A check that must hold before times are worth reporting. Returns `holds`. */
bool bench_check(bool holds, const char *scene, const char *what);

/* Exits with 2 when there is no memory: a measurement cannot go on without. */
void bench_add(struct bench_samples *samples, double value);
void bench_clear(struct bench_samples *samples);
void bench_free(struct bench_samples *samples);
struct bench_summary bench_summarise(const struct bench_samples *samples);

void bench_heading(const char *text);
void bench_row(const struct bench_row *row);
/* A row of one number, such as a count. */
void bench_number(const char *scene, const char *what, const char *unit, double value);
/* A scene that cannot be measured here. */
void bench_skip(const char *scene, const char *reason);

/* malloc that exits with 2 when there is no memory. */
void *bench_alloc(size_t count, size_t bytes);

#endif

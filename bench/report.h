/* report.h - collects measured samples and prints them as a table or as JSON. */
#ifndef BENCH_REPORT_H
#define BENCH_REPORT_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <time.h>

#include "clock.h"
#include "option_table.h"

struct bench_options {
    bool smoke;         /* tiny scenes, a few repeats: does it still run? */
    bool json;          /* one JSON line a row instead of the table */
    const char *wanted; /* only scenes whose name contains this; NULL: all */
    struct option_arguments arguments; /* at most `wanted` */
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

/* A quantity that is measured in turn with others. */
struct bench_side {
    char what[80];
    const char *unit;
    const char *base_name; /* NULL: no ratio */
    unsigned base;         /* the side that the ratio is to */
    uint32_t threads;      /* 0 reads as 1 */
    struct bench_samples samples;
};

/* Read the options, with those of `more` (NULL: none), which lie in the struct that
 * `options` begins, and set up the report of `program`. */
void bench_begin(const char *program, const struct option_row *more, int argc,
                 char **argv, struct bench_options *options);
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

/* Exit with 2, after a message with the last error of the system, unless it holds: a
 * measurement cannot go on without. */
void bench_need(bool holds, const char *what);
/* Begin a file in a folder; exits with 2 when it cannot. */
FILE *bench_create(const char *folder, const char *name);

/* Exits with 2 when there is no memory. */
void bench_add(struct bench_samples *samples, double value);
void bench_free(struct bench_samples *samples);
/* Return the middle of what the samples hold, which are freed. */
double bench_take_median(struct bench_samples *samples);
struct bench_summary bench_summarise(const struct bench_samples *samples);

void bench_heading(const char *text);
void bench_row(const char *scene, const char *what, const char *unit,
               const struct bench_samples *samples, const char *base_name,
               const struct bench_samples *base);
/* The same of a side; `base` NULL where it has no ratio. */
void bench_side_row(const char *scene, const struct bench_side *side,
                    const struct bench_samples *base);
/* If they are right, a row of each side that was measured; their samples are freed. */
void bench_sides_end(const char *scene, struct bench_side *sides, size_t count,
                     bool are_right);
/* A row of one number, such as a count. */
void bench_number(const char *scene, const char *what, const char *unit, double value);
/* A scene that cannot be measured here. */
void bench_skip(const char *scene, const char *reason);

/* Processor time of this thread. */
double bench_thread_ns(void);

/* malloc that exits with 2 when there is no memory. */
void *bench_alloc(size_t count, size_t bytes);

#endif

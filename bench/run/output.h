/* output.h - writes the measurements of pccd-bench, and their conditions. */
#ifndef RUN_OUTPUT_H
#define RUN_OUTPUT_H

#include <stdio.h>

#include "play.h"
#include "report.h"

/* False: it could not be written. */
bool run_write_text(FILE *to, const struct run_play *play);
bool run_write_csv(FILE *to, const struct run_play *play);
bool run_write_json(FILE *to, const struct run_play *play);

/* Over the steps of a side; times in milliseconds. */
struct bench_summary run_summarise_time(const struct run_play *play, uint32_t side,
                                        enum run_time time);
/* The same of a count, with the sum. False: it is not known of every step. */
bool run_summarise_count(const struct run_play *play, uint32_t side, enum run_count count,
                         struct bench_summary *summary, uint64_t *total);

/* ---- The conditions of a measurement: build, machine, settings. */

/* Commit of the sources that were built, with "-dirty" where they were changed; "unknown"
 * outside of a repository. Generated (local.mk). */
extern const char run_commit[];

/* Tell `each` of every item in a fixed order: as a text, or if that is NULL, as the
 * number. `name` is a word; both texts are gone when it returns. */
typedef void (*run_item_fn)(void *context, const char *name, const char *text,
                            uint64_t number);
void run_setup_each(const struct run_play *play, run_item_fn each, void *context);

#endif

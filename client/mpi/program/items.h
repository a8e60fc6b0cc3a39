/* items.h - items that are dealt out, and the file of what came of them.
 *
 * Threads: as deal.h says; only `compute` runs in the thread that computes.
 */
#ifndef PROGRAM_ITEMS_H
#define PROGRAM_ITEMS_H

#include <jansson.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "deal.h"
#include "error.h"
#include "option_table.h"
#include "results.h"

struct items_work {
    const char *name;    /* of the command */
    uint64_t count;      /* of items, the same on every rank */
    size_t result_bytes; /* of a result without pointers; at most DEAL_RESULT_BYTES */
    void *context;
    int (*compute)(void *context, struct deal *deal, struct ctl_error *error);
    /* The rest is called on the root. */
    bool (*is_wanted)(void *context, uint64_t item); /* NULL: all are */
    /* Whether no item after the one with this result counts. NULL: all count. */
    bool (*is_last)(void *context, const void *result);
    /* A line of the file of results, and back; false: it is none. NULL: no memory. */
    json_t *(*line)(const void *result);
    bool (*read)(const json_t *line, void *result);
    /* What results depend on, to the head of that file. NULL: no memory. */
    json_t *(*depends)(void *context);
    /* "step 7 of a.rec" */
    void (*describe)(void *context, uint64_t item, char *text, size_t bytes);
};

struct items {
    const struct items_work *work;
    unsigned char *all; /* [count] of work->result_bytes */
    bool *is_there;     /* [count] */
    struct results results;
    uint64_t stop;    /* the least item behind which none counts */
    uint64_t found;   /* results that were in the file */
    uint64_t written; /* results of this run */
    uint64_t last;    /* item of the last one */
};

/* Collective. Do all items; `path` NULL: no file. The same status on every rank. */
int items_run(struct items *items, const struct items_work *work, const char *path,
              struct ctl_error *error);
/* Return, on the root, the result of an item. NULL: it was not wanted. */
const void *items_result(const struct items *items, uint64_t item);
/* Free what came of the items; all zeros are allowed. */
void items_deinit(struct items *items);

/* The option --results, of a const char *, NULL before. */
extern const struct option_table items_table;

#endif

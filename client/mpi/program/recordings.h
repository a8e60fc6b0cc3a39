/* recordings.h - the steps of recordings, each done by one of the ranks.
 *
 * Threads: as deal.h says: `step` and `skip` in the thread that computes.
 *
 * An item (deal.h) is a step or a question about what is near: of two recordings with 10
 * and 20 steps, item 12 is the third step of the second one. Each rank reads the files
 * itself, so that only numbers and results go between ranks.
 */
#ifndef PROGRAM_RECORDINGS_H
#define PROGRAM_RECORDINGS_H

#include <jansson.h>
#include <stdbool.h>
#include <stdint.h>

#include "deal.h"
#include "play.h"
#include "play_options.h"
#include "results.h"

struct answers_asked;
struct recording;
struct recordings;

/* What a command makes of each item: a result without pointers. */
struct recordings_work {
    const char *name;    /* of the command */
    size_t result_bytes; /* at most DEAL_RESULT_BYTES */
    void *context;
    int (*step)(void *context, const struct play_step *step, void *result,
                struct ctl_error *error);
    /* A step that is not repeated, because it had failed by chance. */
    void (*skip)(void *context, const struct answers_asked *asked, void *result);
    /* Whether no step after this one counts. */
    bool (*is_last)(void *context, const void *result);
    /* A line of the file of results, and back; false: it is none. NULL: no memory. */
    json_t *(*line)(const void *result);
    bool (*read)(const json_t *line, void *result);
    /* What results depend on besides the recording; NULL: no memory. */
    json_t *(*settings)(void *context);
    /* The root: say what came of a recording, by recordings_result. */
    int (*report)(void *context, const struct recordings *recordings,
                  const struct recording *file, bool *is_right, struct ctl_error *error);
};

/* Options of a command line; zero before. */
struct recordings_options {
    struct play_options play; /* takes_files is set */
    const char *results;      /* NULL: no file */
};
extern const struct option_table recordings_table;
void recordings_options_init(struct recordings_options *options);

struct recording {
    const char *path;
    struct play_reader *reader;
    struct play_summary summary;
    uint64_t first, count; /* items */
};

struct recordings {
    const struct recordings_options *options;
    const struct recordings_work *work;
    struct recording *files;
    uint32_t file_count;
    uint64_t count; /* items of all files */
    /* What came of the items, on the root, */
    unsigned char *made; /* [count] of work->result_bytes */
    bool *is_there;      /* [count] and, on all ranks, what was in the file */
    uint64_t *todo;      /* [todo_count] items that are dealt, by their numbers there */
    uint64_t todo_count;
    struct results results;
    uint64_t stop;    /* the least item behind which none counts */
    uint64_t found;   /* results that were in the file */
    uint64_t written; /* results of this run */
    uint64_t last;    /* item of the last one */
    /* On the rank that computes. */
    struct deal *deal;
    struct recording *now;
    uint64_t number;  /* that is dealt; DEAL_NONE: none */
    uint64_t held;    /* its item, or DEAL_NONE */
    bool is_begun;    /* and is being done */
    uint32_t threads; /* of each step */
};

/* Collective. Read the command line into `input`, of which `options` are a part; do all
 * items; report. Returns an exit status, the same on every rank. `options` are given
 * back. */
int recordings_command(struct recordings_options *options,
                       const struct option_table *table, int argc, char **argv,
                       void *input, const struct recordings_work *work);
/* Return, on the root, the result of an item in a recording, from 0; NULL: it was not
 * wanted. */
const void *recordings_result(const struct recordings *recordings,
                              const struct recording *file, uint64_t place);
/* Write, on the root, what stands between two reports, before the one of `file` is
 * written. One that fails first leaves the array whole. */
void recordings_separate(const struct recordings *recordings,
                         const struct recording *file);
#endif

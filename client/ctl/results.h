/* results.h - a file of results, a line each, with which a run that was ended goes on.
 *
 * Read what is there, if it belongs to the same work; append lines that are on the disk
 * when results_append returns; let no two runs write the same file. A last line that is
 * not whole, as a machine leaves it that loses its power, is cut off.
 *
 *     {"pccd-mpi": "replay", "version": "0.1.0", ...}        of which work: the head
 *     {"item": 3, ...}                                       one result, as it came
 */
#ifndef CTL_RESULTS_H
#define CTL_RESULTS_H

#include <jansson.h>
#include <stddef.h>
#include <stdint.h>

#include "error.h"

/* A line that is there: what it says. Errors: it is none of this work. */
typedef int (*results_line_fn)(void *context, const json_t *line,
                               struct ctl_error *error);

struct results {
    const char *path; /* the caller's */
    results_line_fn each;
    void *context;  /* of each */
    int fd;         /* -1: there is no file */
    uint64_t bytes; /* of whole lines */
};

/* Open, or begin with `head`; tell each line. PCCD_E_FORMAT: it has another head, or is
 * no file of results at all, and nothing in it was changed; PCCD_E_STATE: another run
 * writes it; PCCD_E_SYSTEM. Then it is not open. */
int results_open(struct results *results, const char *path, const json_t *head,
                 results_line_fn each, void *context, struct ctl_error *error);
/* Append a line, or do nothing where there is no file. PCCD_E_SYSTEM, PCCD_E_NOMEM: the
 * line is not there. */
int results_append(struct results *results, const json_t *line, struct ctl_error *error);
void results_close(struct results *results);
/* Return the text of a line with its end, *bytes long; the caller's to free. NULL: no
 * memory. */
char *results_text(const json_t *line, size_t *bytes);

#endif

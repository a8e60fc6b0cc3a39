/* check_lines.h - the results of a check, a line of JSON each, and what they rest on.
 *
 *     {"pccd_check": 1, "version": "0.1.0", "inputs": [...], "settings": {...}, ...}
 *     {"frame": "seq0.obj", "crossings": 490, ...}        the first frame
 *     {"to": "seq1.obj", "step": 1, ...}                  a step
 *     {"verdict": "free", ...}                            of all of them
 *
 * Nothing in them depends on the machine, on threads, on the method, or on where files
 * are: whoever has the files can have them made again and compare. So the whole file is a
 * certificate.
 */
#ifndef CTL_CHECK_LINES_H
#define CTL_CHECK_LINES_H

#include <jansson.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>

#include "check_run.h"
#include "check_screw.h"
#include "error.h"
#include "failing.h"
#include "results.h"
#include "scene.h"
#include "trace_file.h"

struct results_options {
    const char *path;     /* NULL: nowhere; "-": the standard output */
    uint32_t part, parts; /* this one of so many, from 1; parts 0: all steps */
    uint32_t jobs;        /* 0 and 1: no other process */
    bool is_job;          /* another process tells what comes of it */
};

#define RESULTS_PARTS_MAX 1000000u

/* Return whether it names a part that there is. */
static inline bool results_part_is(const struct results_options *results)
{
    return results->part >= 1 && results->part <= results->parts &&
           results->parts <= RESULTS_PARTS_MAX;
}

/* All that was said of a check. */
struct check_command {
    struct check_options check;
    struct check_screw screw;
    struct scene_options scene;
    struct trace_options trace;
    struct results_options results;
    struct failing_options failing;
    bool has_geometry;
};

/* Return the head: hashes of all files, which are read for it, and the options that the
 * answers depend on. NULL: an error. */
json_t *check_head(const struct check_command *command, const struct scene *scene,
                   struct ctl_error *error);
/* Take the options from a head; texts are the head's. False: it is none. */
bool check_head_read(const json_t *head, struct check_command *command);

/* ---- Where lines go. */

/* {0} with results.fd -1: nowhere. */
struct check_lines {
    struct results results; /* appended to a file */
    FILE *to;               /* or to a stream */
    FILE *expected;         /* or compared with those of a certificate */
    uint32_t number;        /* of the last line there */
    uint32_t different;     /* lines that are not the same */
};

#define CHECK_LINES_INIT                                                                 \
    {                                                                                    \
        .results = {.fd = -1 }                                                           \
    }

/* Append a line, which is ours to give back, or compare. What is different is printed on
 * the standard output. Errors: E_NOMEM (also of a line that is NULL), E_SYSTEM. */
int check_lines_put(struct check_lines *lines, json_t *line, struct ctl_error *error);
/* Compare the end: behind the last line a certificate has nothing. Errors: E_SYSTEM. */
int check_lines_end(struct check_lines *lines, struct ctl_error *error);
void check_lines_close(struct check_lines *lines);

/* ---- A certificate. */

/* Return whether a file is one, by how it begins. */
bool check_is_certificate(const char *path);
/* Open it behind its head, which the caller gives back. Errors: E_SYSTEM, E_FORMAT: it
 * has no head, or no verdict at its end. */
int check_lines_expect(struct check_lines *lines, const char *path, json_t **head,
                       struct ctl_error *error);
/* Compare a head with that of a certificate; say what is different, and count that. */
void check_lines_compare_heads(struct check_lines *lines, const json_t *expected,
                               const json_t *head);

#endif

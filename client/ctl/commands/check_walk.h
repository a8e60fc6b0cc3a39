/* check_walk.h - `pccdctl check`: from frame to frame, to a verdict.
 *
 * What is known of a step is told at once and kept no longer, but for --json, whose one
 * object is made at the end.
 *
 * Threads: one; with jobs, processes.
 */
#ifndef CTL_CHECK_WALK_H
#define CTL_CHECK_WALK_H

#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <sys/types.h>

#include "check_lines.h"
#include "error.h"

/* Do all of it. Returns the exit status. */
int check_walk(const struct check_command *command);
/* Do the check of a certificate again; `command` has its files, and where and how to
 * compute. Say what is different. Returns the exit status. */
int check_verify(const char *certificate, struct check_command *command);

/* ---- Jobs: processes that check a part of the steps each. */

struct check_jobs {
    const struct check_command *command;
    const json_t *head;
    uint32_t count;
    pid_t *processes; /* ours: [count]; 0: it has ended */
    int *endings;     /* ours: [count]: how, as waitpid says it */
    FILE **errors;    /* ours: [count]: what each says on its standard error */
    char *base;       /* ours: results go to BASE.1-of-N and so on */
    char *folder;     /* ours, with all that is in it; NULL: BASE is the user's */
};

/* Name the results of a part; the caller's to free. NULL: no memory. */
char *check_part_path(const char *base, uint32_t part, uint32_t parts);
/* Start them; `head` is that of all results, and stays. {0} before; check_jobs_end's to
 * end, also on error. Errors: E_SYSTEM, E_NOMEM. */
int check_jobs_start(struct check_jobs *jobs, const struct check_command *command,
                     const json_t *head, struct ctl_error *error);
/* Take every line behind the heads, in order, as soon as it is there. Errors: those of
 * `take`; E_STATE where a process ends before its verdict, having said why. */
int check_jobs_follow(struct check_jobs *jobs, results_line_fn take, void *context,
                      struct ctl_error *error);
/* Wait for them, or end them unless all `is_done`; then their files go, too. */
void check_jobs_end(struct check_jobs *jobs, bool is_done);

#endif

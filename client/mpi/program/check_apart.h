/* check_apart.h - pccd-mpi check --deal: each step by one rank.
 *
 * Threads: as items.h says.
 */
#ifndef PROGRAM_CHECK_APART_H
#define PROGRAM_CHECK_APART_H

#include "check_run.h"
#include "judge.h"
#include "part.h"

/* Collective. Compute all steps between the frames of `part`, which are whole, as `run`
 * says: its settings, repeats, and what of run->mesh is of the options and the files. On
 * the root the rest of that and `steps` ([frames - 1]) are filled in. Of several steps
 * `ends` gets what crosses in the first frame, and each step tells what does at its end.
 * `results` NULL: no file. The same status on every rank. */
int check_apart(const struct check_options *options, struct part *part,
                struct check_run *run, const char *results, struct judge_ends *ends,
                struct report_step *steps, struct ctl_error *error);

#endif

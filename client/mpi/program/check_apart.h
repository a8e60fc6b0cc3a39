/* check_apart.h - pccd-mpi check --deal: each step by one rank.
 *
 * Room:     client/mpi/program. May include: check_options.h, report.h.
 * Does:     deal the steps of a sequence of frames out to the ranks; what a step is found
 *           to have is what all ranks together would find.
 * Threads:  as items.h says.
 */
#ifndef PROGRAM_CHECK_APART_H
#define PROGRAM_CHECK_APART_H

#include "check_options.h"
#include "report.h"

/* Collective: compute all steps between the files of `options`, and time `repeats` more
 * runs of each. On the root `mesh` and
 * `steps` ([path_count - 1]) are filled in. `results` NULL: no file. The same status on
 * every rank. */
int check_apart(const struct check_options *options, uint32_t repeats,
                const char *results, struct report_mesh *mesh, struct report_step *steps,
                struct ctl_error *error);

#endif

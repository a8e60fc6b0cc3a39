/* first.h - the earliest contact of a step that all ranks compute together. */
#ifndef PROGRAM_FIRST_H
#define PROGRAM_FIRST_H

#include "check_run.h"
#include "pccd_mpi.h"

/* Collective. Say where the earliest contact is of those that ranks bring: `mine`, whose
 * toi is above 1 if this rank has none. It is between features of one object, which goes
 * from the positions that this rank has in frames[0] to those in frames[1]. On the root:
 * with the parts of `objects`, unless that is NULL. `first` stays as it is where no rank
 * has one. The same status on every rank. Errors: those of pccd_mpi_feature, E_SYSTEM. */
int first_find(struct pccd_mpi *world, const struct pccd_contact *mine,
               const struct ctl_mesh *const frames[2], const struct objects *objects,
               struct report_first *first, struct ctl_error *error);

#endif

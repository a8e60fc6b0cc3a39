/* check_screw.h - `pccdctl check --motion screw`: a body that turns, beside what stands.
 */
#ifndef CTL_CHECK_SCREW_H
#define CTL_CHECK_SCREW_H

#include <stdint.h>

#include "ask_options.h"
#include "scene.h"

/* A screw, as the command line says it. */
struct check_screw {
    uint32_t motion; /* 0: the files are frames, and there is no screw */
    double axis[3], through[3];
    double angle; /* in radians, not negative; 0: none is given */
    double pitch; /* way along the axis in a whole turn */
};

/* Options that fill a struct check_screw. */
extern const struct option_table check_screw_table;

/* Move the object of the first file along the screw, with `clearance` from the others,
 * and say what comes of it. Returns the exit status. (cmd_sweep.c) */
int sweep_screw(const struct check_screw *screw, const struct ask_options *ask,
                const struct scene_options *options, double clearance);

#endif

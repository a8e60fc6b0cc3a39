/* step.h - one question about the whole scene, and the motion that goes with it.
 *
 * Threads: one.
 */
#ifndef RANKS_STEP_H
#define RANKS_STEP_H

#include "world.h"

/* What a step or a question needs for its time. */
struct ranks_moment {
    const struct pccd_motion *motions; /* of this rank */
    uint32_t motion_count;
    struct pccd_step_settings settings;
    const struct pccd_near_settings *near; /* NULL: it is a step */
    bool is_still;                         /* a question, and no rank gave motions */
    /* Why all ranks know that it ends before libpccd was asked; else PCCD_COMPLETE. */
    enum pccd_incomplete stopped;
    uint8_t *bytes; /* what all ranks know of objects: step.c */
    const double (**given)[3];
    double (**local)[3];
};

/* Collective. hash: of the settings, `status` is what this rank says of them. If all
 * ranks agree, compute; `answer` gets what the caller knows of. After an error nothing
 * has changed, but that objects which were moved count as if they had stood still. */
int ranks_moment_make(struct pccd_mpi *world, enum ranks_call call, uint64_t hash,
                      int status, struct ranks_moment *moment,
                      struct pccd_answer *answer);

#endif

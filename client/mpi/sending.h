/* sending.h - the positions of a step, on their way to libpccd.
 *
 * Threads: one.
 */
#ifndef RANKS_SENDING_H
#define RANKS_SENDING_H

#include "world.h"

/* What is sent of each object. */
struct ranks_sending {
    const uint8_t *moves, *starts; /* it moves; it begins elsewhere than it ended */
    const double (**given)[3];     /* scratch */
    double (**local)[3];           /* NULLs at first: where its end positions go to */
    /* It is a question about what is near: libpccd only thinks that something moves. */
    bool is_question;
};

/* Collective. Positions of all that moves or begins elsewhere, or that libpccd has
 * elsewhere, to libpccd, with a new frame. On failure there is none. */
int ranks_sending_make(struct pccd_mpi *world, const struct ranks_sending *sending,
                       struct pccd_frame *frame);

/* In this rank alone: the step of what was sent, or of nothing. As pccd_frame_commit. */
int ranks_sending_commit(struct pccd_mpi *world, const struct ranks_sending *sending,
                         struct pccd_frame *frame,
                         const struct pccd_step_settings *settings, uint64_t *step);

#endif

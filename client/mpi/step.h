/* step.h - one question about the whole scene, and the motion that goes with it. */
#ifndef RANKS_STEP_H
#define RANKS_STEP_H

#include "world.h"

/* State of a step or a question while it is made. */
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

/* Collective. Make a step, or answer a question, if all ranks agree. hash: of the
 * settings, `status` is what this rank says of them. `answer` gets what the caller knows
 * of. After an error nothing has changed, but that objects which were moved count as if
 * they had stood still. */
int ranks_moment_make(struct pccd_mpi *world, enum ranks_call call, uint64_t hash,
                      int status, struct ranks_moment *moment,
                      struct pccd_answer *answer);

/* ---- Takes the motions of a step that a caller gives. */

/* Check in this rank alone whether these motions may be; nothing changes. Errors: those
 * of pccd_step, but for positions and vertices that two motions have. */
int ranks_motions_check(struct pccd_mpi *world, const struct pccd_motion *motions,
                        uint32_t motion_count);
/* Set object->from and object->to of each object, in this rank alone, after that check;
 * both are object->x where nothing was said. Where the named objects began before is
 * forgotten. PCCD_E_NOTFINITE, PCCD_E_SEGMENT, PCCD_E_NOMEM. */
int ranks_motions_take(struct pccd_mpi *world, const struct pccd_motion *motions,
                       uint32_t motion_count);

/* ---- The positions of a step, on their way to libpccd. */

/* Positions of each object that are sent. */
struct ranks_sending {
    const uint8_t *moves, *starts; /* it moves; it begins elsewhere than it ended */
    const double (**given)[3];     /* scratch */
    double (**local)[3];           /* NULLs at first: where its end positions go to */
    /* It is a question about what is near: libpccd only thinks that something moves. */
    bool is_question;
};

/* Collective. Send positions of all that moves or begins elsewhere, or that libpccd has
 * elsewhere, to libpccd, with a new frame. On failure there is none. */
int ranks_sending_make(struct pccd_mpi *world, const struct ranks_sending *sending,
                       struct pccd_frame *frame);

/* Make, in this rank alone, the step of what was sent, or of nothing, as
 * pccd_frame_commit and pccd_wait do. */
int ranks_sending_commit(struct pccd_mpi *world, const struct ranks_sending *sending,
                         struct pccd_frame *frame,
                         const struct pccd_step_settings *settings,
                         struct pccd_answer *answer);

#endif

/* oracle_turning.h - when two features first meet whose bodies turn, within a bracket.
 *
 * Bound where the points are over a span of time, by numbers with a radius and two
 * derivatives, and halve the spans: by doubles, then by numbers of 113 bits where those
 * cannot tell. What is said is certain; what is not said is not known.
 *
 * Threads: [any]; no global state.
 */
#ifndef ORACLE_ORACLE_TURNING_H
#define ORACLE_ORACLE_TURNING_H

#include <stdbool.h>
#include <stdint.h>

#include "pccd_types.h"

#define ORACLE_TURNING_JOINTS_MAX 256u /* of one side, after what cancels */
#define ORACLE_TURNING_NEVER      2.0

/* A feature: 1, 2 or 3 points. */
struct oracle_turning_side {
    uint32_t points;
    uint32_t joint; /* that it hangs on, or PCCD_NO_JOINT: its points go straight */
    /* In the frame of its link; of PCCD_NO_JOINT in the world, at t = 0 and t = 1. */
    const double (*x[2])[3];
};

/* Together at most 4 points; a triangle only against a vertex. */
struct oracle_turning {
    const struct pccd_joint *joints;
    struct oracle_turning_side side[2];
    double radius[4]; /* r is their exact sum; each is 0 or more */
};

/* The part of the step, and how much may be done. */
struct oracle_turning_asked {
    double from, to; /* 0 .. 1 */
    double width;    /* of the bracket; above 0 */
    uint32_t spans;  /* by doubles, at most */
    uint32_t fine;   /* by longer numbers, at most; 0: none */
};

struct oracle_turning_answer {
    /* At all t of [from, free_until) the distance is above r; free_until = from: at the
     * first time it is not known to be. */
    double free_until;
    bool is_free;   /* at all t of [from, to] */
    double met_by;  /* at some t of [from, met_by] it is at most r; or never, as known */
    uint32_t spans; /* that were looked at */
};

/* Find when the pair first meets; of more than ORACLE_TURNING_JOINTS_MAX joints nothing
 * is known. */
void oracle_turning_find(const struct oracle_turning *pair,
                         const struct oracle_turning_asked *asked,
                         struct oracle_turning_answer *answer);

/* Set x to where the points of a side are in the world at time t, rounded. False: too
 * many joints. */
bool oracle_turning_place(const struct pccd_joint *joints,
                          const struct oracle_turning_side *side, double t,
                          double x[3][3]);

#endif

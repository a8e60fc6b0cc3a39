/* daemon/engine/elementary/thick_advance.h - decides a query of thick features by
 * doubles: conservative advancement along directions that keep the features apart.
 *
 * Room:     engine. May include: thick_query.h.
 * Does:     say for certain that two features stay farther apart than r, or in which
 *           cell of time they first do not, or that doubles do not know; describe a
 *           contact.
 * Threads:  [any].
 * Source:   Mirtich 1996, and Li et al., Codimensional incremental potential contact,
 *           2021, for conservative advancement; BOUNDS.md, "Thick features by doubles".
 */
#ifndef ENG_THICK_ADVANCE_H
#define ENG_THICK_ADVANCE_H

#include <stdbool.h>
#include <stdint.h>

#include "thick_query.h"

enum eng_thick_advanced {
    ENG_THICK_MISSES,    /* no contact, or none that begins before or at t_end */
    ENG_THICK_INITIALLY, /* d(0) <= r, and no approach is asked for */
    ENG_THICK_MEETS,     /* in `cell` */
    ENG_THICK_UNSURE     /* there is none before `reached` */
};

/* The motion of a query, from the differences of its points. Scaled by one power of two,
 * so that the largest is between 1/2 and 1. */
struct eng_thick_motion {
    enum pccd_kind form; /* of eng_closest_to_origin: EE, or VF for all others */
    int count;
    double w[4][2][3]; /* from a point of feature b to one of a, at t = 0 and 1 */
    double p[2][3];    /* query.h; 0 where there are fewer points */
    double b[2][3];
    double c[2][3];
    bool is_nothing;   /* all points are one throughout */
    double r_lo, r_hi; /* the distance is between these */
};

struct eng_thick_advance {
    bool is_inside; /* d(0) <= r */
    double reached; /* before this time the distance is more than r */
    int64_t cell;
};

void eng_thick_motion_load(struct eng_thick_motion *motion,
                           const struct eng_thick_query *query);

/* `since`: as in struct eng_thick_query. */
enum eng_thick_advanced eng_thick_advance(struct eng_thick_motion *motion,
                                          double approach, int depth, double since,
                                          double t_end,
                                          struct eng_thick_advance *advance);

/* param and normal of a contact at time t. */
void eng_thick_describe(const struct eng_thick_motion *motion, uint32_t kind, double t,
                        struct eng_hit *hit);

#endif

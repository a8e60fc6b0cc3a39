/* place.h - where the record of a contact lies.
 *
 * The one function for what reports, pictures and files of other programs show. The page
 * of inspect does the same in its browser (data.js), `pccdctl verify` by itself.
 *
 * Threads: any.
 */
#ifndef CTL_PLACE_H
#define CTL_PLACE_H

#include <math.h>

#include "kinds.h"
#include "pccd.h"

/* The vertices of a feature, and where they are at t = 0 and at t = 1 of a step. */
struct place_feature {
    uint32_t corners[3];
    double from[3][3], to[3][3];
};

/* Find the points at[0] and at[1] of the features of a record that its parameters name,
 * at a time of the step: in exact arithmetic the two are one where a contact without a
 * distance happens. Parameters of records are floats and times lower bounds: each is
 * within 2^-22 of the feature's size, and what moves in toi_hi - toi, of where they
 * touch; doubles add less than 2^-50 of the coordinates. A vertex is where its motion has
 * it at that time, rounded twice. Of EF both are the point of the edge. */
static inline void place_find(uint32_t kind, const float param[2],
                              const struct place_feature features[2], double t,
                              double at[2][3])
{
    const bool is_crossing = kind == PCCD_EF;
    double w[2][3];
    common_contact_weights(is_crossing ? PCCD_EE : (enum pccd_kind)kind, param, w);
    for (int side = 0; side < 2; side++) {
        const int from_side = is_crossing ? 0 : side;
        const struct place_feature *feature = &features[from_side];
        for (int k = 0; k < 3; k++) {
            at[side][k] = 0;
            for (uint32_t i = 0; i < common_kinds[kind].points[from_side]; i++) {
                double from = feature->from[i][k], to = feature->to[i][k];
                at[side][k] += w[from_side][i] * (t < 1 ? from + t * (to - from) : to);
            }
        }
    }
}

/* Return when a contact happens, 0 .. 1: its lower bound, which by itself may be below 0
 * by rounding. */
static inline double place_time(const struct pccd_contact *contact)
{
    return fmin(fmax(contact->toi, 0), 1);
}

#endif

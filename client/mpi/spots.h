/* spots.h - where the leaves of objects are at one moment, some at a time.
 *
 * Threads: one.
 */
#ifndef RANKS_SPOTS_H
#define RANKS_SPOTS_H

#include <math.h>

#include "near_objects.h"

/* Own leaves of one object that lie one behind the other on the curve. */
struct ranks_spot {
    double low[3], high[3];
    double x[3]; /* of one of their vertices */
    uint32_t object;
    uint32_t begin, count;
};

/* In this rank alone: of all objects that are asked about; *spots is allocated.
 * PCCD_E_NOMEM. */
int ranks_spots_make(const struct ranks_pairing *pairing, struct ranks_spot **spots,
                     uint32_t *count);

static inline void ranks_leaf_bounds(const struct ranks_visitor *leaf, double low[3],
                                     double high[3])
{
    for (int k = 0; k < 3; k++) {
        low[k] = fmin(leaf->x[0][k], fmin(leaf->x[1][k], leaf->x[2][k]));
        high[k] = fmax(leaf->x[0][k], fmax(leaf->x[1][k], leaf->x[2][k]));
    }
}

#endif

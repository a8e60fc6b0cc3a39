/* pace.h - bounds of what a path does to points at most: velocity, acceleration, and its
 * change.
 *
 * Threads: [any].
 * Source: elementary/BOUNDS.md, "Bodies that turn".
 */
#ifndef ENG_PACE_H
#define ENG_PACE_H

#include "path.h"

/* More than what rounding takes off sums and products of positive numbers. */
#define ENG_PACE_SLOP (1 + 0x1p-40)

/* More than what squares below the normal range take off a length. */
#define ENG_PACE_LOST 0x1p-530

/* At least |x'|, |x''| and |x'''|. */
struct eng_pace {
    double speed;
    double bend;
    double jerk;
};

/* Return bounds up to time t1, for points that are at most `arm` from the axis z of the
 * last joint and at most `far` from the origin there. */
struct eng_pace eng_pace_bound(const struct eng_path *path, double arm, double far,
                               double t1);

#endif

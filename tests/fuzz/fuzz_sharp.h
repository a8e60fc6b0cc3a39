/* fuzz_sharp.h - pairs whose distance is about to be rounded otherwise.
 *
 * Move one coordinate of a pair, by halves, between two places where a number of the
 * answer differs, until no double is between them: so a number is as near as can be to
 * where rounding changes, on either side. A margin that is too small shows there.
 */
#ifndef FUZZ_SHARP_H
#define FUZZ_SHARP_H

#include "fuzz_distance.h"

/* Two cases of the kind that differ in one coordinate, by one unit in its last place, and
 * in a number of the answer. */
void fuzz_sharp_make(struct prng *prng, struct eng_distances *distances,
                     enum pccd_kind kind, struct fuzz_distance_case made[2]);

#endif

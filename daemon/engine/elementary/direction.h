/* direction.h - rejects a query by a direction along which the two features stay apart
 * for a span of time.
 */
#ifndef ENG_DIRECTION_H
#define ENG_DIRECTION_H

#include <stdbool.h>

#include "motion.h"

/* True: the features certainly do not meet at any time of the span between two poses. */
bool eng_direction_separates(const struct eng_motion *motion, const struct eng_pose *l,
                             const struct eng_pose *r);

#endif

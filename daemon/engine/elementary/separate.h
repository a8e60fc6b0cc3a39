/* daemon/engine/elementary/separate.h - rejects most queries cheaply: along a fixed
 * direction, such as the x axis, the two features stay apart.
 *
 * Room:     engine. May include: query.h.
 * Does:     try the three axes and the diagonals of two axes. Of the queries whose boxes
 *           overlap, this rejects most.
 * Threads:  [any].
 * Source:   BOUNDS.md, "Axes" and "Filter, diagonal directions".
 */
#ifndef ENG_SEPARATE_H
#define ENG_SEPARATE_H

#include <stdbool.h>

#include "query.h"

/* Is one feature above the other, certainly, along x, y or z, or along x +- y, y +- z or
 * z +- x, at both ends of the step, and so all the time? */
bool eng_query_separates(const struct eng_query *query);

#endif

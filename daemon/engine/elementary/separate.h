/* daemon/engine/elementary/separate.h - fixed directions between two features.
 *
 * Room:     engine. May include: query.h.
 * Does:     reject the queries that an axis or the diagonal of two axes tells apart: of
 *           those whose boxes overlap, most.
 * Threads:  [any].
 * Source:   BOUNDS.md, "Axes" and "Filter, diagonal directions".
 */
#ifndef ENG_SEPARATE_H
#define ENG_SEPARATE_H

#include "query.h"

/* Is one feature above the other, certainly, along x, y or z, or along x +- y, y +- z or
 * z +- x, at both ends of the step, and so all the time? */
bool eng_query_separates(const struct eng_query *query);

#endif

/* separate.h - rejects most queries cheaply: along a fixed direction, such as the x axis,
 * the two features stay apart.
 *
 * Source: BOUNDS.md, "Axes" and "Filter, diagonal directions".
 */
#ifndef ENG_SEPARATE_H
#define ENG_SEPARATE_H

#include <stdbool.h>

#include "query.h"

/* Is one feature above the other, certainly, along x, y or z, or along x +- y, y +- z or
 * z +- x, at both ends of the step, and so all the time? */
bool eng_query_separates(const struct eng_query *query);

#endif

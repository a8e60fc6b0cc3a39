/* curve.h - a curve through all of space: what is near along it is near in space.
 *
 * Source: Skilling, "Programming the Hilbert curve", AIP Conf. Proc. 707 (2004).
 */
#ifndef RANKS_CURVE_H
#define RANKS_CURVE_H

#include <stdint.h>

/* low, high: of the box that is filled; its longest side is as long as the curve's cube,
 * so that pieces of the curve are about as long as they are wide in a flat box, too.
 * Points beyond it have the place of the nearest in it. 63 bits. */
uint64_t ranks_curve_place(const double x[3], const double low[3], const double high[3]);

#endif

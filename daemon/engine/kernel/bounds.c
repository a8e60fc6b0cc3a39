/* bounds.c - the exact bounds of positions.
 *
 * Three vectors hold as many positions as one has lanes, and a lane of each of the three
 * always has the same axis: so nothing is turned until the end.
 */
#include <math.h>

#include "table.h"

#define NUMBERS (3 * ENG_D_LANES)

static void raise_axis(struct eng_bounds *bounds, int axis, double low, double high)
{
    bounds->low[axis] = low < bounds->low[axis] ? low : bounds->low[axis];
    bounds->high[axis] = high > bounds->high[axis] ? high : bounds->high[axis];
}

void ENG_KERNEL(bound_positions)(const double (*x)[3], size_t count,
                                 struct eng_bounds *bounds)
{
    double lanes[2][NUMBERS];
    eng_d low[3];
    eng_d high[3];
    for (int i = 0; i < 3; i++) {
        low[i] = eng_d_all(INFINITY);
        high[i] = eng_d_all(-INFINITY);
    }
    size_t done = 0;
    for (; done + ENG_D_LANES <= count; done += ENG_D_LANES) {
#pragma GCC unroll 3
        for (int i = 0; i < 3; i++) {
            eng_d v = eng_d_load(x[done] + i * ENG_D_LANES);
            low[i] = eng_d_min(low[i], v);
            high[i] = eng_d_max(high[i], v);
        }
    }
    for (int i = 0; i < 3; i++) {
        eng_d_store(lanes[0] + i * ENG_D_LANES, low[i]);
        eng_d_store(lanes[1] + i * ENG_D_LANES, high[i]);
    }
    for (int i = 0; i < NUMBERS; i++) {
        raise_axis(bounds, i % 3, lanes[0][i], lanes[1][i]);
    }
    for (; done < count; done++) {
        for (int axis = 0; axis < 3; axis++) {
            raise_axis(bounds, axis, x[done][axis], x[done][axis]);
        }
    }
}

/* directions.h - the nine directions along which filters look: axes and face diagonals.
 *
 * Threads: [any]; inline only. Included by files of this folder alone.
 */
#ifndef ENG_DIRECTIONS_H
#define ENG_DIRECTIONS_H

#include "vectors.h"

/* Coordinate x, y or z; x + y, x - y, y + z, y - z, z + x, z - x. */
ENG_INLINE eng_d eng_along(struct eng_v v, int direction)
{
    if (direction < 3) {
        return direction == 0 ? v.x : direction == 1 ? v.y : v.z;
    }
    int plane = (direction - 3) / 2;
    eng_d first = plane == 0 ? v.x : plane == 1 ? v.y : v.z;
    eng_d second = plane == 0 ? v.y : plane == 1 ? v.z : v.x;
    return direction % 2 ? first + second : first - second;
}

#endif

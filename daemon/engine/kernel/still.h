/* still.h - sixteen boxes that stand still, kept in registers while many other boxes are
 * compared with them.
 *
 * Threads: [any]; inline only. Included by files of this folder alone.
 */
#ifndef ENG_STILL_H
#define ENG_STILL_H

#include "overlap.h"

/* Rows of boxes that stand still, in registers where there are as many. */
struct held_rows {
    eng_f low[3][PARTS];
    eng_f high[3][PARTS];
};

ENG_INLINE void hold_rows(struct bounds rows, struct held_rows *held)
{
#pragma GCC unroll 3
    for (uint32_t axis = 0; axis < 3; axis++) {
        memcpy(held->low[axis], place_of(rows, ENG_LOW0, axis, 0), sizeof held->low[0]);
        memcpy(held->high[axis], place_of(rows, ENG_HIGH0, axis, 0), sizeof held->low[0]);
    }
}

/* Lanes of a part that a box meets that stands still. */
ENG_INLINE eng_left met_by_held(struct bounds box, const struct held_rows *held,
                                uint32_t part)
{
    eng_fi signs = {0};
#pragma GCC unroll 3
    for (uint32_t i = 0; i < 3; i++) {
        signs =
            eng_fi_or_or(signs, (eng_fi)(bound(box, ENG_LOW0, i) + held->high[i][part]),
                         (eng_fi)(bound(box, ENG_HIGH0, i) + held->low[i][part]));
    }
    return eng_left_of(signs);
}

#endif

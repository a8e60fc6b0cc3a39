/* gaps.c - how far one box is from sixteen.
 *
 * Source: elementary/BOUNDS.md, "Distances of boxes".
 */
#include "table.h"

uint32_t ENG_KERNEL(box_gaps)(const float (*low)[ENG_WIDE], const float (*high)[ENG_WIDE],
                              const float box[2][4], float limit, float square[ENG_WIDE])
{
    uint32_t bits = 0;
    for (uint32_t at = 0; at < ENG_WIDE; at += ENG_F_LANES) {
        eng_f sum = eng_f_all(0);
#pragma GCC unroll 3
        for (int k = 0; k < 3; k++) {
            eng_f above = -(eng_f_load(low[k] + at) + eng_f_all(box[1][k]));
            eng_f below = -(eng_f_load(high[k] + at) + eng_f_all(box[0][k]));
            eng_f gap = eng_f_max(eng_f_max(above, below), eng_f_all(0));
            sum += gap * gap;
        }
        eng_f_store(square + at, sum);
        bits |= eng_fm_bits(eng_f_less(sum, eng_f_all(limit))) << at;
    }
    return bits;
}

/* four.h - a vector of four floats on every instruction set: one side of one box.
 *
 * Threads: [any]; inline only. Included by files of this folder alone.
 */
#ifndef ENG_FOUR_H
#define ENG_FOUR_H

#include <stdint.h>

typedef float eng_four __attribute__((vector_size(16), may_alias));
typedef int32_t eng_four_bits __attribute__((vector_size(16), may_alias));

/* a > b ? a : b */
static inline __attribute__((always_inline)) eng_four eng_four_max(eng_four a, eng_four b)
{
    eng_four_bits is_a = a > b;
    return (eng_four)((is_a & (eng_four_bits)a) | (~is_a & (eng_four_bits)b));
}

#endif

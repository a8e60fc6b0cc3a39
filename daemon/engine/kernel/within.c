/* within.c - finds coordinates that are no numbers, or out of range. */
#include <math.h>

#include "table.h"

/* Vectors at a time: as many comparisons as wait for each other without it. */
#define UNROLL 4

bool ENG_KERNEL(all_within)(const double *x, size_t count, double limit)
{
    const eng_d most = eng_d_all(limit);
    eng_dm good = eng_d_at_most(most, most);
    size_t i = 0;
    for (; i + UNROLL * ENG_D_LANES <= count; i += UNROLL * ENG_D_LANES) {
        for (size_t k = 0; k < UNROLL; k++) {
            eng_d v = eng_d_load(x + i + k * ENG_D_LANES);
            good = eng_dm_and(good, eng_d_at_most(eng_d_abs(v), most));
        }
    }
    bool rest = eng_dm_bits(good) == ENG_D_ALL;
    for (; i < count; i++) {
        rest &= fabs(x[i]) <= limit;
    }
    return rest;
}

bool ENG_KERNEL(widen_within)(double *out, const float *x, size_t count, double limit)
{
    const eng_d most = eng_d_all(limit);
    eng_dm good = eng_d_at_most(most, most);
    size_t i = 0;
    for (; i + ENG_D_LANES <= count; i += ENG_D_LANES) {
        eng_d v = eng_d_widen(x + i);
        eng_d_store(out + i, v);
        good = eng_dm_and(good, eng_d_at_most(eng_d_abs(v), most));
    }
    bool rest = eng_dm_bits(good) == ENG_D_ALL;
    for (; i < count; i++) {
        out[i] = (double)x[i];
        rest &= fabs(out[i]) <= limit;
    }
    return rest;
}

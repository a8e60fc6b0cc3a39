/* marks_end.h - loads points that were rounded to a grid (marks), as they are at one end
 * of the step, for the sieve of what is near.
 *
 * Threads: [any]; inline only. Included by files of this folder alone.
 */
#ifndef ENG_MARKS_END_H
#define ENG_MARKS_END_H

#include "marks.h"

#if ENG_VECTOR_BYTES == 8

ENG_INLINE void eng_marks_load_at(uint32_t kind, const struct eng_sieve *sieve,
                                  const uint32_t *a, const uint32_t *b, uint32_t end,
                                  struct eng_g *d, eng_fi *less)
{
    struct eng_corners p = eng_corners_of(kind, sieve, *a, *b);
    const int32_t *from = end ? p.mark[0]->q1 : p.mark[0]->q0;
    for (int k = 0; k < (kind == PCCD_EF ? 4 : 3); k++) {
        const int32_t *to = end ? p.mark[k + 1]->q1 : p.mark[k + 1]->q0;
        d[k] = (struct eng_g){{to[0] - from[0]}, {to[1] - from[1]}, {to[2] - from[2]}};
    }
    for (int k = 0; less && k < 4; k++) {
        int32_t own = end ? p.mark[k]->less1 : p.mark[k]->less0;
        *less = k == 0 || own < (*less)[0] ? (eng_fi){own} : *less;
    }
}

#else

/* A corner of pairs 0, 4, 8 .. of those from `pairs` on, as it lies in memory. */
ENG_INLINE eng_fi eng_marks_at(const struct eng_corners *pairs, int corner, uint32_t end)
{
    const int32_t *at[ENG_F_LANES / 4];
#pragma GCC unroll 4
    for (uint32_t i = 0; i < ENG_F_LANES / 4; i++) {
        const struct eng_mark *mark = pairs[4 * i].mark[corner];
        at[i] = end ? mark->q1 : mark->q0;
    }
#if ENG_VECTOR_BYTES == 64
    return (eng_fi)_mm512_inserti64x4(
        _mm512_castsi256_si512(eng_marks_ends(at[0], at[1])),
        eng_marks_ends(at[2], at[3]), 1);
#elif ENG_VECTOR_BYTES == 32
    return (eng_fi)eng_marks_ends(at[0], at[1]);
#else
    return eng_fi_of(at[0]);
#endif
}

/* d[k] of pairs 0 .. ENG_F_LANES - 1: the marks 1, 2, 3, of EF 4, too, minus mark 0.
 * *less, unless NULL: of VF and EE, the least that any of the marks has of it. */
ENG_INLINE void eng_marks_load_at(uint32_t kind, const struct eng_sieve *sieve,
                                  const uint32_t *a, const uint32_t *b, uint32_t end,
                                  struct eng_g *d, eng_fi *less)
{
    const int count = kind == PCCD_EF ? 4 : 3;
    struct eng_corners pairs[ENG_F_LANES];
    eng_fi v[4][4];
    eng_fi least[4];
#pragma GCC unroll 16
    for (uint32_t i = 0; i < ENG_F_LANES; i++) {
        pairs[i] = eng_corners_of(kind, sieve, a[i], b[i]);
    }
#pragma GCC unroll 4
    for (int i = 0; i < 4; i++) {
        eng_fi from = eng_marks_at(pairs + i, 0, end);
        least[i] = from;
#pragma GCC unroll 4
        for (int k = 0; k < count; k++) {
            eng_fi to = eng_marks_at(pairs + i, k + 1, end);
            least[i] = eng_fi_min(least[i], to);
            v[k][i] = to - from;
        }
    }
#pragma GCC unroll 4
    for (int k = 0; k < count; k++) {
        d[k] = eng_marks_turn_at(v[k]);
    }
    if (less) {
        *less = eng_marks_fourth(least);
    }
}

#endif

#endif

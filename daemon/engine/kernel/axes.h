/* axes.h - rejects pairs that lie apart along an axis, by comparing points rounded to a
 * grid of whole numbers.
 *
 * Compare marks in the layout that they have in memory, for the many pairs whose features
 * an axis separates for the whole step: what apart.c does, from half the bytes.
 *
 * Threads: [any]; inline only. Included by files of this folder alone.
 * Source: BOUNDS.md: a gap of two units at both ends is one all the time.
 */
#ifndef ENG_AXES_H
#define ENG_AXES_H

#include "marks.h"

/* Pairs whose comparisons are kept as bytes and looked at afterwards: moving each to a
 * register of its own takes longer, and so does to wait for it. */
#define ENG_AXES_BYTES 256u

/* A byte for each pair, bits x0 y0 z0 word x1 y1 z1 word: b lies above a there by two
 * units or more; a lies above b. */
struct eng_axes {
    uint8_t below[ENG_AXES_BYTES];
    uint8_t above[ENG_AXES_BYTES];
};

#if ENG_VECTOR_BYTES == 8

/* Smallest and largest coordinate of marks first .. last - 1. */
ENG_INLINE void eng_axes_reach(const struct eng_corners *pair, int first, int last,
                               int end, int axis, int32_t *low, int32_t *high)
{
    for (int i = first; i < last; i++) {
        const struct eng_mark *mark = pair->mark[i];
        int32_t x = end ? mark->q1[axis] : mark->q0[axis];
        *low = i == first || x < *low ? x : *low;
        *high = i == first || x > *high ? x : *high;
    }
}

ENG_INLINE void eng_axes_look(enum pccd_kind kind, const struct eng_sieve *sieve,
                              const uint32_t *a, const uint32_t *b, uint8_t *below,
                              uint8_t *above)
{
    struct eng_corners pair = eng_corners_of(kind, sieve, *a, *b);
    const int split = kind == PCCD_VF ? 1 : 2;
    *below = *above = 0;
    for (int i = 0; i < 6; i++) {
        int32_t low[2] = {0, 0};
        int32_t high[2] = {0, 0};
        eng_axes_reach(&pair, 0, split, i / 3, i % 3, &low[0], &high[0]);
        eng_axes_reach(&pair, split, 4, i / 3, i % 3, &low[1], &high[1]);
        uint8_t bit = (uint8_t)(1u << (i + i / 3));
        *below = (uint8_t)(*below | (low[1] > high[0] + 1 ? bit : 0));
        *above = (uint8_t)(*above | (low[0] > high[1] + 1 ? bit : 0));
    }
}

#else

/* Marks as they lie in memory: two pairs', one's, or one's at one end. */
#if ENG_VECTOR_BYTES == 64
#define ENG_AXES_PAIRS 2u
#else
#define ENG_AXES_PAIRS 1u
#endif

ENG_INLINE eng_fi eng_axes_mark(const struct eng_corners *pairs, int corner, int end)
{
#if ENG_VECTOR_BYTES == 64
    (void)end;
    return (eng_fi)eng_marks_two(pairs[0].mark[corner], pairs[1].mark[corner]);
#else
    return eng_fi_of(end ? pairs->mark[corner]->q1 : pairs->mark[corner]->q0);
#endif
}

/* The lanes of a > b + 1. */
ENG_INLINE uint32_t eng_axes_above(eng_fi a, eng_fi b)
{
#if ENG_VECTOR_BYTES == 64
    return _mm512_cmpgt_epi32_mask((__m512i)a, (__m512i)(b + 1));
#else
    return ~eng_fi_no_signs(b + 1 - a) & ENG_F_ALL;
#endif
}

/* The bits of ENG_F_LANES pairs. */
ENG_INLINE void eng_axes_look(enum pccd_kind kind, const struct eng_sieve *sieve,
                              const uint32_t *a, const uint32_t *b, uint8_t *below,
                              uint8_t *above)
{
#pragma GCC unroll 8
    for (uint32_t i = 0; i < ENG_F_LANES; i += ENG_AXES_PAIRS) {
        struct eng_corners pairs[ENG_AXES_PAIRS];
        uint32_t bits[2] = {0, 0};
#pragma GCC unroll 2
        for (uint32_t k = 0; k < ENG_AXES_PAIRS; k++) {
            pairs[k] = eng_corners_of(kind, sieve, a[i + k], b[i + k]);
        }
#pragma GCC unroll 2
        for (int end = 0; end < (ENG_F_LANES == 4 ? 2 : 1); end++) {
            eng_fi mark[4];
#pragma GCC unroll 4
            for (int k = 0; k < 4; k++) {
                mark[k] = eng_axes_mark(pairs, k, end);
            }
            eng_fi low = eng_fi_min(mark[2], mark[3]);
            eng_fi high = eng_fi_max(mark[2], mark[3]);
            if (kind == PCCD_VF) {
                low = eng_fi_min(mark[1], low);
                high = eng_fi_max(mark[1], high);
                bits[0] |= eng_axes_above(low, mark[0]) << 4 * end;
                bits[1] |= eng_axes_above(mark[0], high) << 4 * end;
            } else {
                bits[0] |= eng_axes_above(low, eng_fi_max(mark[0], mark[1])) << 4 * end;
                bits[1] |= eng_axes_above(eng_fi_min(mark[0], mark[1]), high) << 4 * end;
            }
        }
        memcpy(below + i, &bits[0], ENG_AXES_PAIRS);
        memcpy(above + i, &bits[1], ENG_AXES_PAIRS);
    }
}

#endif

/* Of ENG_F_LANES pairs, bit i: pair i has an axis with both ends. */
ENG_INLINE uint32_t eng_axes_apart(const uint8_t *below, const uint8_t *above)
{
#if ENG_VECTOR_BYTES == 64
    __m128i up = _mm_loadu_si128((const __m128i *)(const void *)below);
    __m128i down = _mm_loadu_si128((const __m128i *)(const void *)above);
    __m128i both = _mm_or_si128(_mm_and_si128(up, _mm_srli_epi16(up, 4)),
                                _mm_and_si128(down, _mm_srli_epi16(down, 4)));
    return _mm_test_epi8_mask(both, _mm_set1_epi8(7));
#elif ENG_VECTOR_BYTES == 32
    uint64_t up;
    uint64_t down;
    memcpy(&up, below, sizeof up);
    memcpy(&down, above, sizeof down);
    uint64_t both = (up & up >> 4) | (down & down >> 4);
    /* 1 to 7 and 127 set the highest bit, and carry nothing into the next byte. */
    both = (both & 0x0707070707070707u) + 0x7f7f7f7f7f7f7f7fu;
    return (uint32_t)_pext_u64(both, 0x8080808080808080u);
#else
    uint32_t bits = 0;
    for (uint32_t i = 0; i < ENG_F_LANES; i++) {
        uint32_t both = (below[i] & below[i] >> 4) | (above[i] & above[i] >> 4);
        bits |= (uint32_t)((both & 7u) != 0) << i;
    }
    return bits;
#endif
}

#endif

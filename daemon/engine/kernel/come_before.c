/* come_before.c - which items of a list come before one of them. */
#include "lanes.h"
#include "table.h"

/* Gather a coordinate of ENG_F_LANES items. */
ENG_INLINE eng_f gather(const struct eng_split_item *items, int axis)
{
#if ENG_VECTOR_BYTES == 64
    /* Four items a register: two and two of them, then the halves. */
    const __m512i every_fourth =
        _mm512_setr_epi32(0, 4, 8, 12, 16, 20, 24, 28, 0, 4, 8, 12, 16, 20, 24, 28);
    __m512i at = _mm512_add_epi32(every_fourth, _mm512_set1_epi32(axis));
    __m512i low = _mm512_permutex2var_epi32(_mm512_loadu_si512(items), at,
                                            _mm512_loadu_si512(items + 4));
    __m512i high = _mm512_permutex2var_epi32(_mm512_loadu_si512(items + 8), at,
                                             _mm512_loadu_si512(items + 12));
    return (eng_f)_mm512_inserti64x4(low, _mm512_castsi512_si256(high), 1);
#else
    float x[ENG_F_LANES];
    for (uint32_t i = 0; i < ENG_F_LANES; i++) {
        x[i] = items[i].centroid[axis];
    }
    return eng_f_load(x);
#endif
}

uint64_t ENG_KERNEL(come_before)(const struct eng_split_item *items,
                                 const struct eng_split_item *pivot, int axis)
{
    const eng_f x = eng_f_all(pivot->centroid[axis]);
    uint64_t before = 0;
    uint64_t others = 0; /* that are not in the same place */
    for (uint32_t at = 0; at < 64; at += ENG_F_LANES) {
        eng_f here = gather(items + at, axis);
        uint64_t less = eng_fm_bits(eng_f_less(here, x));
        before |= less << at;
        others |= (less | eng_fm_bits(eng_f_less(x, here))) << at;
    }
    for (uint64_t same = ~others; same != 0; same &= same - 1) {
        uint32_t i = (uint32_t)__builtin_ctzll(same);
        before |= (uint64_t)(items[i].id < pivot->id) << i;
    }
    return before;
}

/* reject_axes.c - pairs that an axis separates all the time.
 *
 * If all points of one feature lie above all points of the other along an axis at t = 0
 * and at t = 1, the differences of their coordinates, linear in t, are positive at every
 * t, and by convexity no point of one feature is a point of the other. Comparisons of
 * doubles are exact: there is no margin.
 */
#include <assert.h>

#include "kinds.h"
#include "table.h"

/* A record is x0 y0 z0 word x1 y1 z1 word. */
#define VECTORS (64 / ENG_VECTOR_BYTES)

struct record {
    eng_d v[VECTORS];
};

ENG_INLINE struct record load(const struct eng_point *point)
{
    struct record record;
#pragma GCC unroll 8
    for (int i = 0; i < VECTORS; i++) {
        int at = i * ENG_D_LANES;
        record.v[i] = eng_d_load(at < 4 ? point->x0 + at : point->x1 + (at - 4));
    }
    return record;
}

ENG_INLINE struct record least(struct record a, struct record b)
{
#pragma GCC unroll 8
    for (int i = 0; i < VECTORS; i++) {
        a.v[i] = eng_d_min(a.v[i], b.v[i]);
    }
    return a;
}

ENG_INLINE struct record most(struct record a, struct record b)
{
#pragma GCC unroll 8
    for (int i = 0; i < VECTORS; i++) {
        a.v[i] = eng_d_max(a.v[i], b.v[i]);
    }
    return a;
}

/* The numbers of one pair that are compared. */
struct order {
    struct record a, b; /* apart if a < b along one axis at both ends, */
    struct record c, d; /* or c < d along one */
};

/* `points_a`: those of the first feature; the rest are the other one's. */
ENG_INLINE struct order order_of(uint32_t points_a, const struct eng_point *points,
                                 const uint32_t quad[4])
{
    struct record a = load(&points[quad[0]]);
    struct record b = load(&points[quad[1]]);
    struct record c = load(&points[quad[2]]);
    struct record d = load(&points[quad[3]]);
    struct record low = least(c, d);
    struct record high = most(c, d);
    if (points_a == 1) {
        return (struct order){a, least(b, low), most(b, high), a};
    }
    return (struct order){most(a, b), low, high, least(a, b)};
}

#if ENG_D_LANES == 8

/* Pairs whose comparisons are kept as bytes, eight of which are looked at in one word:
 * moving every mask to a register of its own takes a third of the time. */
#define BYTES 256u

/* Bit i: byte i of both words, the bits of x0 y0 z0 word x1 y1 z1 word, has an axis with
 * both ends. */
ENG_INLINE uint32_t axes_of(uint64_t below, uint64_t above)
{
    uint64_t both = (below & below >> 4) | (above & above >> 4);
    /* 1 to 7 and 127 set the highest bit, and carry nothing into the next byte. */
    uint64_t any = (both & 0x0707070707070707u) + 0x7f7f7f7f7f7f7f7fu;
    return (uint32_t)_pext_u64(any, 0x8080808080808080u);
}

ENG_INLINE uint32_t not_apart(uint32_t points_a, const struct eng_point *points,
                              const uint32_t (*quads)[4], uint32_t count, uint32_t *kept)
{
    const __m256i lanes = _mm256_setr_epi32(0, 1, 2, 3, 4, 5, 6, 7);
    uint32_t kept_count = 0;
    for (uint32_t first = 0; first < count; first += BYTES) {
        uint32_t n = count - first < BYTES ? count - first : BYTES;
        uint8_t below[BYTES + 8];
        uint8_t above[BYTES + 8];
        uint32_t i;
        for (i = 0; i < n; i++) {
            struct order order = order_of(points_a, points, quads[first + i]);
            below[i] = (uint8_t)eng_dm_bits(eng_d_less(order.a.v[0], order.b.v[0]));
            above[i] = (uint8_t)eng_dm_bits(eng_d_less(order.c.v[0], order.d.v[0]));
        }
        memset(below + n, 0, 8);
        memset(above + n, 0, 8);
        for (i = 0; i < n; i += 8) {
            uint64_t words[2];
            memcpy(&words[0], below + i, 8);
            memcpy(&words[1], above + i, 8);
            uint32_t left = ~axes_of(words[0], words[1]) & 0xffu;
            left &= n - i < 8 ? (1u << (n - i)) - 1 : 0xffu;
            __m256i pairs = _mm256_add_epi32(lanes, _mm256_set1_epi32((int)(first + i)));
            __mmask8 room = (__mmask8)((1u << __builtin_popcount(left)) - 1);
            _mm256_mask_storeu_epi32(kept + kept_count, room,
                                     _mm256_maskz_compress_epi32((__mmask8)left, pairs));
            kept_count += (uint32_t)__builtin_popcount(left);
        }
    }
    return kept_count;
}

#else

/* The owner's words, which may be anything, are not looked at. */
ENG_INLINE bool is_apart(const struct order *order)
{
    uint32_t bits = 0;
#pragma GCC unroll 4
    for (int i = 0; i < VECTORS / 2; i++) {
        int j = i + VECTORS / 2;
        eng_dm below = eng_dm_and(eng_d_less(order->a.v[i], order->b.v[i]),
                                  eng_d_less(order->a.v[j], order->b.v[j]));
        eng_dm above = eng_dm_and(eng_d_less(order->c.v[i], order->d.v[i]),
                                  eng_d_less(order->c.v[j], order->d.v[j]));
        bits |= eng_dm_bits(eng_dm_or(below, above)) << (i * ENG_D_LANES);
    }
    return (bits & 7u) != 0;
}

ENG_INLINE uint32_t not_apart(uint32_t points_a, const struct eng_point *points,
                              const uint32_t (*quads)[4], uint32_t count, uint32_t *kept)
{
    uint32_t kept_count = 0;
    for (uint32_t i = 0; i < count; i++) {
        struct order order = order_of(points_a, points, quads[i]);
        kept[kept_count] = i;
        kept_count += !is_apart(&order);
    }
    return kept_count;
}

#endif

uint32_t ENG_KERNEL(reject_axes)(struct eng_quads chunk, uint32_t count, uint32_t *kept)
{
    assert(common_kinds[chunk.kind].points[0] <= 2);
    return common_kinds[chunk.kind].points[0] == 1
               ? not_apart(1, chunk.points, chunk.quads, count, kept)
               : not_apart(2, chunk.points, chunk.quads, count, kept);
}

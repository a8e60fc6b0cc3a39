/* daemon/engine/kernel/apart.c - pairs that an axis separates all the time.
 *
 * Room:     engine.
 * Does:     compare coordinates of whole records: a record is loaded as it lies in
 *           memory, so nothing has to be turned for the many pairs that end here.
 * Threads:  [any].
 *
 * If all points of one feature lie above all points of the other along an axis at t = 0
 * and at t = 1, the differences of their coordinates, linear in t, are positive at every
 * t, and by convexity no point of one feature is a point of the other. Comparisons of
 * doubles are exact: there is no margin.
 */
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

/* Is a < b along one axis at both ends, or c < d along one? The owner's words, which may
 * be anything, are not looked at. */
ENG_INLINE bool ordered(struct record a, struct record b, struct record c,
                        struct record d)
{
#if ENG_D_LANES == 8
    uint32_t below = eng_dm_bits(eng_d_less(a.v[0], b.v[0]));
    uint32_t above = eng_dm_bits(eng_d_less(c.v[0], d.v[0]));
    return (((below & below >> 4) | (above & above >> 4)) & 7u) != 0;
#else
    uint32_t bits = 0;
#pragma GCC unroll 4
    for (int i = 0; i < VECTORS / 2; i++) {
        int j = i + VECTORS / 2;
        eng_dm below = eng_dm_and(eng_d_less(a.v[i], b.v[i]), eng_d_less(a.v[j], b.v[j]));
        eng_dm above = eng_dm_and(eng_d_less(c.v[i], d.v[i]), eng_d_less(c.v[j], d.v[j]));
        bits |= eng_dm_bits(eng_dm_or(below, above)) << (i * ENG_D_LANES);
    }
    return (bits & 7u) != 0;
#endif
}

ENG_INLINE uint32_t not_apart(enum eng_kind kind, const struct eng_point *points,
                              const uint32_t (*quads)[4], uint32_t count, uint32_t *kept)
{
    uint32_t kept_count = 0;
    for (uint32_t i = 0; i < count; i++) {
        struct record a = load(&points[quads[i][0]]);
        struct record b = load(&points[quads[i][1]]);
        struct record c = load(&points[quads[i][2]]);
        struct record d = load(&points[quads[i][3]]);
        struct record low = least(c, d);
        struct record high = most(c, d);
        bool is_apart = kind == ENG_VF ? ordered(a, least(b, low), most(b, high), a)
                                       : ordered(most(a, b), low, high, least(a, b));
        kept[kept_count] = i;
        kept_count += !is_apart;
    }
    return kept_count;
}

uint32_t ENG_KERNEL(apart)(enum eng_kind kind, const struct eng_point *points,
                           const uint32_t (*quads)[4], uint32_t count, uint32_t *kept)
{
    return kind == ENG_VF ? not_apart(ENG_VF, points, quads, count, kept)
                          : not_apart(ENG_EE, points, quads, count, kept);
}

/* sift_near.c - what is certainly not near at an end of the step.
 *
 * Source: BOUNDS.md, "The sieve: what is near".
 */
#define ENG_IN_FLOATS
#include "reject.h"
#include "table.h"

/* ---- marks at one end -------------------------------------------------------------- */

#if ENG_VECTOR_BYTES == 8

ENG_INLINE void load_at(uint32_t kind, const struct eng_sieve *sieve, const uint32_t *a,
                        const uint32_t *b, uint32_t end, struct eng_g *d, eng_fi *less)
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
ENG_INLINE eng_fi corner_at(const struct eng_corners *pairs, int corner, uint32_t end)
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
ENG_INLINE void load_at(uint32_t kind, const struct eng_sieve *sieve, const uint32_t *a,
                        const uint32_t *b, uint32_t end, struct eng_g *d, eng_fi *less)
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
        eng_fi from = corner_at(pairs + i, 0, end);
        least[i] = from;
#pragma GCC unroll 4
        for (int k = 0; k < count; k++) {
            eng_fi to = corner_at(pairs + i, k + 1, end);
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

/* ---- tests ------------------------------------------------------------------------- */

/* Scales whole numbers below 2^31, so that squares of products of three fit a float. */
#define SMALLER 0x1p-16f

ENG_INLINE struct eng_v smaller(struct eng_g g)
{
    return eng_v_scale(eng_f_all(SMALLER), vector_of(g));
}

ENG_INLINE struct eng_g less(struct eng_g a, struct eng_g b)
{
    return (struct eng_g){a.x - b.x, a.y - b.y, a.z - b.z};
}

/* More than the largest coordinate, on the grid and off it. */
ENG_INLINE eng_f reach_of(struct eng_v a)
{
    return eng_v_size(a) + OFF_GRID * SMALLER;
}

/* The normal of two differences of these sizes. */
struct normal {
    struct eng_v n;
    eng_f size_u, size_v;
};

ENG_INLINE struct normal normal_of(struct eng_v u, struct eng_v v)
{
    return (struct normal){eng_v_cross(u, v), reach_of(u), reach_of(v)};
}

/* More than the error of w . n. */
ENG_INLINE eng_f height_error(struct eng_v w, const struct normal *normal)
{
    eng_f a = reach_of(w);
    eng_f b = normal->size_u;
    eng_f c = normal->size_v;
    return 64 * ENG_N_U * (a * b * c) + 7 * SMALLER * (a * b + (a + b) * c);
}

/* More than the error of n . n. */
ENG_INLINE eng_f square_error(const struct normal *normal)
{
    eng_f b = normal->size_u;
    eng_f c = normal->size_v;
    eng_f error = 10 * ENG_N_U * (b * c) + 3 * SMALLER * (b + c);
    return error * (6 * eng_v_size(normal->n) + 3 * error);
}

/* Return the lanes in which the planes through the features, across both, are farther
 * apart than the root of `square`. */
ENG_INLINE eng_fm planes_beyond(enum pccd_kind kind, const struct eng_g d[3],
                                eng_f square)
{
    bool is_vf = kind == PCCD_VF;
    struct eng_v u = smaller(is_vf ? less(d[1], d[0]) : d[0]);
    struct eng_v v = smaller(is_vf ? less(d[2], d[0]) : less(d[2], d[1]));
    struct eng_v w = smaller(is_vf ? d[0] : d[1]);
    struct normal normal = normal_of(u, v);
    return plane_is_beyond(w, normal.n, height_error(w, &normal), square_error(&normal),
                           square);
}

/* A way from the second feature to the first. */
struct way {
    struct eng_v v;
    eng_f square;
};

/* From the foot on an edge e to a point that is `from` its begin; or what was shorter
 * before. `turned`: the edge is the first feature's. */
ENG_INLINE void shorten(struct way *way, struct eng_v from, struct eng_v e,
                        eng_f per_square, bool turned)
{
    const eng_f zero = {0};
    eng_f at = eng_f_min(eng_f_max(eng_v_dot(from, e) * per_square, zero), zero + 1);
    struct eng_v foot = eng_v_scale(at, e);
    struct eng_v v = turned ? eng_v_sub(foot, from) : eng_v_sub(from, foot);
    eng_f square = eng_v_dot(v, v);
    eng_fm is_shorter = eng_f_less(square, way->square);
    way->v = eng_v_select(is_shorter, v, way->v);
    way->square = eng_f_select(is_shorter, square, way->square);
}

/* About the shortest one from a corner of either to the edges of the other. */
ENG_INLINE struct eng_v way_of(enum pccd_kind kind, const struct eng_v p[3])
{
    const eng_f zero = {0};
    const struct eng_v none = {zero, zero, zero};
    struct way way = {p[0], zero + 0x1p100f};
    if (kind == PCCD_VF) {
#pragma GCC unroll 3
        for (int i = 0; i < 3; i++) {
            struct eng_v side = eng_v_sub(p[(i + 1) % 3], p[i]);
            shorten(&way, eng_v_sub(none, p[i]), side, 1 / eng_v_dot(side, side), false);
        }
        return way.v;
    }
    struct eng_v second = eng_v_sub(p[2], p[1]);
    eng_f per_first = 1 / eng_v_dot(p[0], p[0]);
    eng_f per_second = 1 / eng_v_dot(second, second);
    shorten(&way, eng_v_sub(none, p[1]), second, per_second, false);
    shorten(&way, eng_v_sub(p[0], p[1]), second, per_second, false);
    shorten(&way, p[1], p[0], per_first, true);
    shorten(&way, p[2], p[0], per_first, true);
    return way.v;
}

/* Return the lanes in which they are farther apart along such a vector. */
ENG_INLINE eng_fm edges_are_beyond(enum pccd_kind kind, const struct eng_g d[3],
                                   eng_f square)
{
    const eng_f zero = {0};
    struct eng_v p[3];
#pragma GCC unroll 3
    for (int k = 0; k < 3; k++) {
        p[k] = smaller(d[k]);
    }
    struct eng_v way = way_of(kind, p);
    eng_f along = eng_v_dot(way, p[0]);
    eng_f gap = zero - eng_f_max(eng_v_dot(way, p[1]), eng_v_dot(way, p[2]));
    if (kind == PCCD_VF) {
        gap = eng_f_min(gap, zero - along);
    } else {
        gap += eng_f_min(along, zero);
    }
    eng_f size =
        eng_f_max_abs(eng_f_max_abs(reach_of(p[0]), reach_of(p[1])), reach_of(p[2]));
    gap -= reach_of(way) * (8 * SMALLER + 32 * ENG_N_U * size);
    return eng_fm_and(eng_f_less(zero, gap),
                      eng_f_less(square * eng_v_dot(way, way), gap * gap));
}

/* In cells: nothing that is multiplied by it falls below the range of floats. */
ENG_INLINE eng_f scaled(eng_f reach)
{
    return eng_f_max(reach * SMALLER, eng_f_all(0x1p-40f));
}

/* By boxes and planes most pairs go that are too far apart; ways take twice as long. */
enum look { LOOK_QUICK, LOOK_AT_EDGES, LOOK_ASIDE };

/* Return the lanes that are certainly farther apart than `reach`, or, if it `prunes`,
 * than is known. */
ENG_INLINE uint32_t beyond(enum pccd_kind kind, enum look look, bool prunes,
                           const struct eng_sieve *sieve, const uint32_t *a,
                           const uint32_t *b, uint32_t end, eng_f reach)
{
    struct eng_g d[3];
    eng_fi less;
    load_at(kind, sieve, a, b, end, d, prunes ? &less : NULL);
    if (prunes) {
        reach = (eng_f)((eng_fi)reach - less);
    }
    reach = scaled(reach);
    eng_f square = reach * reach * ENG_SLACK;
    return eng_fm_bits(
        look == LOOK_AT_EDGES
            ? edges_are_beyond(kind, d, square)
            : eng_fm_or(boxes_are_beyond(kind, d, eng_f_all(SMALLER), square),
                        planes_beyond(kind, d, square)));
}

/* Return the lanes in which both ends of the edge are certainly on one side of the plane
 * through the face. */
ENG_INLINE uint32_t aside(const struct eng_sieve *sieve, const uint32_t *a,
                          const uint32_t *b, uint32_t end)
{
    struct eng_g d[4]; /* from a corner to the ends of the edge, and to the others */
    load_at(PCCD_EF, sieve, a, b, end, d, NULL);
    struct eng_v first = smaller(d[0]);
    struct eng_v second = smaller(d[1]);
    struct normal normal = normal_of(smaller(d[2]), smaller(d[3]));
    eng_f height[2] = {eng_v_dot(first, normal.n), eng_v_dot(second, normal.n)};
    eng_f error[2] = {height_error(first, &normal), height_error(second, &normal)};
    return are_on_one_side(2, height, height, error);
}

ENG_INLINE uint32_t pass_near(uint32_t kind, enum look look, bool prunes,
                              const struct eng_sieve *sieve, uint32_t end, float reach,
                              uint32_t *a, uint32_t *b, uint32_t count)
{
    uint32_t kept = 0;
    for (uint32_t i = 0; i < count; i += ENG_F_LANES) {
        uint32_t n = count - i < ENG_F_LANES ? count - i : ENG_F_LANES;
        uint32_t full[2][ENG_F_LANES];
        const uint32_t *a_in = a + i;
        const uint32_t *b_in = b + i;
        if (n < ENG_F_LANES) {
            eng_marks_fill(a_in, b_in, n, full);
            a_in = full[0];
            b_in = full[1];
        }
        uint32_t out = look == LOOK_ASIDE
                           ? aside(sieve, a_in, b_in, end)
                           : beyond((enum pccd_kind)kind, look, prunes, sieve, a_in, b_in,
                                    end, eng_f_all(reach));
        kept += eng_compress_pairs(a + kept, b + kept, a + i, b + i,
                                   ~out & ENG_F_ALL >> (ENG_F_LANES - n));
    }
    return kept;
}

ENG_INLINE uint32_t sift_near(uint32_t kind, bool prunes, const struct eng_sieve *sieve,
                              uint32_t end, float reach, uint32_t *a, uint32_t *b,
                              uint32_t count)
{
    if (kind == PCCD_EF) {
        return pass_near(kind, LOOK_ASIDE, false, sieve, end, reach, a, b, count);
    }
    count = pass_near(kind, LOOK_QUICK, prunes, sieve, end, reach, a, b, count);
    return pass_near(kind, LOOK_AT_EDGES, prunes, sieve, end, reach, a, b, count);
}

/* The end, and whether it prunes, as constants of the code. */
#define SIFT_NEAR(kind, prunes)                                                          \
    (sieve->end == 0 ? sift_near(kind, prunes, sieve, 0, reach, a, b, count)             \
                     : sift_near(kind, prunes, sieve, 1, reach, a, b, count))

uint32_t ENG_KERNEL(sift_near)(uint32_t kind, const struct eng_sieve *sieve, float reach,
                               uint32_t *a, uint32_t *b, uint32_t count)
{
    if (sieve->prunes) {
        return kind == PCCD_VF ? SIFT_NEAR(PCCD_VF, true) : SIFT_NEAR(PCCD_EE, true);
    }
    return kind == PCCD_VF   ? SIFT_NEAR(PCCD_VF, false)
           : kind == PCCD_EE ? SIFT_NEAR(PCCD_EE, false)
                             : SIFT_NEAR(PCCD_EF, false);
}

/* sift_near.c - what is certainly not near at an end of the step.
 *
 * Source: BOUNDS.md, "The sieve: what is near".
 */
#include "marks_end.h"
#include "sift.h"
#include "table.h"

/* Of whole numbers below 2^31, so that squares of products of three fit a float. */
#define SMALLER 0x1p-16f

ENG_INLINE struct vector smaller(struct eng_g g)
{
    return (struct vector){rounded(g.x) * SMALLER, rounded(g.y) * SMALLER,
                           rounded(g.z) * SMALLER};
}

ENG_INLINE struct eng_g less(struct eng_g a, struct eng_g b)
{
    return (struct eng_g){a.x - b.x, a.y - b.y, a.z - b.z};
}

/* More than the largest coordinate, on the grid and off it. */
ENG_INLINE eng_f size_of(struct vector a)
{
    return eng_f_max_abs(eng_f_max_abs(a.x, a.y), a.z) + 2 * SMALLER;
}

/* What is across two differences of these sizes. */
struct normal {
    struct vector n;
    eng_f size_u, size_v;
};

ENG_INLINE struct normal normal_of(struct vector u, struct vector v)
{
    return (struct normal){cross(u, v), size_of(u), size_of(v)};
}

/* More than the error of w . n. */
ENG_INLINE eng_f height_error(struct vector w, const struct normal *normal)
{
    eng_f a = size_of(w);
    eng_f b = normal->size_u;
    eng_f c = normal->size_v;
    return 64 * U24 * (a * b * c) + 7 * SMALLER * (a * b + (a + b) * c);
}

/* More than the square of the length of the true one. */
ENG_INLINE eng_f square_most(const struct normal *normal)
{
    const struct vector n = normal->n;
    eng_f b = normal->size_u;
    eng_f c = normal->size_v;
    eng_f error = 10 * U24 * (b * c) + 3 * SMALLER * (b + c);
    eng_f size = eng_f_max_abs(eng_f_max_abs(n.x, n.y), n.z);
    return dot(n, n) + error * (6 * size + 3 * error);
}

/* Are the boxes around the features certainly farther apart than the root of `square`? */
ENG_INLINE eng_fm boxes_beyond(enum pccd_kind kind, const struct eng_g d[3], eng_f square)
{
    const eng_fi zero = {0};
    eng_f sum = rounded(zero);
#pragma GCC unroll 3
    for (int axis = 0; axis < 3; axis++) {
        eng_fi x[3];
        eng_fi gaps[2];
#pragma GCC unroll 3
        for (int k = 0; k < 3; k++) {
            x[k] = coordinate(d[k], axis);
        }
        gaps_of(kind, x, gaps);
        eng_f gap = rounded(eng_fi_max(eng_fi_max(gaps[0], gaps[1]) - 2, zero)) * SMALLER;
        sum += gap * gap;
    }
    return eng_f_less(square, sum);
}

/* Are the planes through the features, across both? */
ENG_INLINE eng_fm planes_beyond(enum pccd_kind kind, const struct eng_g d[3],
                                eng_f square)
{
    const eng_f zero = {0};
    bool is_vf = kind == PCCD_VF;
    struct vector u = smaller(is_vf ? less(d[1], d[0]) : d[0]);
    struct vector v = smaller(is_vf ? less(d[2], d[0]) : less(d[2], d[1]));
    struct vector w = smaller(is_vf ? d[0] : d[1]);
    struct normal normal = normal_of(u, v);
    eng_f height = eng_f_max_abs(dot(w, normal.n), zero) - height_error(w, &normal);
    return eng_fm_and(eng_f_less(zero, height),
                      eng_f_less(square * square_most(&normal), height * height));
}

/* A way from the second feature to the first. */
struct way {
    struct vector v;
    eng_f square;
};

/* From the foot on an edge e to a point that is `from` its begin; or what was shorter
 * before. `turned`: the edge is the first feature's. */
ENG_INLINE void shorten(struct way *way, struct vector from, struct vector e,
                        eng_f per_square, bool turned)
{
    const eng_f zero = {0};
    eng_f at = eng_f_min(eng_f_max(dot(from, e) * per_square, zero), zero + 1);
    struct vector foot = {at * e.x, at * e.y, at * e.z};
    struct vector v = turned ? minus(foot, from) : minus(from, foot);
    eng_f square = dot(v, v);
    eng_fm is_shorter = eng_f_less(square, way->square);
    way->v.x = eng_f_select(is_shorter, v.x, way->v.x);
    way->v.y = eng_f_select(is_shorter, v.y, way->v.y);
    way->v.z = eng_f_select(is_shorter, v.z, way->v.z);
    way->square = eng_f_select(is_shorter, square, way->square);
}

/* About the shortest one from a corner of either to the rim of the other. */
ENG_INLINE struct vector way_of(enum pccd_kind kind, const struct vector p[3])
{
    const eng_f zero = {0};
    const struct vector none = {zero, zero, zero};
    struct way way = {p[0], zero + 0x1p100f};
    if (kind == PCCD_VF) {
#pragma GCC unroll 3
        for (int i = 0; i < 3; i++) {
            struct vector side = minus(p[(i + 1) % 3], p[i]);
            shorten(&way, minus(none, p[i]), side, 1 / dot(side, side), false);
        }
        return way.v;
    }
    struct vector second = minus(p[2], p[1]);
    eng_f per_first = 1 / dot(p[0], p[0]);
    eng_f per_second = 1 / dot(second, second);
    shorten(&way, minus(none, p[1]), second, per_second, false);
    shorten(&way, minus(p[0], p[1]), second, per_second, false);
    shorten(&way, p[1], p[0], per_first, true);
    shorten(&way, p[2], p[0], per_first, true);
    return way.v;
}

/* Are they along such a way? */
ENG_INLINE eng_fm rims_beyond(enum pccd_kind kind, const struct eng_g d[3], eng_f square)
{
    const eng_f zero = {0};
    struct vector p[3];
#pragma GCC unroll 3
    for (int k = 0; k < 3; k++) {
        p[k] = smaller(d[k]);
    }
    struct vector way = way_of(kind, p);
    eng_f along = dot(way, p[0]);
    eng_f gap = zero - eng_f_max(dot(way, p[1]), dot(way, p[2]));
    if (kind == PCCD_VF) {
        gap = eng_f_min(gap, zero - along);
    } else {
        gap += eng_f_min(along, zero);
    }
    eng_f size =
        eng_f_max_abs(eng_f_max_abs(size_of(p[0]), size_of(p[1])), size_of(p[2]));
    gap -= size_of(way) * (8 * SMALLER + 32 * U24 * size);
    return eng_fm_and(eng_f_less(zero, gap),
                      eng_f_less(square * dot(way, way), gap * gap));
}

/* In cells: nothing that is multiplied by it falls below the range of floats. */
ENG_INLINE eng_f scaled(eng_f reach)
{
    return eng_f_max(reach * SMALLER, eng_f_all(0x1p-40f));
}

/* By boxes and planes most pairs go that are too far apart; ways take twice as long. */
enum look { LOOK_QUICK, LOOK_AT_RIMS, LOOK_ASIDE };

/* Certainly farther apart than `reach`, or, if it `narrows`, than is known? */
ENG_INLINE uint32_t beyond(enum pccd_kind kind, enum look look, bool narrows,
                           const struct eng_sieve *sieve, const uint32_t *a,
                           const uint32_t *b, uint32_t end, eng_f reach)
{
    struct eng_g d[3];
    eng_fi less;
    eng_marks_load_at(kind, sieve, a, b, end, d, narrows ? &less : NULL);
    if (narrows) {
        reach = (eng_f)((eng_fi)reach - less);
    }
    reach = scaled(reach);
    eng_f square = reach * reach * SLACK;
    return eng_fm_bits(look == LOOK_AT_RIMS ? rims_beyond(kind, d, square)
                                            : eng_fm_or(boxes_beyond(kind, d, square),
                                                        planes_beyond(kind, d, square)));
}

/* Are both ends of the edge certainly on one side of the plane through the face? */
ENG_INLINE uint32_t aside(const struct eng_sieve *sieve, const uint32_t *a,
                          const uint32_t *b, uint32_t end)
{
    struct eng_g d[4]; /* from a corner to the ends of the edge, and to the others */
    eng_marks_load_at(PCCD_EF, sieve, a, b, end, d, NULL);
    struct vector first = smaller(d[0]);
    struct vector second = smaller(d[1]);
    struct normal normal = normal_of(smaller(d[2]), smaller(d[3]));
    eng_f height[2] = {dot(first, normal.n), dot(second, normal.n)};
    eng_f error[2] = {height_error(first, &normal), height_error(second, &normal)};
    eng_fm above =
        eng_fm_and(eng_f_less(error[0], height[0]), eng_f_less(error[1], height[1]));
    eng_fm below =
        eng_fm_and(eng_f_less(height[0], -error[0]), eng_f_less(height[1], -error[1]));
    return eng_fm_bits(eng_fm_or(above, below));
}

ENG_INLINE uint32_t pass_near(uint32_t kind, enum look look, bool narrows,
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
            fill(a_in, b_in, n, full);
            a_in = full[0];
            b_in = full[1];
        }
        uint32_t out = look == LOOK_ASIDE
                           ? aside(sieve, a_in, b_in, end)
                           : beyond((enum pccd_kind)kind, look, narrows, sieve, a_in,
                                    b_in, end, eng_f_all(reach));
        kept += eng_keep_both(a + kept, b + kept, a + i, b + i,
                              ~out & ENG_F_ALL >> (ENG_F_LANES - n));
    }
    return kept;
}

ENG_INLINE uint32_t sift_near(uint32_t kind, bool narrows, const struct eng_sieve *sieve,
                              uint32_t end, float reach, uint32_t *a, uint32_t *b,
                              uint32_t count)
{
    if (kind == PCCD_EF) {
        return pass_near(kind, LOOK_ASIDE, false, sieve, end, reach, a, b, count);
    }
    count = pass_near(kind, LOOK_QUICK, narrows, sieve, end, reach, a, b, count);
    return pass_near(kind, LOOK_AT_RIMS, narrows, sieve, end, reach, a, b, count);
}

/* The end, and whether it narrows, as constants of the code. */
#define SIFT_NEAR(kind, narrows)                                                         \
    (end == 0 ? sift_near(kind, narrows, sieve, 0, reach, a, b, count)                   \
              : sift_near(kind, narrows, sieve, 1, reach, a, b, count))

uint32_t ENG_KERNEL(sift_near)(uint32_t kind, const struct eng_sieve *sieve, uint32_t end,
                               float reach, uint32_t *a, uint32_t *b, uint32_t count)
{
    if (sieve->narrows) {
        return kind == PCCD_VF ? SIFT_NEAR(PCCD_VF, true) : SIFT_NEAR(PCCD_EE, true);
    }
    return kind == PCCD_VF   ? SIFT_NEAR(PCCD_VF, false)
           : kind == PCCD_EE ? SIFT_NEAR(PCCD_EE, false)
                             : SIFT_NEAR(PCCD_EF, false);
}

/* thick_way.h - the way between the nearest points of two thick features, a pair to each
 * lane.
 *
 * Threads: [any]; inline only. Included by files of this folder alone.
 * Source: BOUNDS.md, "Thick features by doubles".
 */
#ifndef ENG_THICK_WAY_H
#define ENG_THICK_WAY_H

#include "thick_motion.h"

struct eng_thick_way {
    eng_d beta, gamma; /* in the domain of the kind */
    struct eng_v gap;  /* about from the nearest point of b to that of a */
};

/* Of the square of the sine between b and c: below the one, what rounding leaves of their
 * cross product may point anywhere; below the other, nobody asks. */
#define ENG_THICK_SURE_SINE2 0x1p-60
#define ENG_THICK_SINE2      0x1p-100

/* The foot of p on the plane of b and c, where it falls into the domain. `is_sure`: there
 * is no nearer place. */
ENG_INLINE eng_dm eng_thick_foot(enum pccd_kind form, const struct eng_thick_pose *pose,
                                 struct eng_thick_way *way, eng_dm *is_sure)
{
    const eng_d zero = {0};
    struct eng_v n = eng_v_cross(pose->b, pose->c);
    eng_d nn = eng_v_dot(n, n);
    eng_d size = eng_v_dot(pose->b, pose->b) * eng_v_dot(pose->c, pose->c);
    way->beta = eng_v_dot(eng_v_cross(pose->p, pose->c), n) / nn;
    way->gamma = eng_v_dot(eng_v_cross(pose->b, pose->p), n) / nn;
    eng_d most = eng_d_max(way->beta, way->gamma);
    if (form == PCCD_VF) {
        most = way->beta + way->gamma;
    }
    eng_dm inside = eng_dm_and(
        eng_d_less(ENG_THICK_SINE2 * size, nn),
        eng_dm_and(eng_d_at_most(zero, way->beta), eng_d_at_most(zero, way->gamma)));
    inside = eng_dm_and(inside, eng_d_at_most(most, zero + 1));
    *is_sure = eng_dm_and(inside, eng_d_less(ENG_THICK_SURE_SINE2 * size, nn));
    way->gap = eng_v_sub(eng_v_sub(pose->p, eng_v_times(way->beta, pose->b)),
                         eng_v_times(way->gamma, pose->c));
    return inside;
}

/* A side of the domain: start + s along, 0 <= s <= 1; from where, and which params move,
 * by s or by -s. */
struct eng_thick_side {
    struct eng_v start, along;
    double from[2];
    double moves[2];
};

ENG_INLINE void eng_thick_try_side(const struct eng_thick_side *side, eng_d *best,
                                   struct eng_thick_way *way)
{
    const eng_d zero = {0};
    eng_d aa = eng_v_dot(side->along, side->along);
    eng_d s = eng_v_dot(side->start, side->along) / aa;
    s = eng_d_select(eng_dm_and(eng_d_less(zero, aa), eng_d_less(zero, s)), s, zero);
    s = eng_d_min(s, zero + 1);
    struct eng_v gap = eng_v_sub(side->start, eng_v_times(s, side->along));
    eng_d square = eng_v_dot(gap, gap);
    eng_dm is_better = eng_d_less(square, *best);
    *best = eng_d_select(is_better, square, *best);
    way->beta = eng_d_select(is_better, side->from[0] + s * side->moves[0], way->beta);
    way->gamma = eng_d_select(is_better, side->from[1] + s * side->moves[1], way->gamma);
    way->gap = eng_v_select(is_better, gap, way->gap);
}

/* What a lane gets does not depend on the others. */
ENG_INLINE struct eng_thick_way
eng_thick_way_at(enum pccd_kind form, const struct eng_thick_motion *motion, eng_d t)
{
    const eng_d zero = {0};
    struct eng_thick_pose pose = eng_thick_pose_at(motion, t);
    struct eng_thick_way way;
    eng_dm is_sure;
    eng_dm inside = eng_thick_foot(form, &pose, &way, &is_sure);
    if (eng_dm_bits(is_sure) != ENG_D_ALL) {
        struct eng_v next = eng_v_sub(pose.p, pose.b);
        struct eng_thick_side last =
            form == PCCD_VF ? (struct eng_thick_side){next,
                                                      eng_v_sub(pose.c, pose.b),
                                                      {1, 0},
                                                      {-1, 1}}
                            : (struct eng_thick_side){next, pose.c, {1, 0}, {0, 1}};
        eng_d best =
            eng_d_select(inside, eng_v_dot(way.gap, way.gap), zero + __builtin_inf());
        best = eng_d_select(is_sure, zero - 1, best);
        eng_thick_try_side(&(struct eng_thick_side){pose.p, pose.b, {0, 0}, {1, 0}},
                           &best, &way);
        eng_thick_try_side(&(struct eng_thick_side){pose.p, pose.c, {0, 0}, {0, 1}},
                           &best, &way);
        eng_thick_try_side(&last, &best, &way);
        if (form == PCCD_EE) {
            eng_thick_try_side(
                &(struct eng_thick_side){
                    eng_v_sub(pose.p, pose.c), pose.b, {0, 1}, {1, 0}},
                &best, &way);
        }
    }
    if (form == PCCD_EE) {
        way.gap = (struct eng_v){-way.gap.x, -way.gap.y, -way.gap.z};
    }
    return way;
}

#endif

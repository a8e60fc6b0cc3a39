/* thick_motion.h - how two thick features move, a pair to each lane.
 *
 * Threads: [any]; inline only. Included by files of this folder alone.
 * Source: BOUNDS.md, "Thick features by doubles".
 */
#ifndef ENG_THICK_MOTION_H
#define ENG_THICK_MOTION_H

#include "points.h"

/* From a point of feature b to one of a. */
#define ENG_THICK_DIFFERENCES 4

/* A distance beyond those of all points. */
#define ENG_THICK_FAR 16.0

struct eng_thick_pose {
    struct eng_v p, b, c; /* query.h */
};

struct eng_thick_motion {
    int count;
    struct eng_v w[2][ENG_THICK_DIFFERENCES]; /* at t = 0 and 1 */
    struct eng_thick_pose at[2];
    eng_d scale[2]; /* a length is multiplied by both */
};

/* VE and VV are VF whose corners coincide. */
ENG_INLINE enum pccd_kind eng_thick_form(uint32_t kind)
{
    return kind == PCCD_EE ? PCCD_EE : PCCD_VF;
}

ENG_INLINE void eng_thick_differences(enum pccd_kind form, const struct eng_group *group,
                                      struct eng_thick_motion *motion)
{
    const bool is_vf = form == PCCD_VF;
    struct eng_v x[4][2];
    motion->count = is_vf ? 3 : 4;
    eng_group_load(group, x);
#pragma GCC unroll 2
    for (int end = 0; end < 2; end++) {
        struct eng_thick_pose *pose = &motion->at[end];
#pragma GCC unroll 4
        for (int k = 0; k < motion->count; k++) {
            motion->w[end][k] =
                eng_v_sub(x[is_vf ? 0 : k / 2][end], x[is_vf ? 1 + k : 2 + k % 2][end]);
        }
        pose->p = eng_v_sub(x[is_vf ? 0 : 2][end], x[is_vf ? 1 : 0][end]);
        pose->b = eng_v_sub(x[is_vf ? 2 : 1][end], x[is_vf ? 1 : 0][end]);
        pose->c = eng_v_sub(x[is_vf ? 3 : 2][end], x[is_vf ? 1 : 3][end]);
    }
}

ENG_INLINE eng_d eng_thick_size(const struct eng_thick_motion *motion)
{
    eng_d size = {0};
#pragma GCC unroll 4
    for (int k = 0; k < motion->count; k++) {
        size = eng_d_max(size, eng_v_reach(motion->w[0][k], motion->w[1][k]));
    }
    return size;
}

ENG_INLINE void eng_thick_scale(struct eng_thick_motion *motion, eng_d factor)
{
#pragma GCC unroll 2
    for (int end = 0; end < 2; end++) {
        struct eng_thick_pose *pose = &motion->at[end];
#pragma GCC unroll 4
        for (int k = 0; k < motion->count; k++) {
            motion->w[end][k] = eng_v_times(factor, motion->w[end][k]);
        }
        pose->p = eng_v_times(factor, pose->p);
        pose->b = eng_v_times(factor, pose->b);
        pose->c = eng_v_times(factor, pose->c);
    }
}

/* 2^-e of a number in [2^(e - 1), 2^e) that is normal, and not above 2^1000; of less, a
 * power of two. */
ENG_INLINE eng_d eng_thick_inverse(eng_d size)
{
    const eng_di exponent = {0};
    eng_di bits = eng_di_of(size) & (exponent + INT64_C(0x7ff0000000000000));
    return eng_d_of((exponent + INT64_C(0x7fd0000000000000)) - bits);
}

/* Sizes below are first multiplied: then they and their inverse are normal. */
#define ENG_THICK_TINY  0x1p-900
#define ENG_THICK_RAISE 0x1p200

ENG_INLINE struct eng_thick_motion eng_thick_load(enum pccd_kind form,
                                                  const struct eng_group *group)
{
    struct eng_thick_motion motion;
    eng_thick_differences(form, group, &motion);
    eng_d size = eng_thick_size(&motion);
    eng_dm is_tiny = eng_d_less(size, eng_d_all(ENG_THICK_TINY));
    motion.scale[0] = eng_d_all(1);
    if (eng_dm_bits(is_tiny) != 0) {
        motion.scale[0] = eng_d_select(is_tiny, eng_d_all(ENG_THICK_RAISE), eng_d_all(1));
        eng_thick_scale(&motion, motion.scale[0]);
        size *= motion.scale[0];
    }
    motion.scale[1] = eng_thick_inverse(size);
    eng_thick_scale(&motion, motion.scale[1]);
    return motion;
}

ENG_INLINE struct eng_thick_pose eng_thick_pose_at(const struct eng_thick_motion *motion,
                                                   eng_d t)
{
    const struct eng_thick_pose *at = motion->at;
    eng_d s = 1 - t;
    return (struct eng_thick_pose){eng_v_mix(s, at[0].p, t, at[1].p),
                                   eng_v_mix(s, at[0].b, t, at[1].b),
                                   eng_v_mix(s, at[0].c, t, at[1].c)};
}

#endif

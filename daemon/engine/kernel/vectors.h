/* vectors.h - vectors of three coordinates, several at once, one in each lane.
 *
 * Of doubles, or of floats in files that define ENG_IN_FLOATS (lanes.h).
 *
 * Threads: [any]; inline only. Included by files of this folder alone.
 */
#ifndef ENG_VECTORS_H
#define ENG_VECTORS_H

#include "lanes.h"

struct eng_v {
    eng_n x, y, z;
};

ENG_INLINE struct eng_v eng_v_add(struct eng_v a, struct eng_v b)
{
    return (struct eng_v){a.x + b.x, a.y + b.y, a.z + b.z};
}

ENG_INLINE struct eng_v eng_v_sub(struct eng_v a, struct eng_v b)
{
    return (struct eng_v){a.x - b.x, a.y - b.y, a.z - b.z};
}

ENG_INLINE struct eng_v eng_v_cross(struct eng_v a, struct eng_v b)
{
    return (struct eng_v){a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z,
                          a.x * b.y - a.y * b.x};
}

ENG_INLINE eng_n eng_v_dot(struct eng_v a, struct eng_v b)
{
    return a.x * b.x + a.y * b.y + a.z * b.z;
}

/* s a + t b */
ENG_INLINE struct eng_v eng_v_mix(eng_n s, struct eng_v a, eng_n t, struct eng_v b)
{
    return (struct eng_v){s * a.x + t * b.x, s * a.y + t * b.y, s * a.z + t * b.z};
}

ENG_INLINE struct eng_v eng_v_abs(struct eng_v a)
{
    return (struct eng_v){eng_n_abs(a.x), eng_n_abs(a.y), eng_n_abs(a.z)};
}

/* a where the mask is set, else b. */
ENG_INLINE struct eng_v eng_v_select(eng_nm m, struct eng_v a, struct eng_v b)
{
    return (struct eng_v){eng_n_select(m, a.x, b.x), eng_n_select(m, a.y, b.y),
                          eng_n_select(m, a.z, b.z)};
}

/* s a */
ENG_INLINE struct eng_v eng_v_times(eng_n s, struct eng_v a)
{
    return (struct eng_v){s * a.x, s * a.y, s * a.z};
}

/* Largest coordinate magnitude. */
ENG_INLINE eng_n eng_v_size(struct eng_v a)
{
    return eng_n_max_abs(eng_n_max_abs(a.x, a.y), a.z);
}

/* Largest coordinate magnitude of two. */
ENG_INLINE eng_n eng_v_reach(struct eng_v a, struct eng_v b)
{
    eng_n x = eng_n_max_abs(a.x, b.x);
    eng_n y = eng_n_max_abs(a.y, b.y);
    eng_n z = eng_n_max_abs(a.z, b.z);
    return eng_n_max_abs(eng_n_max_abs(x, y), z);
}

#endif

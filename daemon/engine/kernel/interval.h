/* interval.h - intervals of the step in which a cubic has at most one root, and those
 * without a root, which are dropped.
 *
 * Name what is known of the pairs in the lanes; set up their cubics; find the cubics that
 * certainly have no root, and those that only fall, which have one.
 *
 * Threads: [any]; inline only. Included by files of this folder alone.
 * Source: BOUNDS.md.
 */
#ifndef ENG_INTERVAL_H
#define ENG_INTERVAL_H

#include "cubic.h"
#include "spot.h"

/* Sizes below this, where products might lose bits, are left to those who scale. */
#define SIZE_MIN 0x1p-200

/* Contacts in longer brackets are left to the search, which narrows them. */
#define WIDTH_MAX 0x1p-30

enum look { LOOK_FALLING, LOOK_ALL };

/* The pairs in the lanes and what is known of them. */
struct lanes {
    struct eng_motion_lanes motion;
    struct eng_cubic cubic; /* positive at l */
    struct eng_cubic_powers powers;
    /* The interval at hand: the cubic is certainly positive at l and negative at r. Looks
     * at what falls leave all but the roots out: it is [0, 1]. */
    eng_d l, r;
    eng_d f_l, f_r;
    eng_d root;
    eng_d slope;         /* near the root */
    eng_d low_l, high_r; /* the root is between them */
    eng_dm moving;       /* on the way to their root */
    /* Where the intervals end, and the cubic there. */
    eng_d cut[2];
    eng_d at_cut[2];
    eng_dm bends[2];       /* there is a second, a third interval */
    eng_dm flat_l, flat_r; /* the interval at hand begins, ends where the cubic turns */
    eng_dm starts_below;   /* the cubic was turned */
    const uint32_t *pairs;
    uint32_t count;  /* of pairs */
    uint32_t wanted; /* bits: with a root in the interval */
    uint32_t on_way; /* bits: of them, those that move */
    uint32_t done;   /* bits: decided */
};

/* What all pairs have in common. */
struct limits {
    eng_d width; /* of a bracket, at most */
    eng_d until; /* what begins later is not asked for */
    double t_end;
    bool is_early; /* until < 1 */
};

ENG_INLINE struct limits limits_of(double tolerance, double t_end)
{
    const double until = t_end + tolerance + 0x1p-48;
    return (struct limits){eng_d_all(tolerance < WIDTH_MAX ? tolerance : WIDTH_MAX),
                           eng_d_all(until), t_end, until < 1};
}

ENG_INLINE eng_dm all_above(eng_d a, eng_d b, eng_d c, eng_d d, eng_d e)
{
    return eng_d_less(e, eng_d_min(eng_d_min(a, b), eng_d_min(c, d)));
}

/* The lanes whose sign at t = 0 is certain. */
ENG_INLINE eng_dm is_certain(const struct lanes *lanes)
{
    const eng_d zero = {0};
    const eng_d *size = lanes->motion.size;
    eng_dm is_large =
        eng_d_at_most(zero + SIZE_MIN, eng_d_min(eng_d_min(size[0], size[1]), size[2]));
    return eng_dm_and(is_large, eng_d_less(lanes->cubic.error, lanes->cubic.f[0]));
}

/* The cubics of lanes->motion. Returns the lanes whose sign at t = 0 is certain. */
ENG_INLINE eng_dm open(enum look look, struct lanes *lanes)
{
    const eng_d zero = {0};
    const eng_d *size = lanes->motion.size;
    lanes->cubic = eng_cubic_of(lanes->motion.v, size[0] * size[1] * size[2]);
    if (look == LOOK_ALL) {
        eng_cubic_tighten(&lanes->cubic, lanes->motion.v);
    }
    lanes->starts_below = eng_d_less(lanes->cubic.f[0], zero);
    eng_cubic_turn(&lanes->cubic, lanes->starts_below);
    return is_certain(lanes);
}

/* Certainly no root in the first half of the step, nor in the second? */
ENG_INLINE eng_dm is_clear_by_halves(const struct eng_cubic *cubic)
{
    const eng_d *f = cubic->f;
    eng_d quad[3];
    eng_d line[2];
#pragma GCC unroll 3
    for (int i = 0; i < 3; i++) {
        quad[i] = 0.5 * (f[i] + f[i + 1]);
    }
    line[0] = 0.5 * (quad[0] + quad[1]);
    line[1] = 0.5 * (quad[1] + quad[2]);
    eng_d low = eng_d_min(eng_d_min(f[0], f[3]), eng_d_min(quad[0], quad[2]));
    low = eng_d_min(low, eng_d_min(line[0], line[1]));
    return eng_d_less(cubic->error, low);
}

/* The interval is the whole step, and its root is wanted where the cubic falls. */
ENG_INLINE void set_falling(struct lanes *lanes, eng_dm sure, const struct limits *limits)
{
    const eng_d *f = lanes->cubic.f;
    eng_d e = lanes->cubic.error;
    uint32_t all = (1u << lanes->count) - 1;
    eng_dm falls = eng_dm_and(sure, eng_d_less(f[3], -e));
    eng_dm misses = eng_dm_and(sure, is_clear_by_halves(&lanes->cubic));
    if (limits->is_early) {
        struct eng_cubic_at at = eng_cubic_at(&lanes->cubic, limits->until);
        eng_dm later = all_above(f[0], at.quad[0], at.line[0], at.value, e);
        misses = eng_dm_or(misses, eng_dm_and(sure, later));
    }
    lanes->done = eng_dm_bits(misses) & all;
    lanes->wanted = eng_dm_bits(falls) & all & ~lanes->done;
}

#endif

/* enclose.h - finds the time of a contact: encloses a root of a cubic between two times,
 * and describes the contact there.
 *
 * Threads: [any]; inline only. Included by files of this folder alone.
 * Source: BOUNDS.md.
 */
#ifndef ENG_ENCLOSE_H
#define ENG_ENCLOSE_H

#include "interval.h"

/* Longer brackets say nothing about misses. */
#define WIDTH_MISS_MAX 0x1p-10

/* Rounds of Halley's method. From the guess two or three are enough for nearly all that
 * fall; the others are not in general position, or many roots are near. */
#define ROUNDS_FALLING 3
#define ROUNDS_ALL     12

/* A step of Halley's method that is this short has led to the root up to rounding. */
#define STEP_FALLING 0x1p-17
#define STEP_ALL     0x1p-24

/* First guesses of all roots. */
ENG_INLINE void guess(enum look look, struct lanes *lanes)
{
    const eng_d zero = {0};
    lanes->powers = eng_cubic_powers(&lanes->cubic);
    if (look == LOOK_FALLING) {
        lanes->root = eng_cubic_guess(&lanes->cubic);
    } else {
        /* A parabola from its vertex where the cubic turns at an end, else a line. */
        eng_d width = lanes->r - lanes->l;
        eng_d share = lanes->f_l / (lanes->f_l - lanes->f_r);
        eng_d root = eng_d_sqrt(eng_d_select(lanes->flat_r, 1 - share, share));
        share = eng_d_select(lanes->flat_l, root, share);
        share = eng_d_select(lanes->flat_r, 1 - root, share);
        lanes->root = lanes->l + width * share;
        lanes->low_l = lanes->l;
        lanes->high_r = lanes->r;
    }
    lanes->moving = eng_d_less(zero, zero + 1);
    lanes->slope = zero - 1;
}

/* One lane waits for nobody else: a branch that goes the usual way takes no time, where
 * what it leaves out would stand in the chain from root to root. */
ENG_INLINE bool is_all(eng_dm m)
{
    return ENG_D_LANES == 1 && __builtin_expect(eng_dm_bits(m) != 0, 1);
}

ENG_INLINE eng_d clamped(eng_d x, eng_d low, eng_d high)
{
    if (is_all(eng_dm_and(eng_d_less(low, x), eng_d_less(x, high)))) {
        return x;
    }
    return eng_d_min(eng_d_max(x, low), high);
}

/* One step nearer to all roots. Which lanes still move decides nothing about others. */
ENG_INLINE void move(enum look look, struct lanes *lanes)
{
    const eng_d zero = {0};
    const eng_d one = zero + 1;
    eng_d s = lanes->root;
    struct eng_cubic_step step = eng_cubic_halley(&lanes->powers, s);
    eng_d next = s + step.step;
    eng_d limit = zero + (look == LOOK_FALLING ? STEP_FALLING : STEP_ALL);
    eng_dm is_small = eng_d_at_most(eng_d_abs(step.step), limit);
    if (look == LOOK_FALLING) {
        next = clamped(next, zero, one);
    } else {
        eng_dm before = eng_d_less(zero, step.value);
        eng_d low = eng_d_select(before, s, lanes->low_l);
        eng_d high = eng_d_select(before, lanes->high_r, s);
        eng_dm good = eng_dm_and(eng_d_less(low, next), eng_d_less(next, high));
        if (!is_all(good)) {
            next = eng_d_select(eng_dm_or(is_small, good), next, 0.5 * (low + high));
        }
        lanes->low_l = low;
        lanes->high_r = high;
    }
    if (ENG_D_LANES == 1) {
        lanes->slope = step.slope; /* who stands still is not asked to move */
        lanes->root = next;
        lanes->moving = eng_dm_not(is_small);
    } else {
        lanes->slope = eng_d_select(lanes->moving, step.slope, lanes->slope);
        lanes->root = eng_d_select(lanes->moving, next, s);
        lanes->moving = eng_dm_and(lanes->moving, eng_dm_not(is_small));
    }
    lanes->on_way = eng_dm_bits(lanes->moving) & lanes->wanted;
}

/* Is the cubic certainly positive before the bracket, from l on, and negative behind it,
 * up to r, which of course holds at x and y too? */
ENG_INLINE eng_dm encloses(enum look look, const struct lanes *lanes, eng_d x, eng_d y)
{
    const eng_d *f = lanes->cubic.f;
    eng_d e = lanes->cubic.error;
    struct eng_cubic_at at_x = eng_cubic_at(&lanes->cubic, x);
    struct eng_cubic_at at_y = eng_cubic_at(&lanes->cubic, y);
    if (look == LOOK_FALLING) {
        eng_dm before = all_above(f[0], at_x.quad[0], at_x.line[0], at_x.value, e);
        eng_dm behind = all_above(-f[3], -at_y.quad[2], -at_y.line[1], -at_y.value, e);
        return eng_dm_and(before, behind);
    }
    eng_d before[2];
    eng_d behind[2];
    eng_cubic_between(&at_x, lanes->l, before);
    eng_cubic_between(&at_y, lanes->r, behind);
    return eng_dm_and(all_above(lanes->f_l, before[0], before[1], at_x.value, e),
                      all_above(-lanes->f_r, -behind[0], -behind[1], -at_y.value, e));
}

/* Brackets around the roots, and what is there. */
struct bracket {
    eng_d x, y;
    struct eng_spot spot;
    eng_dm meets;  /* certainly, and it is as short as asked */
    eng_dm passed; /* certainly nothing meets there */
};

/* Enclose the roots. */
ENG_INLINE struct bracket enclose(enum pccd_kind kind, enum look look,
                                  const struct lanes *lanes, const struct limits *limits)
{
    const eng_d zero = {0};
    struct bracket at;
    eng_d l = look == LOOK_FALLING ? zero : lanes->l;
    eng_d r = look == LOOK_FALLING ? (eng_d)(zero + 1) : lanes->r;
    /* The cubic is beyond its error at a distance of error / slope, and a half more for
     * what rounding does to root, slope and the cubic there. */
    eng_d reach = 1.5 * lanes->cubic.error / eng_d_abs(lanes->slope) + 0x1p-51;
    at.x = eng_d_max(l, lanes->root - reach);
    at.y = eng_d_min(r, lanes->root + reach);
    eng_d width = at.y - at.x;
    eng_dm enclosed = encloses(look, lanes, at.x, at.y);
    eng_dm is_quantised = eng_d_at_most(width, limits->width);
    eng_dm is_short = eng_d_at_most(width, zero + WIDTH_MISS_MAX);
    at.spot = eng_spot_of(kind, &lanes->motion, at.x, at.y, look == LOOK_ALL);
    at.meets = eng_dm_and(eng_dm_and(enclosed, is_quantised), at.spot.inside);
    at.passed = eng_dm_and(eng_dm_and(enclosed, is_short), at.spot.outside);
    return at;
}

/* What a hit says of a contact: params and normal. */
ENG_INLINE void describe(enum pccd_kind kind, const struct lanes *lanes,
                         const struct eng_spot *spot, eng_d numbers[5])
{
    const eng_d one = (eng_d){0} + 1;
    eng_d scale = 1 / spot->nn;
    eng_d beta = spot->param[0] * scale;
    eng_d gamma = spot->param[1] * scale;
    numbers[0] = kind == PCCD_EE ? eng_d_min(beta, one) : beta;
    numbers[1] = kind == PCCD_EE ? eng_d_min(gamma, one) : gamma;
    /* VF: from the face to the side of the vertex; EE: from b to a. */
    eng_d unit = eng_d_sqrt(scale);
    unit = kind == PCCD_VF ? eng_d_select(lanes->starts_below, -unit, unit)
                           : eng_d_select(lanes->starts_below, unit, -unit);
    numbers[2] = spot->n.x * unit;
    numbers[3] = spot->n.y * unit;
    numbers[4] = spot->n.z * unit;
}

#endif

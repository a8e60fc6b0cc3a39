/* daemon/engine/kernel/bracket.c - the certified solver, a pair to each lane.
 *
 * Room:     engine.
 * Does:     find the roots of the coplanarity cubic, enclose each between two times at
 *           which its sign is certain, and say whether the features certainly meet or
 *           certainly miss there. What is not certain is left to solve.c.
 * Threads:  [any].
 * Source:   query.h; every constant times u is derived in BOUNDS.md.
 *
 * With the cubic turned so that it is positive at t = 0, three shapes are decided here:
 *
 *   it falls to below zero at t = 1: one root, in [0, 1];
 *   it is positive at t = 1 too, and negative at its minimum m: two roots, in [0, m] and
 *     [m, 1];
 *   it falls to below zero at t = 1, but is negative at its minimum m and positive at its
 *     maximum M, m < M: three roots, in [0, m], [m, M] and [M, 1].
 *
 * In all of them the coefficients over what lies before and behind the brackets have to
 * be certain: so the brackets hold all the roots, whatever else the cubic might do.
 *
 * A pair is looked at once for the first shape, which most have, and the few that are not
 * decided once more for all three, with a smaller error and more patience. Each time a
 * few groups of pairs go through one stage after the other: to its root a cubic takes a
 * chain of divisions, and so those of many are under way at a time.
 */
#include "cubic.h"
#include "spot.h"
#include "table.h"

/* Sizes below this, where products might lose bits, are left to those who scale. */
#define SIZE_MIN 0x1p-200

/* Contacts in longer brackets are left to the search, which narrows them. */
#define WIDTH_MAX 0x1p-30

/* Longer brackets say nothing about misses. */
#define WIDTH_MISS_MAX 0x1p-10

/* Pairs that go through the stages together: what is known of them stays in the first
 * cache. */
#define PAIRS  64u
#define GROUPS (PAIRS / ENG_D_LANES)

enum look { LOOK_FALLING, LOOK_ALL };

/* Rounds of Halley's method. From the guess two or three are enough for nearly all that
 * fall; the others are not in general position, or many roots are near. */
#define ROUNDS_FALLING 3
#define ROUNDS_ALL     12

/* A step of Halley's method that is this short has led to the root up to rounding. */
#define STEP_FALLING 0x1p-17
#define STEP_ALL     0x1p-24

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

ENG_INLINE eng_dm all_above(eng_d a, eng_d b, eng_d c, eng_d d, eng_d e)
{
    return eng_d_less(e, eng_d_min(eng_d_min(a, b), eng_d_min(c, d)));
}

/* Load pairs and their cubics. Returns the lanes whose sign at t = 0 is certain. */
ENG_INLINE eng_dm open(enum eng_kind kind, enum look look, const struct eng_group *group,
                       struct lanes *lanes)
{
    const eng_d zero = {0};
    lanes->motion = eng_motion_load(kind, group);
    const eng_d *size = lanes->motion.size;
    lanes->cubic = eng_cubic_of(lanes->motion.v, size[0] * size[1] * size[2]);
    if (look == LOOK_ALL) {
        eng_cubic_tighten(&lanes->cubic, lanes->motion.v);
    }
    lanes->starts_below = eng_d_less(lanes->cubic.f[0], zero);
    eng_cubic_turn(&lanes->cubic, lanes->starts_below);
    eng_dm is_large =
        eng_d_at_most(zero + SIZE_MIN, eng_d_min(eng_d_min(size[0], size[1]), size[2]));
    return eng_dm_and(is_large, eng_d_less(lanes->cubic.error, lanes->cubic.f[0]));
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

/* Where a cubic turns, and what it is there. */
struct turn {
    eng_d t;
    struct eng_cubic_at at;
};

/* Is the cubic certainly positive over all of [0, t], or [t, 1]? */
ENG_INLINE eng_dm is_clear_before(const struct eng_cubic *cubic, const struct turn *turn)
{
    const struct eng_cubic_at *at = &turn->at;
    return all_above(cubic->f[0], at->quad[0], at->line[0], at->value, cubic->error);
}

ENG_INLINE eng_dm is_clear_behind(const struct eng_cubic *cubic, const struct turn *turn)
{
    const struct eng_cubic_at *at = &turn->at;
    return all_above(cubic->f[3], at->quad[2], at->line[1], at->value, cubic->error);
}

/* Certainly negative over all of [t, 1]? */
ENG_INLINE eng_dm is_below_behind(const struct eng_cubic *cubic, const struct turn *turn)
{
    const struct eng_cubic_at *at = &turn->at;
    return all_above(-cubic->f[3], -at->quad[2], -at->line[1], -at->value, cubic->error);
}

/* Cut the step where the cubic turns; the first interval begins at 0 or, if there is no
 * root before, at the maximum; it ends at the minimum if there are more roots than one,
 * or none behind. */
ENG_INLINE void set_pieces(struct lanes *lanes, eng_dm sure)
{
    const eng_d zero = {0};
    const eng_d one = zero + 1;
    const struct eng_cubic *cubic = &lanes->cubic;
    const eng_d *f = cubic->f;
    eng_d e = cubic->error;
    uint32_t all = (1u << lanes->count) - 1;
    struct turn low;
    struct turn high;
    eng_cubic_turns(cubic, &low.t, &high.t);
    eng_dm has_low = eng_dm_and(eng_d_less(zero, low.t), eng_d_less(low.t, one));
    eng_dm has_both = eng_dm_and(
        has_low, eng_dm_and(eng_d_at_most(low.t, high.t), eng_d_less(high.t, one)));
    low.t = eng_d_select(has_low, low.t, zero + 0.5);
    high.t = eng_d_select(has_both, high.t, one);
    low.at = eng_cubic_at(cubic, low.t);
    high.at = eng_cubic_at(cubic, high.t);
    eng_d between[2];
    eng_cubic_between(&low.at, high.t, between);
    eng_dm falls = eng_dm_and(sure, eng_d_less(f[3], -e));
    eng_dm returns = eng_dm_and(sure, eng_d_less(e, f[3]));
    eng_dm before = is_clear_before(cubic, &low);
    eng_dm misses = eng_dm_and(returns, eng_dm_and(before, is_clear_behind(cubic, &low)));
    eng_dm dips = eng_d_less(low.at.value, -e);
    eng_dm rises = eng_dm_and(has_both, eng_d_less(e, high.at.value));
    eng_dm falls_late = eng_dm_and(eng_dm_and(falls, rises), before);
    falls_late = eng_dm_and(falls_late, eng_d_less(e, eng_d_min(between[0], between[1])));
    eng_dm falls_early = eng_dm_and(eng_dm_and(falls, dips), has_both);
    falls_early = eng_dm_and(falls_early, is_below_behind(cubic, &high));
    falls_early =
        eng_dm_and(falls_early, eng_d_less(eng_d_max(between[0], between[1]), -e));
    eng_dm twice = eng_dm_and(returns, dips);
    eng_dm thrice = eng_dm_and(eng_dm_and(falls, rises), dips);
    eng_dm ends_low = eng_dm_or(eng_dm_or(twice, thrice), falls_early);
    lanes->bends[0] = eng_dm_or(twice, thrice);
    lanes->bends[1] = thrice;
    lanes->l = eng_d_select(falls_late, high.t, zero);
    lanes->f_l = eng_d_select(falls_late, high.at.value, f[0]);
    lanes->r = eng_d_select(ends_low, low.t, one);
    lanes->f_r = eng_d_select(ends_low, low.at.value, f[3]);
    lanes->cut[0] = low.t;
    lanes->at_cut[0] = low.at.value;
    lanes->cut[1] = eng_d_select(thrice, high.t, one);
    lanes->at_cut[1] = eng_d_select(thrice, high.at.value, f[3]);
    lanes->flat_l = falls_late;
    lanes->flat_r = ends_low;
    lanes->done = eng_dm_bits(misses) & all;
    lanes->wanted = eng_dm_bits(eng_dm_or(twice, falls)) & all;
}

/* On to the next interval; the cubic is turned so that it is positive at its begin. */
ENG_INLINE void set_next(struct lanes *lanes, int piece)
{
    const eng_d zero = {0};
    eng_d sign = piece == 1 ? zero - 1 : zero + 1;
    lanes->l = lanes->cut[piece - 1];
    lanes->f_l = sign * lanes->at_cut[piece - 1];
    lanes->r = piece == 1 ? lanes->cut[1] : (eng_d)(zero + 1);
#pragma GCC unroll 4
    for (int i = 0; i < 4; i++) {
        lanes->cubic.f[i] = -lanes->cubic.f[i];
    }
    lanes->flat_l = piece == 1 ? eng_dm_not(lanes->bends[1]) : lanes->bends[1];
    lanes->flat_r = eng_dm_and(lanes->flat_l, eng_dm_not(lanes->flat_l)); /* none */
    lanes->f_r = piece == 1 ? (eng_d)(sign * lanes->at_cut[1]) : lanes->cubic.f[3];
}

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
        next = eng_d_min(eng_d_max(next, zero), one);
    } else {
        eng_dm before = eng_d_less(zero, step.value);
        eng_d low = eng_d_select(before, s, lanes->low_l);
        eng_d high = eng_d_select(before, lanes->high_r, s);
        eng_dm good = eng_dm_and(eng_d_less(low, next), eng_d_less(next, high));
        next = eng_d_select(eng_dm_or(is_small, good), next, 0.5 * (low + high));
        lanes->low_l = low;
        lanes->high_r = high;
    }
    lanes->slope = eng_d_select(lanes->moving, step.slope, lanes->slope);
    lanes->root = eng_d_select(lanes->moving, next, s);
    lanes->moving = eng_dm_and(lanes->moving, eng_dm_not(is_small));
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

/* Append the contacts of the lanes `bits` that begin in time. */
ENG_INLINE void write_hits(enum eng_kind kind, const struct lanes *lanes, uint32_t bits,
                           eng_d x, eng_d y, const struct eng_spot *spot, double t_end,
                           struct eng_bracketed *out)
{
    const eng_d one = (eng_d){0} + 1;
    double at[2][ENG_D_LANES];
    float as[5][ENG_D_LANES];
    eng_d scale = 1 / spot->nn;
    eng_d beta = spot->param[0] * scale;
    eng_d gamma = spot->param[1] * scale;
    if (kind == ENG_EE) {
        beta = eng_d_min(beta, one);
        gamma = eng_d_min(gamma, one);
    }
    /* VF: from the face to the side of the vertex; EE: from b to a. */
    eng_d unit = eng_d_sqrt(scale);
    unit = kind == ENG_VF ? eng_d_select(lanes->starts_below, -unit, unit)
                          : eng_d_select(lanes->starts_below, unit, -unit);
    const eng_d numbers[5] = {beta, gamma, spot->n.x * unit, spot->n.y * unit,
                              spot->n.z * unit};
    eng_d_store(at[0], x);
    eng_d_store(at[1], y);
#pragma GCC unroll 5
    for (int i = 0; i < 5; i++) {
        eng_d_narrow(as[i], numbers[i]);
    }
    uint32_t count = out->hit_count;
    for (; bits != 0; bits &= bits - 1) {
        uint32_t lane = (uint32_t)__builtin_ctz(bits);
        struct eng_hit *hit = &out->hits[count];
        hit->flags = ENG_PROVED;
        hit->toi = at[0][lane];
        hit->toi_hi = at[1][lane];
        hit->param[0] = as[0][lane];
        hit->param[1] = as[1][lane];
        hit->normal[0] = as[2][lane];
        hit->normal[1] = as[3][lane];
        hit->normal[2] = as[4][lane];
        out->index[count] = lanes->pairs[lane];
        count += hit->toi <= t_end;
    }
    out->hit_count = count;
}

/* Enclose the roots and write down what meets there. What certainly misses there, and
 * not more, is returned. */
ENG_INLINE eng_dm close(enum eng_kind kind, enum look look, struct lanes *lanes,
                        const struct limits *limits, struct eng_bracketed *out)
{
    const eng_d zero = {0};
    eng_d l = look == LOOK_FALLING ? zero : lanes->l;
    eng_d r = look == LOOK_FALLING ? (eng_d)(zero + 1) : lanes->r;
    /* The cubic is beyond its error at a distance of error / slope, and a half more for
     * what rounding does to root, slope and the cubic there. */
    eng_d reach = 1.5 * lanes->cubic.error / eng_d_abs(lanes->slope) + 0x1p-51;
    eng_d x = eng_d_max(l, lanes->root - reach);
    eng_d y = eng_d_min(r, lanes->root + reach);
    eng_d width = y - x;
    eng_dm enclosed = encloses(look, lanes, x, y);
    eng_dm is_narrow = eng_d_at_most(width, limits->width);
    eng_dm is_short = eng_d_at_most(width, zero + WIDTH_MISS_MAX);
    struct eng_spot spot = eng_spot_of(kind, &lanes->motion, x, y, look == LOOK_ALL);
    eng_dm meets = eng_dm_and(eng_dm_and(enclosed, is_narrow), spot.inside);
    uint32_t hit = eng_dm_bits(meets) & lanes->wanted;
    if (hit != 0) {
        write_hits(kind, lanes, hit, x, y, &spot, limits->t_end, out);
        lanes->done |= hit;
    }
    return eng_dm_and(eng_dm_and(enclosed, is_short), spot.outside);
}

ENG_INLINE void find_roots(enum look look, struct lanes lanes[GROUPS], uint32_t count)
{
    const int rounds = look == LOOK_FALLING ? ROUNDS_FALLING : ROUNDS_ALL;
    for (uint32_t g = 0; g < count; g++) {
        lanes[g].on_way = lanes[g].wanted;
        if (lanes[g].on_way != 0) {
            guess(look, &lanes[g]);
        }
    }
    uint32_t moving = 1;
    for (int round = 0; round < rounds && moving != 0; round++) {
        moving = 0;
        for (uint32_t g = 0; g < count; g++) {
            if (lanes[g].on_way != 0) {
                move(look, &lanes[g]);
                moving |= lanes[g].on_way;
            }
        }
    }
}

/* One look at a few groups. */
ENG_INLINE void look_at(enum eng_kind kind, enum look look, struct lanes lanes[GROUPS],
                        uint32_t count, const struct limits *limits,
                        struct eng_bracketed *out)
{
    const int pieces = look == LOOK_FALLING ? 1 : 3;
    for (int piece = 0; piece < pieces; piece++) {
        find_roots(look, lanes, count);
        uint32_t again = 0;
        for (uint32_t g = 0; g < count; g++) {
            uint32_t next = 0;
            if (lanes[g].wanted != 0) {
                eng_dm passed = close(kind, look, &lanes[g], limits, out);
                uint32_t bits = eng_dm_bits(passed) & lanes[g].wanted;
                if (piece + 1 < pieces) {
                    next = bits & eng_dm_bits(lanes[g].bends[piece]);
                }
                lanes[g].done |= bits & ~next;
            }
            lanes[g].wanted = next;
            again |= next;
        }
        if (again == 0) {
            break;
        }
        for (uint32_t g = 0; g < count; g++) {
            if (lanes[g].wanted != 0) {
                set_next(&lanes[g], piece + 1);
            }
        }
    }
}

/* Look at pairs[count]. Those that are not decided go to `left`, which may be `pairs`;
 * returns how many. */
ENG_INLINE uint32_t look_at_all(enum eng_kind kind, enum look look,
                                const struct eng_point *points,
                                const uint32_t (*quads)[4], const uint32_t *pairs,
                                uint32_t count, const struct limits *limits,
                                struct eng_bracketed *out, uint32_t *left)
{
    struct lanes lanes[GROUPS];
    uint32_t left_count = 0;
    for (uint32_t i = 0; i < count; i += PAIRS) {
        uint32_t groups = 0;
        for (uint32_t k = i; k < count && k < i + PAIRS; k += ENG_D_LANES) {
            struct lanes *now = &lanes[groups++];
            now->pairs = pairs + k;
            now->count = count - k < ENG_D_LANES ? count - k : ENG_D_LANES;
            struct eng_group group = eng_group_of(points, quads, now->pairs, now->count);
            eng_dm sure = open(kind, look, &group, now);
            if (look == LOOK_FALLING) {
                set_falling(now, sure, limits);
            } else {
                set_pieces(now, sure);
            }
        }
        look_at(kind, look, lanes, groups, limits, out);
        for (uint32_t g = 0; g < groups; g++) {
            uint32_t n = lanes[g].count;
            left_count += eng_keep(left + left_count, lanes[g].pairs, n,
                                   ((1u << n) - 1) & ~lanes[g].done);
        }
    }
    return left_count;
}

ENG_INLINE void bracket(enum eng_kind kind, const struct eng_point *points,
                        const uint32_t (*quads)[4], uint32_t *pairs, uint32_t count,
                        double tolerance, double t_end, struct eng_bracketed *out)
{
    const double until = t_end + tolerance + 0x1p-48;
    const struct limits limits = {
        eng_d_all(tolerance < WIDTH_MAX ? tolerance : WIDTH_MAX), eng_d_all(until), t_end,
        until < 1};
    count =
        look_at_all(kind, LOOK_FALLING, points, quads, pairs, count, &limits, out, pairs);
    out->unsure_count += look_at_all(kind, LOOK_ALL, points, quads, pairs, count, &limits,
                                     out, out->unsure + out->unsure_count);
}

void ENG_KERNEL(bracket)(enum eng_kind kind, const struct eng_point *points,
                         const uint32_t (*quads)[4], uint32_t *pairs, uint32_t count,
                         double tolerance, double t_end, struct eng_bracketed *out)
{
    if (kind == ENG_VF) {
        bracket(ENG_VF, points, quads, pairs, count, tolerance, t_end, out);
    } else {
        bracket(ENG_EE, points, quads, pairs, count, tolerance, t_end, out);
    }
}

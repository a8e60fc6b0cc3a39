/* advance.c - thick features come within a distance of each other, a pair to each lane.
 *
 * See kernel.h. A turn looks at a pair from a time on, up to which its features are
 * certainly farther apart than r. First it guesses when the planes across both features
 * will be r apart, and proves that they are farther apart until shortly before. Then, at
 * the end of the cell of time where that is, it asks for the nearest points: within r,
 * they are the contact; else the direction between them keeps the features apart for some
 * more time. Most contacts take one turn, and most misses two; later turns ask for a
 * direction that turns to that of the time when they may meet. Between turns the pairs
 * that are left close ranks, so that few lanes are idle.
 *
 * Source: Mirtich 1996, and Li et al., Codimensional incremental potential contact, 2021,
 * for conservative advancement; BOUNDS.md, "Thick features by doubles".
 */
#include "lanes.h"
#include "nearest_points.h"
#include "points.h"
#include "table.h"

/* ---- cells of time --------------------------------------------------------------- */

/* The cells of time of thick contacts, a pair to each lane. */

/* Into which part of a cell of plain halves a cell begins. */
#define ENG_THICK_CELLS_OFFSET (1365 / 4096.0)

/* Numbers of cells are doubles: whole, from -1 to 2^40. */
struct eng_thick_cells {
    eng_d count; /* in the step, and its inverse: powers of two */
    eng_d length;
    eng_d last;
};

/* Where a cell begins that is not the first; exactly. */
ENG_INLINE eng_d eng_thick_border(const struct eng_thick_cells *cells, eng_d cell)
{
    return (cell + ENG_THICK_CELLS_OFFSET) * cells->length;
}

/* Return the cell of a time, 0 <= t <= 1. What rounds to a whole number may be one too
 * many. */
ENG_INLINE eng_d eng_thick_cell(const struct eng_thick_cells *cells, eng_d t)
{
    const eng_d whole = eng_d_all(0x1.8p52);
    eng_d near = (t * cells->count - ENG_THICK_CELLS_OFFSET + whole) - whole;
    return eng_d_select(eng_d_less(t, eng_thick_border(cells, near)), near - 1, near);
}

/* Its first time, and its last. */
ENG_INLINE eng_d eng_thick_begin(const struct eng_thick_cells *cells, eng_d cell)
{
    return eng_d_max(eng_thick_border(cells, cell), eng_d_all(0));
}

ENG_INLINE eng_d eng_thick_end(const struct eng_thick_cells *cells, eng_d cell)
{
    eng_d next = eng_thick_border(cells, cell + 1);
    return eng_d_min(eng_d_of(eng_di_of(next) - 1), eng_d_all(1));
}

ENG_INLINE struct eng_thick_cells eng_thick_cells_of(int depth, double t_end)
{
    struct eng_thick_cells cells = {.count = eng_d_all((double)(INT64_C(1) << depth))};
    cells.length = 1 / cells.count;
    cells.last = eng_thick_cell(&cells, eng_d_all(t_end));
    return cells;
}

/* ---- how two features move ------------------------------------------------------- */

/* How two thick features move, a pair to each lane. */

/* From a point of feature b to one of a. */
#define ENG_THICK_DIFFERENCES 4

/* A distance beyond those of all points. */
#define ENG_THICK_FAR 16.0

struct eng_thick_motion {
    int count;
    struct eng_v w[2][ENG_THICK_DIFFERENCES]; /* at t = 0 and 1 */
    struct eng_pose_lanes at[2];
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
        struct eng_pose_lanes *pose = &motion->at[end];
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
        size = eng_d_max(size, eng_v_size_of_two(motion->w[0][k], motion->w[1][k]));
    }
    return size;
}

ENG_INLINE void eng_thick_scale(struct eng_thick_motion *motion, eng_d factor)
{
#pragma GCC unroll 2
    for (int end = 0; end < 2; end++) {
        struct eng_pose_lanes *pose = &motion->at[end];
#pragma GCC unroll 4
        for (int k = 0; k < motion->count; k++) {
            motion->w[end][k] = eng_v_scale(factor, motion->w[end][k]);
        }
        pose->p = eng_v_scale(factor, pose->p);
        pose->b = eng_v_scale(factor, pose->b);
        pose->c = eng_v_scale(factor, pose->c);
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

ENG_INLINE struct eng_pose_lanes eng_thick_pose_at(const struct eng_thick_motion *motion,
                                                   eng_d t)
{
    const struct eng_pose_lanes *at = motion->at;
    eng_d s = 1 - t;
    return (struct eng_pose_lanes){eng_v_mix(s, at[0].p, t, at[1].p),
                                   eng_v_mix(s, at[0].b, t, at[1].b),
                                   eng_v_mix(s, at[0].c, t, at[1].c)};
}

/* About from the nearest point of feature b to that of feature a. */
ENG_INLINE struct eng_nearest_gap
eng_thick_estimate_at(enum pccd_kind form, const struct eng_thick_motion *motion, eng_d t)
{
    struct eng_pose_lanes pose = eng_thick_pose_at(motion, t);
    struct eng_nearest_gap nearest = eng_nearest_gap_of(form, &pose);
    if (form == PCCD_EE) {
        nearest.gap = (struct eng_v){-nearest.gap.x, -nearest.gap.y, -nearest.gap.z};
    }
    return nearest;
}

/* ---- advance --------------------------------------------------------------------- */

/* Turns that are tried before integers take over; the first ones ask planes. */
#define TURNS_MAX   48
#define EARLY_TURNS 2

/* Error bounds that BOUNDS.md derives: of a projection, times the size of its direction;
 * of the length of a gap; of a quotient and of other products. All differences are below
 * 1. */
#define PROJECTED (8 * ENG_U)
#define GAP_ERROR (96 * ENG_U)
#define ROUNDED   (8 * ENG_U)
#define HEIGHT    (512 * ENG_U) /* of a determinant; a third of three */
#define ACROSS    (320 * ENG_U) /* of a length across, or of two in the middle */
#define TURNED    (16 * ENG_U)  /* of a projection at a time between */

/* The least square of a direction: squares of shorter ones lose their last bits. */
#define DIRECTION_MIN 0x1p-600

/* The distance at which a pair meets is between them; scaled. */
struct reach {
    eng_d lo, hi;
};

/* ---- along a direction ------------------------------------------------------------- */

/* Compute how far feature a is certainly beyond `reach` from b along g at the ends, by a
 * pair of their points. Linear in between; where positive, the points are apart. */
ENG_INLINE void project(const struct eng_thick_motion *motion, int k, struct eng_v g,
                        eng_d reach, eng_d apart[2])
{
    struct eng_v sizes = eng_v_abs(g);
    eng_d margin = PROJECTED * (sizes.x + sizes.y + sizes.z) + ENG_TINY;
    apart[0] = eng_v_dot(g, motion->w[0][k]) - margin - reach;
    apart[1] = eng_v_dot(g, motion->w[1][k]) - margin - reach;
}

/* Until when features that are farther apart than r up to t are so, along g; 2: to the
 * end. t = 0: nothing is known yet, also of 0 itself. */
ENG_INLINE eng_d apart_until(const struct eng_thick_motion *motion, struct eng_v g,
                             eng_d r, eng_d t)
{
    const eng_d zero = {0};
    eng_d gg = eng_v_dot(g, g);
    eng_d reach = r * (eng_d_sqrt(gg) * (1 + ROUNDED) + ENG_TINY) * (1 + ROUNDED);
    eng_d until = zero + 2;
    eng_dm good = eng_d_at_most(eng_d_all(DIRECTION_MIN), gg);
#pragma GCC unroll 4
    for (int k = 0; k < motion->count; k++) {
        eng_d apart[2];
        project(motion, k, g, reach, apart);
        eng_d at = apart[0] / (apart[0] - apart[1]); /* where it is 0 */
        eng_dm begins = eng_d_less(zero, apart[0]);
        eng_dm ends = eng_d_less(zero, apart[1]);
        eng_dm is_late = eng_dm_and(ends, eng_d_less(at * (1 + ROUNDED), t));
        good = eng_dm_and(good, eng_dm_or(begins, is_late));
        until = eng_d_select(eng_dm_and(begins, eng_dm_not(ends)),
                             eng_d_min(until, at * (1 - ROUNDED)), until);
    }
    return eng_d_select(good, eng_d_max(until, t), t);
}

/* ---- planes that turn with the features -------------------------------------------- */

/* The planes across both features, n = b x c, are (p . n) / |n| apart: p . n as a cubic
 * and n . n as a quartic in time. Rounding does not matter. */
struct planes {
    eng_d height[4];
    eng_d square[5];
};

ENG_INLINE struct planes planes_of(const struct eng_thick_motion *motion)
{
    const struct eng_pose_lanes *at = motion->at;
    struct eng_v dp = eng_v_sub(at[1].p, at[0].p);
    struct eng_v db = eng_v_sub(at[1].b, at[0].b);
    struct eng_v dc = eng_v_sub(at[1].c, at[0].c);
    struct eng_v n0 = eng_v_cross(at[0].b, at[0].c);
    struct eng_v n1 = eng_v_add(eng_v_cross(at[0].b, dc), eng_v_cross(db, at[0].c));
    struct eng_v n2 = eng_v_cross(db, dc);
    return (struct planes){
        {eng_v_dot(at[0].p, n0), eng_v_dot(at[0].p, n1) + eng_v_dot(dp, n0),
         eng_v_dot(at[0].p, n2) + eng_v_dot(dp, n1), eng_v_dot(dp, n2)},
        {eng_v_dot(n0, n0), 2 * eng_v_dot(n0, n1),
         eng_v_dot(n1, n1) + 2 * eng_v_dot(n0, n2), 2 * eng_v_dot(n1, n2),
         eng_v_dot(n2, n2)}};
}

/* Each takes a root and a quotient that wait for each other: the few contacts that four
 * do not find take another turn. */
#define GUESSES     4
#define GUESS_MOVES 0x1p-42

/* About when the planes will be r apart, from t on; 1: they will not. Newton's method,
 * between times where they are more and less. */
ENG_INLINE eng_d guess(const struct planes *planes, eng_d r, eng_d t)
{
    const eng_d zero = {0};
    const eng_d *square = planes->square;
    eng_d h[4];
    eng_d at_t =
        ((planes->height[3] * t + planes->height[2]) * t + planes->height[1]) * t +
        planes->height[0];
    eng_d sign = eng_d_select(eng_d_less(at_t, zero), zero - 1, zero + 1);
#pragma GCC unroll 4
    for (int i = 0; i < 4; i++) {
        h[i] = sign * planes->height[i];
    }
    eng_d x = t;
    eng_d more = t;
    eng_d less = zero + 1;
    for (int i = 0; i < GUESSES; i++) {
        eng_d height = ((h[3] * x + h[2]) * x + h[1]) * x + h[0];
        eng_d slope = (3 * h[3] * x + 2 * h[2]) * x + h[1];
        eng_d q = (((square[4] * x + square[3]) * x + square[2]) * x + square[1]) * x +
                  square[0];
        eng_d q_slope =
            ((4 * square[4] * x + 3 * square[3]) * x + 2 * square[2]) * x + square[1];
        eng_d n = eng_d_sqrt(eng_d_max(q, zero));
        eng_d f = height * n - r * q; /* times |n| */
        eng_dm is_more = eng_d_less(zero, f);
        more = eng_d_select(is_more, x, more);
        less = eng_d_select(is_more, less, x);
        eng_d next = x - f / (slope * n - 0.5 * r * q_slope);
        eng_dm fits = eng_dm_and(eng_d_less(more, next), eng_d_less(zero, next));
        next = eng_d_select(fits, next, eng_d_select(is_more, less, 0.5 * (more + less)));
        next = eng_d_min(next, less);
        eng_dm moves = eng_d_less(eng_d_all(GUESS_MOVES), eng_d_abs(next - x));
        if (eng_dm_bits(moves) == 0) {
            break;
        }
        x = eng_d_select(moves, next, x);
    }
    return x;
}

/* Between t and `end` of the time: what p . n less r |n| is not below, as a cubic, by its
 * Bernstein coefficients. Where it is positive the features are farther apart than r. */
ENG_INLINE void heights_between(const struct eng_thick_motion *motion, eng_d r, eng_d t,
                                eng_d end, eng_d h[4])
{
    const eng_d zero = {0};
    struct eng_pose_lanes from = eng_thick_pose_at(motion, t);
    struct eng_pose_lanes to = eng_thick_pose_at(motion, end);
    struct eng_v n[3] = {eng_v_cross(from.b, from.c),
                         eng_v_add(eng_v_cross(from.b, to.c), /* twice */
                                   eng_v_cross(to.b, from.c)),
                         eng_v_cross(to.b, to.c)};
    eng_d reach[3];
#pragma GCC unroll 3
    for (int i = 0; i < 3; i++) {
        reach[i] = r * (eng_d_sqrt(eng_v_dot(n[i], n[i])) * (1 + ROUNDED) + ACROSS) *
                   (1 + ROUNDED);
    }
    h[0] = eng_v_dot(from.p, n[0]);
    h[1] = eng_v_dot(from.p, n[1]) + eng_v_dot(to.p, n[0]);
    h[2] = eng_v_dot(to.p, n[1]) + eng_v_dot(from.p, n[2]);
    h[3] = eng_v_dot(to.p, n[2]);
    eng_d sign = eng_d_select(eng_d_less(h[0], zero), zero - 1, zero + 1);
    h[0] = sign * h[0] - reach[0] - HEIGHT;
    h[1] = sign * h[1] - (reach[0] + reach[1]) * (1 + ROUNDED) - 3 * HEIGHT;
    h[2] = sign * h[2] - (reach[1] + reach[2]) * (1 + ROUNDED) - 3 * HEIGHT;
    h[3] = sign * h[3] - reach[2] - HEIGHT;
    h[1] *= 1 / 3.0;
    h[2] *= 1 / 3.0;
}

/* As apart_until, by the planes, from t to `end`. Where the cubic is not positive
 * throughout, it is not below the line from its first coefficient to that of the others
 * to which it falls fastest. */
ENG_INLINE eng_d planes_until(const struct eng_thick_motion *motion, eng_d r, eng_d t,
                              eng_d end)
{
    const eng_d zero = {0};
    eng_d h[4];
    heights_between(motion, r, t, end, h);
    eng_d part = zero + 1;
#pragma GCC unroll 3
    for (int i = 1; i < 4; i++) {
        eng_d at = (i / 3.0) * (h[0] / (h[0] - h[i]));
        part = eng_d_select(eng_d_less(h[i], h[0]), eng_d_min(part, at), part);
    }
    eng_dm all =
        eng_d_less(zero, eng_d_min(eng_d_min(h[0], h[1]), eng_d_min(h[2], h[3])));
    eng_d until = (t + part * (end - t)) * (1 - 2 * ROUNDED);
    eng_dm is_end = eng_d_at_most(zero + 1, end);
    until = eng_d_select(all, eng_d_select(is_end, zero + 2, end), until);
    return eng_d_select(eng_d_less(zero, h[0]), eng_d_max(until, t), t);
}

/* ---- directions that turn ---------------------------------------------------------- */

/* A direction at a time, about one long, and what is subtracted of projections on it. */
struct direction {
    eng_d t;
    struct eng_v g;
    eng_d least;
};

ENG_INLINE struct direction direction_of(struct eng_nearest_gap nearest, eng_d r, eng_d t)
{
    eng_d length = eng_d_sqrt(eng_v_dot(nearest.gap, nearest.gap));
    struct eng_v g = eng_v_scale(1 / length, nearest.gap);
    struct eng_v sizes = eng_v_abs(g);
    eng_d size = eng_d_sqrt(eng_v_dot(g, g)) * (1 + ROUNDED) + ENG_TINY;
    return (struct direction){
        t, g, r * size * (1 + ROUNDED) + TURNED * (sizes.x + sizes.y + sizes.z)};
}

/* As planes_until, along a direction that goes from the one to the other meanwhile. */
ENG_INLINE eng_d turning_until(const struct eng_thick_motion *motion,
                               const struct direction *from, const struct direction *to)
{
    const eng_d zero = {0};
    eng_d part = zero + 1;
    eng_d least = zero + 1;
    eng_d first = zero + 1;
#pragma GCC unroll 4
    for (int k = 0; k < motion->count; k++) {
        struct eng_v x =
            eng_v_mix(1 - from->t, motion->w[0][k], from->t, motion->w[1][k]);
        struct eng_v y = eng_v_mix(1 - to->t, motion->w[0][k], to->t, motion->w[1][k]);
        eng_d h[3] = {eng_v_dot(from->g, x) - from->least,
                      0.5 * (eng_v_dot(from->g, y) + eng_v_dot(to->g, x) -
                             (from->least + to->least) * (1 + ROUNDED)),
                      eng_v_dot(to->g, y) - to->least};
        first = eng_d_min(h[0], first);
        least = eng_d_min(eng_d_min(h[0], eng_d_min(h[1], h[2])), least);
#pragma GCC unroll 2
        for (int i = 1; i < 3; i++) {
            eng_d at = (i / 2.0) * (h[0] / (h[0] - h[i]));
            part = eng_d_select(eng_d_less(h[i], h[0]), eng_d_min(part, at), part);
        }
    }
    eng_d until = (from->t + part * (to->t - from->t)) * (1 - 2 * ROUNDED);
    eng_d end = eng_d_select(eng_d_at_most(zero + 1, to->t), zero + 2, to->t);
    until = eng_d_select(eng_d_less(zero, least), end, until);
    return eng_d_select(eng_d_less(zero, first), eng_d_max(until, from->t), from->t);
}

/* About when the nearest points of a time will be r apart; 1: they will not. */
ENG_INLINE eng_d meeting_of(enum pccd_kind form, const struct eng_thick_motion *motion,
                            const struct eng_nearest_gap *nearest, eng_d r, eng_d t)
{
    const struct eng_pose_lanes *at = motion->at;
    const eng_d zero = {0};
    struct eng_v speed =
        eng_v_sub(eng_v_sub(eng_v_sub(at[1].p, at[0].p),
                            eng_v_scale(nearest->beta, eng_v_sub(at[1].b, at[0].b))),
                  eng_v_scale(nearest->gamma, eng_v_sub(at[1].c, at[0].c)));
    eng_d gg = eng_v_dot(nearest->gap, nearest->gap);
    eng_d fall = eng_v_dot(nearest->gap, speed); /* times |gap| */
    if (form == PCCD_VF) {
        fall = -fall;
    }
    eng_d ahead = (gg - r * eng_d_sqrt(gg)) / fall;
    return eng_d_select(eng_d_less(zero, fall), eng_d_min(t + ahead, zero + 1), zero + 1);
}

/* ---- a turn ------------------------------------------------------------------------ */

/* The state of the pairs in the lanes. */
struct known {
    eng_d until;  /* before, they are certainly farther apart than r */
    eng_d cell;   /* of `until` */
    eng_d looked; /* the last cell at whose end somebody has looked */
    struct reach reach;
    eng_dm is_inside; /* d(0) is certainly at most r */
    eng_dm meets;     /* in `cell`; or at t = 0, if `until` is 0 */
    eng_dm misses;
    eng_dm goes_on;
};

/* From t on, shortly before x: in the cell of x, or of t. */
ENG_INLINE eng_d shortly_before(const struct eng_thick_cells *cells, eng_d x, eng_d t)
{
    const eng_d zero = {0};
    eng_d from = eng_d_max(t, eng_thick_begin(cells, eng_thick_cell(cells, x)));
    eng_d before = from + 0.5 * (x - from);
    return eng_d_select(eng_d_less(x, zero + 1), eng_d_max(before, t), zero + 1);
}

/* The distance at t = 0 is certainly at least this, by the direction of the gap. */
ENG_INLINE eng_d start_at_least(const struct eng_thick_motion *motion, struct eng_v g)
{
    const eng_d zero = {0};
    eng_d least = zero + __builtin_inf();
    eng_d gg = eng_v_dot(g, g);
#pragma GCC unroll 4
    for (int k = 0; k < motion->count; k++) {
        eng_d apart[2];
        project(motion, k, g, zero, apart);
        least = eng_d_min(least, apart[0]);
    }
    eng_d length = eng_d_sqrt(gg) * (1 + ROUNDED) + ENG_TINY;
    eng_dm fits =
        eng_dm_and(eng_d_less(zero, least), eng_d_at_most(eng_d_all(DIRECTION_MIN), gg));
    return eng_d_select(fits, least / length * (1 - ROUNDED), zero);
}

/* Those that begin inside meet at a part of their first distance. */
ENG_INLINE void approach(const struct eng_thick_motion *motion, eng_dm is_inside,
                         double part, struct eng_v gap, eng_d most, struct reach *reach)
{
    eng_d least = start_at_least(motion, gap);
    reach->lo =
        eng_d_select(is_inside, part * least * (1 - ROUNDED) - ENG_TINY, reach->lo);
    reach->hi =
        eng_d_select(is_inside, part * most * (1 + ROUNDED) + ENG_TINY, reach->hi);
}

/* Until when the features certainly stay apart along directions from the one between them
 * about at t to the one when they will about be r apart; or along that one. */
ENG_INLINE eng_d turning(enum pccd_kind form, const struct eng_thick_motion *motion,
                         const struct eng_thick_cells *cells, eng_d r,
                         const struct eng_nearest_gap *nearest, eng_d t)
{
    eng_d end = shortly_before(cells, meeting_of(form, motion, nearest, r, t), t);
    struct eng_nearest_gap then = eng_thick_estimate_at(form, motion, end);
    struct direction from = direction_of(*nearest, r, t);
    struct direction to = direction_of(then, r, end);
    eng_d until = turning_until(motion, &from, &to);
    eng_d gg =
        eng_d_min(eng_v_dot(nearest->gap, nearest->gap), eng_v_dot(then.gap, then.gap));
    eng_dm is_sure = eng_d_less(eng_d_all(GAP_ERROR * GAP_ERROR), gg);
    return eng_d_max(eng_d_select(is_sure, until, t),
                     apart_until(motion, then.gap, r, t));
}

ENG_INLINE void turn(enum pccd_kind form, bool is_late,
                     const struct eng_thick_motion *motion,
                     const struct eng_advance_limits *limits,
                     const struct eng_thick_cells *cells, struct known *known)
{
    const eng_d zero = {0};
    eng_d begin = known->until;
    eng_d until = begin;
    if (!is_late) {
        struct planes planes = planes_of(motion);
        eng_d x = guess(&planes, known->reach.hi, begin);
        until =
            planes_until(motion, known->reach.hi, begin, shortly_before(cells, x, begin));
    }
    known->cell = eng_thick_cell(cells, until);
    known->misses =
        eng_dm_or(eng_d_at_most(zero + 1, until), eng_d_less(cells->last, known->cell));
    eng_dm has_begun = eng_d_less(zero, until);
    /* Nobody looks twice at the end of a cell, but at the time itself. */
    eng_dm is_new = eng_dm_and(has_begun, eng_d_less(known->looked, known->cell));
    eng_d look = eng_d_select(is_new, eng_thick_end(cells, known->cell), until);
    known->looked = eng_d_select(is_new, known->cell, known->looked);
    struct eng_nearest_gap nearest = eng_thick_estimate_at(form, motion, look);
    eng_d most = eng_d_sqrt(eng_v_dot(nearest.gap, nearest.gap)) * (1 + ROUNDED) +
                 GAP_ERROR + ENG_TINY;
    known->meets =
        eng_dm_and(eng_d_at_most(most, known->reach.lo), eng_dm_not(known->misses));
    eng_dm at_once = eng_dm_and(known->meets, eng_dm_not(has_begun));
    known->is_inside = eng_dm_or(known->is_inside, at_once);
    if (limits->approach > 0 && eng_dm_bits(at_once) != 0) {
        approach(motion, at_once, limits->approach, nearest.gap, most, &known->reach);
        known->meets = eng_dm_and(known->meets, has_begun);
    }
    eng_d next = apart_until(motion, nearest.gap, known->reach.hi, until);
    if (is_late) {
        next = eng_d_max(next,
                         turning(form, motion, cells, known->reach.hi, &nearest, until));
    }
    until = eng_d_select(known->meets, until, next);
    known->misses = eng_dm_or(known->misses, eng_dm_and(eng_d_at_most(zero + 1, until),
                                                        eng_dm_not(known->meets)));
    known->goes_on = eng_dm_and(eng_dm_or(is_new, eng_d_less(begin, until)),
                                eng_dm_not(eng_dm_or(known->meets, known->misses)));
    known->until = until;
}

/* ---- all pairs --------------------------------------------------------------------- */

ENG_INLINE void load_known(const struct eng_advance *const own[ENG_D_LANES],
                           bool is_first, const struct eng_thick_motion *motion,
                           struct known *known)
{
    double x[4][ENG_D_LANES];
    double inside[ENG_D_LANES];
#pragma GCC unroll 8
    for (uint32_t lane = 0; lane < ENG_D_LANES; lane++) {
        x[0][lane] = own[lane]->until;
        x[1][lane] = own[lane]->lo;
        x[2][lane] = own[lane]->hi;
        x[3][lane] = own[lane]->looked;
        inside[lane] = own[lane]->is_inside;
    }
    known->until = eng_d_load(x[0]);
    known->reach = (struct reach){eng_d_load(x[1]), eng_d_load(x[2])};
    known->looked = eng_d_load(x[3]);
    known->is_inside = eng_d_less(eng_d_all(0), eng_d_load(inside));
    if (is_first) { /* lo is r */
        known->looked = eng_d_all(-2);
        eng_d r = eng_d_min(known->reach.lo * motion->scale[0] * motion->scale[1],
                            eng_d_all(ENG_THICK_FAR));
        known->reach =
            (struct reach){r * (1 - ROUNDED) - ENG_TINY, r * (1 + ROUNDED) + ENG_TINY};
    }
}

ENG_INLINE void store_known(const struct known *known, uint32_t n,
                            struct eng_advance *const own[ENG_D_LANES])
{
    double x[5][ENG_D_LANES];
    uint32_t inside = eng_dm_bits(known->is_inside);
    uint32_t meets = eng_dm_bits(known->meets);
    uint32_t misses = eng_dm_bits(known->misses);
    eng_d_store(x[0], known->until);
    eng_d_store(x[1], known->reach.lo);
    eng_d_store(x[2], known->reach.hi);
    eng_d_store(x[3], known->cell);
    eng_d_store(x[4], known->looked);
    for (uint32_t lane = 0; lane < n; lane++) {
        own[lane]->until = x[0][lane];
        own[lane]->lo = x[1][lane];
        own[lane]->hi = x[2][lane];
        own[lane]->cell = x[3][lane];
        own[lane]->looked = x[4][lane];
        own[lane]->is_inside = inside >> lane & 1u;
        own[lane]->now = misses >> lane & 1u     ? ENG_ADVANCE_MISSES
                         : !(meets >> lane & 1u) ? ENG_ADVANCE_UNDECIDED
                         : x[0][lane] > 0        ? ENG_ADVANCE_MEETS
                                                 : ENG_ADVANCE_INITIALLY;
    }
}

ENG_INLINE void advance(enum pccd_kind form, const struct eng_point *points,
                        const uint32_t (*quads)[4], const uint32_t *pairs, uint32_t count,
                        const struct eng_advance_limits *limits,
                        struct eng_advance *advance)
{
    uint32_t live[ENG_ADVANCE_MAX];
    const struct eng_thick_cells cells = eng_thick_cells_of(limits->depth, limits->t_end);
    for (uint32_t i = 0; i < count; i++) {
        live[i] = i;
    }
    for (int round = 0; round < TURNS_MAX && count > 0; round++) {
        uint32_t kept = 0;
        for (uint32_t i = 0; i < count; i += ENG_D_LANES) {
            uint32_t n = count - i < ENG_D_LANES ? count - i : ENG_D_LANES;
            uint32_t now[ENG_D_LANES];
            struct eng_advance *own[ENG_D_LANES];
            struct known known;
#pragma GCC unroll 8
            for (uint32_t lane = 0; lane < ENG_D_LANES; lane++) {
                uint32_t place = live[i + (lane < n ? lane : 0)];
                now[lane] = pairs[place];
                own[lane] = &advance[place];
            }
            struct eng_group group = eng_group_of(points, quads, now, n);
            struct eng_thick_motion motion = eng_thick_load(form, &group);
            load_known((const struct eng_advance *const *)own, round == 0, &motion,
                       &known);
            if (round < EARLY_TURNS) {
                turn(form, false, &motion, limits, &cells, &known);
            } else {
                turn(form, true, &motion, limits, &cells, &known);
            }
            store_known(&known, n, own);
            kept += eng_compress(live + kept, live + i, n, eng_dm_bits(known.goes_on));
        }
        count = kept;
    }
}

void ENG_KERNEL(advance)(struct eng_quads chunk, const uint32_t *pairs, uint32_t count,
                         const struct eng_advance_limits *limits, struct eng_advance *all)
{
    if (eng_thick_form(chunk.kind) == PCCD_VF) {
        advance(PCCD_VF, chunk.points, chunk.quads, pairs, count, limits, all);
    } else {
        advance(PCCD_EE, chunk.points, chunk.quads, pairs, count, limits, all);
    }
}

/* ---- contacts ---------------------------------------------------------------------- */

ENG_INLINE void describe(enum pccd_kind form, bool is_ve, const struct eng_point *points,
                         const uint32_t (*quads)[4], const uint32_t *pairs,
                         uint32_t count, struct eng_hit *hits)
{
    const eng_d zero = {0};
    for (uint32_t i = 0; i < count; i += ENG_D_LANES) {
        uint32_t n = count - i < ENG_D_LANES ? count - i : ENG_D_LANES;
        double at[ENG_D_LANES];
        float as[5][ENG_D_LANES];
        struct eng_group group = eng_group_of(points, quads, pairs + i, n);
        struct eng_thick_motion motion = eng_thick_load(form, &group);
#pragma GCC unroll 8
        for (uint32_t lane = 0; lane < ENG_D_LANES; lane++) {
            at[lane] = hits[i + (lane < n ? lane : 0)].toi;
        }
        struct eng_nearest_gap nearest =
            eng_thick_estimate_at(form, &motion, eng_d_load(at));
        eng_d length = eng_d_sqrt(eng_v_dot(nearest.gap, nearest.gap));
        eng_dm is_sure = eng_d_less(eng_d_all(GAP_ERROR), length);
        eng_d_quantised(as[0], is_ve ? zero : nearest.beta);
        eng_d_quantised(as[1], is_ve ? nearest.beta : nearest.gamma);
        eng_d_quantised(as[2], eng_d_select(is_sure, nearest.gap.x / length, zero));
        eng_d_quantised(as[3], eng_d_select(is_sure, nearest.gap.y / length, zero));
        eng_d_quantised(as[4], eng_d_select(is_sure, nearest.gap.z / length, zero));
        for (uint32_t lane = 0; lane < n; lane++) {
            struct eng_hit *hit = &hits[i + lane];
            hit->param[0] = as[0][lane];
            hit->param[1] = as[1][lane];
            hit->normal[0] = as[2][lane];
            hit->normal[1] = as[3][lane];
            hit->normal[2] = as[4][lane];
        }
    }
}

void ENG_KERNEL(describe)(struct eng_quads chunk, const uint32_t *pairs, uint32_t count,
                          struct eng_hit *hits)
{
    if (eng_thick_form(chunk.kind) == PCCD_EE) {
        describe(PCCD_EE, false, chunk.points, chunk.quads, pairs, count, hits);
    } else {
        describe(PCCD_VF, chunk.kind == PCCD_VE, chunk.points, chunk.quads, pairs, count,
                 hits);
    }
}

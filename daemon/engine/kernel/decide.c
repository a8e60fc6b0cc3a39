/* decide.c - the cheapest rejections and the certified solver, of one pair by itself.
 *
 * Source: BOUNDS.md. A part of the scalar set alone: other vectors have lanes to spare.
 */
#include "bracket.h"
#include "kinds.h"
#include "reject.h"
#include "table.h"

ENG_INLINE bool separates(enum pccd_kind kind, const struct eng_query *query)
{
    struct eng_v d[2][DIFFERENCES];
#pragma GCC unroll 2
    for (int end = 0; end < 2; end++) {
        struct eng_v x[4];
#pragma GCC unroll 4
        for (int i = 0; i < 4; i++) {
            const double *at = query->x[end][i];
            x[i] = (struct eng_v){at[0], at[1], at[2]};
        }
        subtract(kind, x, d[end]);
    }
    return are_beyond(kind, d, 0, AXES, 0) ||
           are_beyond(kind, d, AXES, DIRECTIONS, diagonal_margin(kind, d));
}

bool eng_query_separates(const struct eng_query *query)
{
    return common_kinds[query->kind].points[0] == 1 ? separates(PCCD_VF, query)
                                                    : separates(PCCD_EE, query);
}

ENG_INLINE void find_root(enum look look, struct lanes *lanes)
{
    const int rounds = look == LOOK_FALLING ? ROUNDS_FALLING : ROUNDS_ALL;
    guess(look, lanes);
    for (int round = 0; round < rounds; round++) {
        move(look, lanes);
        if (lanes->on_way == 0) {
            break;
        }
    }
}

/* Decide whether a contact begins in the interval at hand. */
ENG_INLINE enum eng_decision look_at_root(enum pccd_kind kind, enum look look,
                                          struct lanes *lanes,
                                          const struct limits *limits,
                                          struct eng_hit *hit)
{
    find_root(look, lanes);
    struct bracket at = enclose(kind, look, lanes, limits);
    if (!eng_dm_bits(at.meets)) {
        return eng_dm_bits(at.passed) ? ENG_MISSES : ENG_UNDECIDED;
    }
    eng_d numbers[5];
    describe(kind, lanes, &at.domain, numbers);
    hit->flags = PCCD_PROVED;
    hit->toi = at.x;
    hit->toi_hi = at.y;
    hit->param[0] = (float)numbers[0];
    hit->param[1] = (float)numbers[1];
    hit->normal[0] = (float)numbers[2];
    hit->normal[1] = (float)numbers[3];
    hit->normal[2] = (float)numbers[4];
    return ENG_MEETS;
}

/* The look for all shapes, of a pair that the first look has left open. */
ENG_INLINE enum eng_decision look_again(enum pccd_kind kind, struct lanes *lanes,
                                        const struct limits *limits, struct eng_hit *hit)
{
    enum eng_decision verdict = ENG_MISSES;
    eng_cubic_tighten(&lanes->cubic, lanes->motion.v); /* turned or not is the same */
    set_pieces(lanes, is_certain(lanes));
    if (lanes->done != 0 || lanes->wanted == 0) {
        return lanes->done != 0 ? ENG_MISSES : ENG_UNDECIDED;
    }
    for (int piece = 0; verdict == ENG_MISSES; piece++) {
        verdict = look_at_root(kind, LOOK_ALL, lanes, limits, hit);
        if (piece == 2 || !eng_dm_bits(lanes->bends[piece])) {
            break;
        }
        set_next(lanes, piece + 1);
    }
    return verdict;
}

static __attribute__((noinline)) enum eng_decision
look_again_vf(struct lanes *lanes, const struct limits *limits, struct eng_hit *hit)
{
    return look_again(PCCD_VF, lanes, limits, hit);
}

static __attribute__((noinline)) enum eng_decision
look_again_ee(struct lanes *lanes, const struct limits *limits, struct eng_hit *hit)
{
    return look_again(PCCD_EE, lanes, limits, hit);
}

ENG_INLINE enum eng_decision decide(enum pccd_kind kind, const struct eng_query *query,
                                    const struct limits *limits, struct eng_hit *hit)
{
    struct lanes lanes = {.count = 1};
    struct eng_v x[4][2];
#pragma GCC unroll 4
    for (int i = 0; i < 4; i++) {
        const double *x0 = query->x[0][i];
        const double *x1 = query->x[1][i];
        x[i][0] = (struct eng_v){x0[0], x0[1], x0[2]};
        x[i][1] = (struct eng_v){x1[0], x1[1], x1[2]};
    }
    eng_motion_of(kind, x, &lanes.motion);
    set_falling(&lanes, open(LOOK_FALLING, &lanes), limits);
    if (lanes.done != 0) {
        return ENG_MISSES;
    }
    if (lanes.wanted != 0) {
        enum eng_decision decision =
            look_at_root(kind, LOOK_FALLING, &lanes, limits, hit);
        if (decision != ENG_UNDECIDED) {
            return decision;
        }
    }
    /* A copy: the first look's own stays in registers. */
    struct lanes again = {.motion = lanes.motion,
                          .cubic = lanes.cubic,
                          .starts_below = lanes.starts_below,
                          .count = 1};
    return kind == PCCD_VF ? look_again_vf(&again, limits, hit)
                           : look_again_ee(&again, limits, hit);
}

enum eng_decision eng_decide(const struct eng_query *query, double tolerance,
                             double t_end, struct eng_hit *hit)
{
    const struct limits limits = limits_of(tolerance, t_end);
    enum eng_decision verdict = query->kind == PCCD_VF
                                    ? decide(PCCD_VF, query, &limits, hit)
                                    : decide(PCCD_EE, query, &limits, hit);
    return verdict == ENG_MEETS && !(hit->toi <= t_end) ? ENG_MISSES : verdict;
}

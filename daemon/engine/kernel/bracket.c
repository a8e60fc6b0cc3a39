/* bracket.c - the certified solver, a pair to each lane.
 *
 * Find the roots of the coplanarity cubic, enclose each between two times at which its
 * sign is certain, and say whether the features certainly meet or certainly miss there.
 * What is not certain is left to solve.c.
 *
 * Source: every constant times u is derived in BOUNDS.md.
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
#include "bracket.h"
#include "table.h"

/* Pairs that go through the stages together: what is known of them stays in the first
 * cache. */
#define PAIRS  64u /* as a word has bits */
#define GROUPS (PAIRS / ENG_D_LANES)

/* The pairs of a few groups: all that is written of a contact, of those without one, too.
 * Contacts are picked out afterwards: no branch in between foresees them. */
struct hits {
    uint64_t bits; /* of the pairs with a contact that begins in time */
    double at[2][PAIRS];
    float as[5][PAIRS];
};

ENG_INLINE void write_hits(const struct hits *hits, const uint32_t *pairs,
                           struct eng_bracketed *out)
{
    uint32_t count = out->hit_count;
    for (uint64_t bits = hits->bits; bits != 0; bits &= bits - 1) {
        uint32_t i = (uint32_t)__builtin_ctzll(bits);
        struct eng_hit *hit = &out->hits[count];
        hit->flags = PCCD_PROVED;
        hit->toi = hits->at[0][i];
        hit->toi_hi = hits->at[1][i];
        hit->param[0] = hits->as[0][i];
        hit->param[1] = hits->as[1][i];
        hit->normal[0] = hits->as[2][i];
        hit->normal[1] = hits->as[3][i];
        hit->normal[2] = hits->as[4][i];
        out->index[count++] = pairs[i];
    }
    out->hit_count = count;
}

/* Enclose the roots of the group of pairs first, first + 1 .. and note what meets there.
 * What certainly misses there, and not more, is returned. */
ENG_INLINE eng_dm close(enum pccd_kind kind, enum look look, struct lanes *lanes,
                        const struct limits *limits, uint32_t first, struct hits *hits)
{
    struct bracket at = enclose(kind, look, lanes, limits);
    uint32_t hit = eng_dm_bits(at.meets) & lanes->wanted;
    if (ENG_D_LANES > 1 || hit != 0) {
        eng_d numbers[5];
        describe(kind, lanes, &at.domain, numbers);
        eng_d_store(hits->at[0] + first, at.x);
        eng_d_store(hits->at[1] + first, at.y);
#pragma GCC unroll 5
        for (int i = 0; i < 5; i++) {
            eng_d_quantised(hits->as[i] + first, numbers[i]);
        }
        uint32_t in_time = eng_dm_bits(eng_d_at_most(at.x, eng_d_all(limits->t_end)));
        hits->bits |= (uint64_t)(hit & in_time) << first;
        lanes->done |= hit;
    }
    return at.passed;
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
ENG_INLINE void look_at(enum pccd_kind kind, enum look look, struct lanes lanes[GROUPS],
                        uint32_t count, const struct limits *limits,
                        struct eng_bracketed *out)
{
    const int pieces = look == LOOK_FALLING ? 1 : 3;
    for (int piece = 0; piece < pieces; piece++) {
        struct hits hits;
        hits.bits = 0; /* the rest is written before it is read */
        find_roots(look, lanes, count);
        uint32_t again = 0;
        for (uint32_t g = 0; g < count; g++) {
            uint32_t next = 0;
            if (lanes[g].wanted != 0) {
                eng_dm passed =
                    close(kind, look, &lanes[g], limits, g * ENG_D_LANES, &hits);
                uint32_t bits = eng_dm_bits(passed) & lanes[g].wanted;
                if (piece + 1 < pieces) {
                    next = bits & eng_dm_bits(lanes[g].bends[piece]);
                }
                lanes[g].done |= bits & ~next;
            }
            lanes[g].wanted = next;
            again |= next;
        }
        write_hits(&hits, lanes[0].pairs, out);
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
ENG_INLINE uint32_t look_at_all(enum pccd_kind kind, enum look look,
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
            eng_motion_load(kind, &group, &now->motion);
            eng_dm sure = open(look, now);
            if (look == LOOK_FALLING) {
                set_falling(now, sure, limits);
            } else {
                set_pieces(now, sure);
            }
        }
        look_at(kind, look, lanes, groups, limits, out);
        uint64_t bits = 0;
        for (uint32_t g = 0; g < groups; g++) {
            uint32_t all = (1u << lanes[g].count) - 1;
            bits |= (uint64_t)(all & ~lanes[g].done) << g * ENG_D_LANES;
        }
        for (; bits != 0; bits &= bits - 1) {
            left[left_count++] = pairs[i + (uint32_t)__builtin_ctzll(bits)];
        }
    }
    return left_count;
}

ENG_INLINE void bracket(enum pccd_kind kind, const struct eng_point *points,
                        const uint32_t (*quads)[4], uint32_t *pairs, uint32_t count,
                        double tolerance, double t_end, struct eng_bracketed *out)
{
    const struct limits limits = limits_of(tolerance, t_end);
    count =
        look_at_all(kind, LOOK_FALLING, points, quads, pairs, count, &limits, out, pairs);
    out->unsure_count += look_at_all(kind, LOOK_ALL, points, quads, pairs, count, &limits,
                                     out, out->unsure + out->unsure_count);
}

void ENG_KERNEL(bracket)(struct eng_quads chunk, uint32_t *pairs, uint32_t count,
                         double tolerance, double t_end, struct eng_bracketed *out)
{
    if (chunk.kind == PCCD_VF) {
        bracket(PCCD_VF, chunk.points, chunk.quads, pairs, count, tolerance, t_end, out);
    } else {
        bracket(PCCD_EE, chunk.points, chunk.quads, pairs, count, tolerance, t_end, out);
    }
}

/* movers.h - leaves out boxes and pairs of which nothing moves, or all is foreign.
 *
 * Threads: [any]; inline only. Included by files of this folder alone.
 *
 * Boxes are left out where they are bits: one by one they would take a tenth of what
 * it is to compare them. Lanes are by a pass over the list, which is in the first cache.
 */
#ifndef ENG_MOVERS_H
#define ENG_MOVERS_H

#include "join.h"
#include "lanes.h"

/* Lanes of a block of b which with a box of a, `slot`, are pairs of which either is
 * marked. */
ENG_INLINE uint32_t marked_lanes(const uint16_t *a_marks, uint32_t b_marks, uint32_t slot)
{
    uint32_t is_marked = a_marks[slot / ENG_WIDE] >> slot % ENG_WIDE & 1;
    return (b_marks | (0u - is_marked)) & 0xffff;
}

ENG_INLINE uint32_t own_of(const struct eng_join *job, uint32_t block)
{
    return job->b_own ? job->b_own[block] : 0;
}

/* Of these boxes of block n of a those that have pairs with block m of b of which either
 * moves, and either is not foreign. */
ENG_INLINE uint32_t keep_marked_boxes(struct eng_join *job, uint32_t boxes, uint32_t n,
                                      uint32_t m)
{
    uint32_t kept = boxes;
    if (job->a_own && own_of(job, m) == 0) {
        kept &= job->a_own[n];
    }
    if (job->a_moving && job->b_moving[m] == 0) {
        boxes = kept;
        kept &= job->a_moving[n];
        job->still += (uint32_t)__builtin_popcount(boxes ^ kept);
    }
    return kept;
}

/* Of the `count` boxes with lanes of b those lanes that are such pairs. */
ENG_INLINE uint32_t keep_moving_lanes(struct eng_join *job, struct eng_join_round *round,
                                      uint32_t count)
{
    uint32_t kept = 0;
    uint32_t still = 0;
    for (uint32_t i = 0; i < count; i++) {
        uint32_t box = round->box[i];
        uint32_t lanes = round->lanes[i];
        uint32_t moving = lanes & marked_lanes(job->a_moving,
                                               job->b_moving[round->first_b + (box >> 8)],
                                               round->first_a * ENG_WIDE + (box & 0xff));
        still += (uint32_t)__builtin_popcount(lanes ^ moving);
        round->box[kept] = box;
        round->lanes[kept] = moving;
        kept += moving != 0;
    }
    job->still += still;
    return kept;
}

/* Is anything foreign in the next `pairs` blocks of the round, whichever side may be
 * first? */
ENG_INLINE bool has_foreign(const struct eng_join *job,
                            const struct eng_join_round *round, uint32_t pairs)
{
    uint32_t own = 0xffff;
    for (uint32_t i = round->count; i < round->count + pairs; i++) {
        own &= job->a_own[round->a[i]] & job->b_own[round->b[i]];
    }
    return own != 0xffff;
}

ENG_INLINE uint64_t key_of(const struct eng_join *job, uint32_t slot)
{
    return job->keys[(size_t)slot * job->key_stride];
}

/* Lanes that are pairs of an own and a foreign feature, `slot` and those from `first` on:
 * those of which the own one comes first. They are few. */
ENG_INLINE uint32_t own_before(const struct eng_join *job, uint32_t slot, bool is_own,
                               uint32_t first, uint32_t lanes)
{
    const uint64_t key = key_of(job, slot);
    for (uint32_t left = lanes; left != 0; left &= left - 1) {
        uint32_t lane = (uint32_t)__builtin_ctz(left);
        bool is_first = key < key_of(job, first + lane);
        lanes ^= (uint32_t)(is_first != is_own) << lane;
    }
    return lanes;
}

/* Of the `count` boxes with lanes of b, either of which may come first, those lanes that
 * are pairs which are not left out. */
ENG_INLINE uint32_t keep_own_lanes(const struct eng_join *job,
                                   struct eng_join_round *round, uint32_t count)
{
    uint32_t kept = 0;
    for (uint32_t i = 0; i < count; i++) {
        uint32_t box = round->box[i];
        uint32_t slot = round->first_a * ENG_WIDE + (box & 0xff);
        uint32_t block = round->first_b + (box >> 8);
        uint32_t is_own = job->a_own[slot / ENG_WIDE] >> slot % ENG_WIDE & 1;
        uint32_t b_own = job->b_own[block];
        uint32_t both = round->lanes[i] & b_own & (0u - is_own);
        uint32_t one = round->lanes[i] & (b_own ^ (0u - is_own));
        if (one != 0 && job->keys) {
            one = own_before(job, slot, is_own != 0, block * ENG_WIDE, one);
        }
        round->box[kept] = box;
        round->lanes[kept] = both | one;
        kept += (both | one) != 0;
    }
    return kept;
}

#endif

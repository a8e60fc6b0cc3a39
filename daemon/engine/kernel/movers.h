/* daemon/engine/kernel/movers.h - leaves out boxes and pairs of which nothing moves.
 *
 * Room:     engine. May include: join.h, lanes.h.
 * Does:     leave what stands out of a round (join.h).
 * Threads:  [any]; inline only. Included by files of this folder alone.
 *
 * Boxes are left out where they are bits: one by one they would take a tenth of what
 * it is to compare them. Lanes are by a pass over the list, which is in the first cache.
 */
#ifndef ENG_MOVERS_H
#define ENG_MOVERS_H

#include "join.h"
#include "lanes.h"

/* Lanes of block `block` of b which with a box of a, `slot`, are pairs that move. */
ENG_INLINE uint32_t moving_lanes(const struct eng_join *job, uint32_t slot,
                                 uint32_t block)
{
    uint32_t moves = job->a_moving[slot / ENG_WIDE] >> slot % ENG_WIDE & 1;
    return (job->b_moving[block] | (0u - moves)) & 0xffff;
}

/* Of these boxes of block n of a those that have such pairs with block m of b. */
ENG_INLINE uint32_t keep_moving_boxes(struct eng_join *job, uint32_t boxes, uint32_t n,
                                      uint32_t m)
{
    uint32_t kept = job->b_moving[m] != 0 ? boxes : boxes & job->a_moving[n];
    job->still += (uint32_t)__builtin_popcount(boxes ^ kept);
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
        uint32_t moving =
            lanes & moving_lanes(job, round->first_a * ENG_WIDE + (box & 0xff),
                                 round->first_b + (box >> 8));
        still += (uint32_t)__builtin_popcount(lanes ^ moving);
        round->box[kept] = box;
        round->lanes[kept] = moving;
        kept += moving != 0;
    }
    job->still += still;
    return kept;
}

#endif

/* daemon/engine/kernel/movers.h - leaves out boxes and pairs of which nothing moves.
 *
 * Room:     engine. May include: join.h, lanes.h.
 * Does:     shorten the lists of a round (join.h) by what stands.
 * Threads:  [any]; inline only. Included by files of this folder alone.
 *
 * By passes of their own over the lists, which are in the first cache: so a step that
 * leaves nothing out pays for one branch a round.
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

/* Of the `count` boxes listed those that have such pairs: the others stand, and so does
 * all of the block. Without a branch on it, which could not be foreseen. */
ENG_INLINE uint32_t keep_moving_boxes(struct eng_join *job, struct eng_join_round *round,
                                      uint32_t count)
{
    uint32_t kept = 0;
    for (uint32_t i = 0; i < count; i++) {
        uint32_t place = round->place[i];
        uint32_t box = round->box[i];
        round->place[kept] = place;
        round->box[kept] = box;
        kept += moving_lanes(job, round->first_a * ENG_WIDE + (box & 0xff),
                             round->first_b + (box >> 8)) != 0;
    }
    job->still += count - kept;
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

/* moving.h - knows which vertices move in a step, so that what stands still costs
 * nothing.
 *
 * Threads: made by [compute]; inside a step the team reads it.
 *
 * A vertex *moves* in a step if, bit for bit, its x0 or x1 is not what it was in the step
 * before. So one that has just stopped still moves for one step: where it came to rest
 * was never tested as its start. A pair of features of which no vertex moves has the
 * record that it had, or none again. Something may be said to move that does not.
 */
#ifndef ENG_MOVING_H
#define ENG_MOVING_H

#include "world.h"

/* Compare the staged writes, which are in order and do not overlap, before they become
 * the scene's positions. O(objects + vertices written). Cannot fail. */
void eng_moving_commit(struct eng_scene *scene);

/* Make x[1 - now] of an object what x[now] is, before the step is committed. As long as
 * nothing was written there since the last step, that is a copy of what moved in it. */
void eng_moving_catch_up(struct eng_scene *scene, const struct eng_object *object);

/* Return whether so many of `all` vertices, or blocks of sixteen, move that what stands
 * is not worth looking for. With four fifths of the vertices moving it saves 8 % of a
 * step to none, by the scene; where an eighth stands, and meets nothing, it would take 7
 * % more. Spread evenly, a tenth of the vertices is in 81 % of the blocks, and there is
 * nothing to gain; a fifth, in 97 %, takes 9 % more. */
static inline bool eng_moves_much(uint64_t moving, uint64_t all)
{
    return 6 * moving > 5 * all;
}

/* Return whether so little moves that what stands is worth looking for. */
static inline bool eng_moves_little(const struct eng_scene *scene)
{
    return !scene->moving.is_spread &&
           !eng_moves_much(scene->moving.vertices, scene->moving.all);
}

/* Return whether objects turn, and nothing else moves, nor has in the step before. */
bool eng_moving_turns_alone(const struct eng_scene *scene);

/* Return how many vertices move, 2^32 - 1 if there are more: for the trace. */
static inline uint32_t eng_moving_count(const struct eng_scene *scene)
{
    return scene->moving.vertices < UINT32_MAX ? (uint32_t)scene->moving.vertices
                                               : UINT32_MAX;
}

#endif

/* wide_still.h - what moves in the trees of the method `wide`.
 *
 * Mark the features that move (moving.h) and fold the marks up the trees, so that boxes
 * of what stands are kept from the last step, and pairs of nodes of which neither moves
 * are left out.
 *
 * Threads: as marked.
 *
 * Block i of a level has a mask of 16 bits: bit k is set if something below its child k
 * moves. Those of vertices are set before the refit; those of edges and faces by whoever
 * makes the boxes of a chunk, from the vertices at their corners. A chunk of edges or
 * faces knows which chunks of vertices its corners lie in. Where none of these moves,
 * nothing is looked at.
 */
#ifndef ENG_WIDE_STILL_H
#define ENG_WIDE_STILL_H

#include "wide.h"

/* The positions have moved on: is what moves spread so evenly that too few blocks of
 * vertices stand (eng_moves_much)? [compute] */
bool eng_wide_still_is_spread(struct eng_wide *wide, const struct eng_scene *scene);

/* The positions have moved on and `keeps` says whether boxes of the last step are those
 * of what stands: mark what moves. `prunes`: marks are wanted without that, too.
 * [compute] */
void eng_wide_still_begin(struct eng_wide *wide, const struct eng_scene *scene,
                          bool keeps, bool prunes);

/* Before the boxes of a chunk: marks of its features; the chunk's nodes of level 1 after
 * them. False: nothing in it moves. [team] */
bool eng_wide_still_mark_chunk(struct eng_wide *wide, enum pccd_tree kind,
                               uint32_t chunk);

/* Marks of the levels from 2 on. [team], one thread */
void eng_wide_still_mark_above(struct eng_wide *wide);

/* Features whose boxes were kept. [compute] */
uint64_t eng_wide_still_count(const struct eng_wide *wide, const struct eng_scene *scene);

/* Does a feature move? */
static inline bool eng_wide_slot_moves(const struct eng_wide_tree *tree, uint32_t slot)
{
    return tree->moving[slot / ENG_WIDE] >> slot % ENG_WIDE & 1;
}

#endif

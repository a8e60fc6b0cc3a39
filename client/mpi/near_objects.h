/* near_objects.h - what is asked of objects two by two, over ranks: which of their
 * features are nearest, and how deep one is in the other.
 *
 * Threads: one.
 */
#ifndef RANKS_NEAR_OBJECTS_H
#define RANKS_NEAR_OBJECTS_H

#include "apart.h"

static inline bool ranks_near_is_by_objects(const struct pccd_near_settings *near)
{
    return near->what == PCCD_NEAR_NEAREST || near->what == PCCD_NEAR_DEPTH;
}

/* Collective: for where objects begin or end by object->from and object->to, to
 * world->records and *answer. Errors: those of pccd_ask_near. */
int ranks_near_of_objects(struct pccd_mpi *world, const struct pccd_near_settings *near,
                          struct pccd_answer *answer);

/* ---- for nearest.c and depth.c ----------------------------------------------------- */

/* A question and where everything is. */
struct ranks_pairing {
    struct pccd_mpi *world;
    const struct pccd_near_settings *near;
    double (**x)[3]; /* [object_count]: of local vertices */
};

/* Is it asked of these two, by their places? */
bool ranks_is_asked(const struct ranks_pairing *pairing, uint32_t a, uint32_t b);
bool ranks_is_asked_with_any(const struct ranks_pairing *pairing, uint32_t a);
/* Is `a` before `b` in the order of handles? */
static inline bool ranks_is_lower(const struct pccd_mpi *world, uint32_t a, uint32_t b)
{
    return world->objects[a]->handle < world->objects[b]->handle;
}
/* The question as it is asked of a part of the scene, with the time that is left. */
void ranks_ask_rest(const struct ranks_pairing *pairing, struct pccd_near_settings *near);
/* An own leaf with its corners. */
void ranks_visitor_make(const struct ranks_pairing *pairing, uint32_t object,
                        uint32_t leaf, struct ranks_visitor *visitor);

/* Collective: the answer is in *apart, each record on one rank: of DEPTH the one that
 * has its vertex. */
int ranks_nearest(const struct ranks_pairing *pairing, struct ranks_apart *apart);
int ranks_depth(const struct ranks_pairing *pairing, struct ranks_apart *apart);

#endif

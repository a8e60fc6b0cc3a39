/* registry_positions.h - remembers where the objects of a registry are.
 *
 * Follow the positions that steps bring, in one of two ways. libpccd wants the end of the
 * last step in as few bytes as possible (registry_place): a rigid body is 12 numbers,
 * floats stay floats. pccdctl looks at the steps of a recording and wants both ends of
 * the last one, in doubles (registry_follow, registry_begin_step, registry_move).
 *
 * Source: proto/PROTOCOL.md, "A step".
 */
#ifndef REGISTRY_POSITIONS_H
#define REGISTRY_POSITIONS_H

#include "registry_types.h"

/* Some vertices of an object, where a step brings them. Pointers need not be aligned. */
struct registry_motion {
    bool is_rigid;   /* start and end are double[12] and transform what is registered */
    uint32_t format; /* of start and end, if not */
    uint32_t first;  /* the vertices; within the mesh */
    uint32_t count;
    const void *start; /* NULL: where the last step has ended */
    const void *end;
};

/* Where vertex `v` of a mesh was registered. */
void registry_registered(const struct registry_mesh *mesh, uint32_t v, double x[3]);

/* The object stands where its mesh was registered, whatever steps before `step` said. 0,
 * or PCCD_E_NOMEM where both ends are followed. */
int registry_reset(struct registry_object *object, uint64_t step);

/* The first vertex that the motion, which is within the object, would take to where no
 * coordinates are, in the beginning or at the end; motion->first + count: none. */
uint32_t registry_first_stray(const struct registry_object *object,
                              const struct registry_motion *motion);

/* Only the end counts. 0 or PCCD_E_NOMEM: then it stays where it was. */
int registry_place(struct registry_object *object, const struct registry_motion *motion);

/* Follow both ends of an object's steps, from where its mesh was registered: x0, x1. 0 or
 * PCCD_E_NOMEM. */
int registry_follow(struct registry_object *object);
/* A step begins where the last one has ended, for all objects that are followed; then
 * some of them move. */
void registry_begin_step(struct registry_scene *scene);
void registry_move(struct registry_object *object, const struct registry_motion *motion);

void registry_free_positions(struct registry_object *object);

#endif

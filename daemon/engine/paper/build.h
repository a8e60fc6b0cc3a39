/* build.h - builds the tree of boxes over each object's triangles, and one tree over all
 * objects.
 *
 * Source: paper sections 6.2 (median partition) and 7 (merging the objects' hierarchies).
 */
#ifndef ENG_BUILD_H
#define ENG_BUILD_H

#include "trees.h"

/* Build the hierarchy of an object in its node range from the positions that the scene
 * stands at: links, counts and triangles; boxes are left to refit. PCCD_E_NOMEM. */
int eng_build_object(struct eng_scene *scene, uint32_t object_idx);

/* Give every object that has none its ranges of edges, triangles and nodes, its topology
 * there with global indices, and its hierarchy, as it stands. Scenes that are never
 * stepped by the method paper do without. PCCD_E_NOMEM, PCCD_E_LIMIT: some may have got
 * theirs; it can be tried again. */
int eng_plant_objects(struct eng_scene *scene);

/* Give back what eng_plant_objects took for an object, if it did. */
void eng_object_fell(struct eng_scene *scene, struct eng_object *object);

/* Make room in the arrays of binary hierarchies up to the end of each range allocator.
 * PCCD_E_NOMEM: can be tried again. */
int eng_tree_reserve(struct eng_scene *scene);

/* Build the tree over all objects from the boxes of their roots, and set trees->root.
 * Takes its nodes from the scene. PCCD_E_NOMEM, PCCD_E_LIMIT: the old tree stays, still
 * stale. */
int eng_build_top(struct eng_scene *scene);

/* Every parent precedes its children and contains them at both ends, counts add up, every
 * triangle of every object is in exactly one leaf. Test and debug builds. */
bool eng_tree_validate(const struct eng_scene *scene);

#endif

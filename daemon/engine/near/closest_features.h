/* daemon/engine/near/closest_features.h - from a pair that is near to the two features
 * between which its distance is.
 *
 * Room:     engine. May include: kernel.h, nearest.h, world.h.
 * Does:     name them as records do: a vertex and a face, two edges, a vertex and an
 *           edge, or two vertices; and say of these what is said of the pair.
 * Threads:  [team].
 *
 * Example: an edge that ends above a face is near the face. The distance is between the
 * edge's end and the face, so the vertex and the face are the closest features. Each
 * other edge that ends there leads to the same two.
 */
#ifndef ENG_CLOSEST_FEATURES_H
#define ENG_CLOSEST_FEATURES_H

#include "kernel.h"
#include "nearest.h"
#include "world.h"

/* The closest features of a pair of VF or EE whose distance is known, and theirs: a
 * function of their own points. all: the pair's, with the words of near_work.h. */
void eng_closest_features(const struct eng_scene *scene, const struct pccd_pair *pair,
                          const struct eng_point *const all[4],
                          const struct eng_distance *distance, struct pccd_pair *closest,
                          struct eng_distance *at);

#endif

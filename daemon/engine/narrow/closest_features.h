/* closest_features.h - from a pair that is near to the two features between which its
 * distance is.
 *
 * Example: an edge that ends above a face is near the face. The distance is between the
 * edge's end and the face, so the vertex and the face are the closest features. Each
 * other edge that ends there leads to the same two.
 */
#ifndef ENG_CLOSEST_FEATURES_H
#define ENG_CLOSEST_FEATURES_H

#include "batch.h"
#include "kernel.h"
#include "nearest.h"
#include "world.h"

/* Edges that were looked up, each at a place of its ends': most are asked for again soon.
 * All zeros: none. */
#define ENG_EDGES_KNOWN 4096u

struct eng_edges_known {
    struct eng_edge_known {
        const struct eng_mesh *mesh;
        uint32_t low_end;
        uint32_t high_end;
        uint32_t edge;
    } at[ENG_EDGES_KNOWN];
};

/* Of `count` pairs of VF or EE, at most ENG_CHUNK_MAX, whose distances are known: names
 * and distances become those of the closest features, functions of their own points.
 * quads[index[i]]: the points of pair i, with the words of narrow.h. */
void eng_closest_features(const struct eng_scene *scene, enum pccd_kind kind,
                          const struct eng_point *points, const uint32_t (*quads)[4],
                          const uint32_t *index, uint32_t count,
                          struct eng_edges_known *known, struct pccd_pair *names,
                          struct eng_distance *distances);

#endif

/* feature.h - derives the unique edges of a mesh, and assigns each vertex and edge to one
 * leaf, as a rule a triangle.
 *
 * Threads: one thread for one mesh.
 * Source: paper section 3.1; Curtis 2008 (representative triangles).
 */
#ifndef ENG_FEATURE_H
#define ENG_FEATURE_H

#include "topology.h"

/* Fill leaves, edges, what is free and the counts of `mesh` from corners and x. The owner
 * of a feature is the first leaf that has it. PCCD_E_NOMEM, PCCD_E_LIMIT:
 * nothing changed. */
int eng_feature_derive(struct eng_mesh *mesh);

/* Where the edges begin whose higher vertex is v: first[v], v = 0 .. vertex_count. Of a
 * mesh that was derived. */
void eng_feature_index(const struct eng_mesh *mesh, uint32_t *first);

/* The edge between two vertices that have one; ENG_NO_EDGE where they are the same. */
uint32_t eng_feature_edge(const struct eng_mesh *mesh, const uint32_t *first, uint32_t a,
                          uint32_t b);

/* A bit for each of `count` features, none of them set. NULL: no memory. */
uint64_t *eng_feature_new_bits(uint32_t count);

/* Every vertex in a leaf and every edge is owned exactly once, and by a leaf that has
 * it. O(counts); true when it cannot allocate what it needs. */
bool eng_feature_validate(const struct eng_mesh *mesh);

#endif

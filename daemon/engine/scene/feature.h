/* daemon/engine/scene/feature.h - unique edges and who owns which feature.
 *
 * Room:     engine. May include: topology.h.
 * Does:     derive, once per mesh, the unique edges and an owner triangle for every
 *           vertex and edge, so that each feature is tested through exactly one triangle.
 * Threads:  one thread for one mesh.
 * Source:   paper section 3.1; Curtis 2008 (representative triangles).
 */
#ifndef ENG_FEATURE_H
#define ENG_FEATURE_H

#include "topology.h"

/* Fill triangles, edges and the counts of `mesh` from corners and x. The owner of a
 * feature is the first triangle that has it. ENG_E_NOMEM, ENG_E_LIMIT:
 * nothing changed. */
int eng_feature_derive(struct eng_mesh *mesh);

/* Every vertex in a triangle and every edge is owned exactly once, and by a triangle that
 * has it. O(counts); true when it cannot allocate what it needs. */
bool eng_feature_validate(const struct eng_mesh *mesh);

#endif

/* daemon/engine/scene/topology.h - the fields of a mesh, for the files that fill, derive
 * or read it.
 *
 * Room:     engine. May include: box_frame.h, mesh.h.
 * Does:     define struct eng_mesh. It does not change after commit, so any thread may
 *           read it then.
 * Source:   paper section 3.1; Curtis 2008 (representative triangles).
 */
#ifndef ENG_TOPOLOGY_H
#define ENG_TOPOLOGY_H

#include <stdatomic.h>

#include "box_frame.h"
#include "mesh.h"

/* Ownership bits of a triangle: bit k: it owns corner k; bit 3 + k: it owns the edge from
 * corner k to corner (k + 1) mod 3. */
#define ENG_OWNS_VERTEX(k) (1u << (k))
#define ENG_OWNS_EDGE(k)   (8u << (k))

#define ENG_NO_EDGE UINT32_MAX /* a side between equal vertices is not an edge */

/* Of a mesh. Its edges are found by its corners (feature.h). */
struct eng_face {
    uint32_t v[3];
    uint32_t owns; /* ENG_OWNS_* */
};

struct eng_mesh {
    atomic_uint references;
    bool committed;
    uint32_t vertices_received; /* prefix that has arrived */
    uint32_t triangles_received;
    struct eng_mesh_info info;
    double (*x)[3];             /* [vertex_count] registered positions */
    uint32_t (*corners)[3];     /* [triangle_count] as received; NULL after commit */
    struct eng_face *triangles; /* [triangle_count] after commit */
    uint32_t (*edges)[2];       /* [edge_count] after commit, by (higher, lower) vertex */
    /* After commit, of the registered positions: around all triangles, and the size of a
     * typical triangle beside that. */
    struct eng_bounds bounds;
    double fineness;
};

/* The bounds of the mesh's triangles, with its vertices at x. Vertices that are in none
 * do not count. */
struct eng_bounds eng_mesh_measure(const struct eng_mesh *mesh, const double (*x)[3]);

#endif

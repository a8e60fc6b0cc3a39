/* closed.h - is a mesh closed, so that it has an inside?
 *
 * Count how often the faces of a mesh run through each edge, from the one end to the
 * other and back: it is closed if that is equal for every edge. By indices: where
 * vertices are does not matter. Found out once for a mesh.
 *
 * Threads: [any], of a committed mesh.
 */
#ifndef ENG_CLOSED_H
#define ENG_CLOSED_H

#include "topology.h"

struct eng_open_edge {
    uint32_t vertex[2];
    uint32_t runs[2]; /* from the first to the second, and back */
};

/* PCCD_OK: it is closed; PCCD_E_INVAL: *open is the first edge, by its number, that is
 * not run through equally often; PCCD_E_NOMEM. O(edges + faces) the first time. */
int eng_mesh_is_closed(struct eng_mesh *mesh, struct eng_open_edge *open);

#endif

/* rings.h - which vertices of a mesh few edges join. */
#ifndef ENG_RINGS_H
#define ENG_RINGS_H

#include <stdatomic.h>

#include "mesh.h"

/* Have the lists of n = `rings`, 0 .. ENG_RINGS_MAX, of a committed mesh; n = 0 needs
 * none. PCCD_E_LIMIT: they are long, more than 256 vertices on average; PCCD_E_NOMEM;
 * PCCD_E_CANCELLED, where *cancel (NULL: never) becomes true: whatever was made is given
 * away. All edges of what is in a list are looked at: where each vertex has thousands,
 * that takes long. [any] */
int eng_rings_prepare(struct eng_mesh *mesh, uint32_t rings, const atomic_bool *cancel);

/* Do at most `rings` edges join the two? The lists are there. [any] */
bool eng_rings_join(const struct eng_mesh *mesh, uint32_t rings, uint32_t v, uint32_t w);

/* The mesh goes. */
void eng_rings_deinit(struct eng_mesh *mesh);
uint64_t eng_rings_bytes(const struct eng_mesh *mesh);

#endif

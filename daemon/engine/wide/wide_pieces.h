/* wide_pieces.h - finds the separate pieces of a mesh: triangles that are connected by
 * shared vertices.
 *
 * Threads: [any]; no allocation.
 * Source: Tarjan 1975 (union-find); van Leeuwen, van der Weide 1977 (halving of paths).
 */
#ifndef ENG_WIDE_PIECES_H
#define ENG_WIDE_PIECES_H

#include "mesh.h"

#define ENG_WIDE_NO_PIECE UINT32_MAX

/* Of a committed mesh: of[vertex_count] gets the piece of every vertex, numbered by their
 * least vertices, ENG_WIDE_NO_PIECE if it is in no triangle. Returns how many there are.
 * O(vertices + triangles), nearly. */
uint32_t eng_wide_pieces_find(const struct eng_mesh *mesh, uint32_t *of);

#endif

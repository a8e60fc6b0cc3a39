/* mesh.h - a mesh as it was registered: triangles, edges, points and first positions,
 * which never change.
 *
 * Take vertices, triangles, and edges and points by themselves in chunks, check them,
 * derive the unique edges and the ownership of features once. A mesh cannot be changed
 * after its commit.
 *
 * Threads: a mesh is used by one thread at a time until commit; afterwards by any.
 * Source: paper section 3.1 (representative triangles, Curtis 2008).
 *
 * Edges and points are *named* by themselves, those of rods and of clouds. A named edge
 * that a triangle has is just that one; any other is *free*. One whose ends are the same
 * names a point. A named point that a triangle or an edge has is a vertex of it: whatever
 * comes near it comes near that triangle or edge. Any other is a *free* point. A vertex
 * that nothing has is isolated, and not tested.
 */
#ifndef ENG_MESH_H
#define ENG_MESH_H

#include <stdbool.h>
#include <stdint.h>

#include "pccd_types.h"
#include "proto_limits.h"

/* Edges that may join what an object leaves thin (scene.h). */
#define ENG_RINGS_MAX 8u

struct eng_mesh;

struct eng_mesh_info {
    uint32_t vertex_count;
    uint32_t triangle_count;
    uint32_t edge_count;       /* unique unordered pairs of distinct vertices */
    uint32_t duplicate_count;  /* triangles whose vertex set occurred before */
    uint32_t degenerate_count; /* repeated vertex, or exactly zero area as registered */
    uint32_t isolated_count;   /* vertices that nothing has */
    uint32_t free_edge_count;
    uint32_t free_point_count;
};

/* The counts of what is named in a mesh; edges and points: by themselves. */
struct eng_mesh_counts {
    uint32_t vertices;
    uint32_t triangles;
    uint32_t edges;
    uint32_t points;
};

/* Make a mesh to be filled. Vertices, and all that is named together: 1 ..
 * PROTO_COUNT_MAX, else PCCD_E_INVAL. Allocates all that the data needs; PCCD_E_NOMEM
 * leaves nothing behind. The caller holds one reference. */
int eng_mesh_make(const struct eng_mesh_counts *counts, struct eng_mesh **mesh);
/* Make a mesh of triangles alone. */
int eng_mesh_new(uint32_t vertex_count, uint32_t triangle_count, struct eng_mesh **mesh);

/* Add a reference to the mesh, which is returned. [any] */
struct eng_mesh *eng_mesh_acquire(struct eng_mesh *mesh);
/* Drop a reference; the last one frees the mesh. NULL is allowed. [any] */
void eng_mesh_release(struct eng_mesh *mesh);

/* Copy a chunk in and check the copy. `source` may be memory another process writes: each
 * byte is read once. A failing chunk leaves the mesh as it was or with part of the chunk
 * written; it can be sent again. Chunks may come in any order and overlap; commit
 * requires that first+count calls covered everything (tracked as a prefix: chunks must be
 * contiguous, each starting at or before the end of what has arrived).
 * Errors: PCCD_E_INVAL (range), PCCD_E_STATE (committed, a gap), PCCD_E_NOTFINITE. */
int eng_mesh_write_vertices(struct eng_mesh *mesh, enum pccd_format format,
                            uint32_t first, uint32_t count, const void *source);
/* Copy triangles in, in the same way: uint32_t[3], whose indices are checked:
 * PCCD_E_INDEX, *bad_triangle set. */
int eng_mesh_write_triangles(struct eng_mesh *mesh, uint32_t first, uint32_t count,
                             const void *source, uint32_t *bad_triangle);
/* Copy named edges, uint32_t[2], and points, uint32_t, in; otherwise as triangles. */
int eng_mesh_write_edges(struct eng_mesh *mesh, uint32_t first, uint32_t count,
                         const void *source, uint32_t *bad_edge);
int eng_mesh_write_points(struct eng_mesh *mesh, uint32_t first, uint32_t count,
                          const void *source, uint32_t *bad_point);

/* Set radii of vertices, for objects that have none of their own (scene.h): any ranges,
 * before the commit; what is not written is 0. A feature has the largest of its vertices.
 * Each number of `source` is read once. PCCD_E_INVAL (range; one that is negative or not
 * finite), PCCD_E_LIMIT (one beyond 1e18), PCCD_E_STATE (committed), PCCD_E_NOMEM: part
 * of the chunk may be written. */
int eng_mesh_write_radii(struct eng_mesh *mesh, uint32_t first, uint32_t count,
                         const double *source);

/* Write the counts of what has arrived so far. */
void eng_mesh_received(const struct eng_mesh *mesh, struct eng_mesh_counts *received);

/* Derive edges, ownership and counts, by so many threads (0: one; only some of it is
 * shared out). PCCD_E_STATE: data missing or committed already; PCCD_E_LIMIT: more than
 * PROTO_COUNT_MAX edges; PCCD_E_NOMEM: can be tried again. */
int eng_mesh_commit(struct eng_mesh *mesh, uint32_t threads);
bool eng_mesh_is_committed(const struct eng_mesh *mesh);

/* Set what is a committed mesh's own, once, before its first step: a bit for each vertex
 * and each edge that is. All others are *foreign*: pairs of which they are the first
 * feature are left out, because somebody else looks for them. So bounds of vertices are
 * INFINITY where no pair is known; depth is that of own vertices, with the own edges that
 * pass through faces, and the mesh counts as a part of a closed one. NEAREST knows
 * nothing of it. PCCD_E_STATE: not committed, or done already; PCCD_E_NOMEM. */
int eng_mesh_set_own(struct eng_mesh *mesh, const uint64_t *vertices,
                     const uint64_t *edges);

/* Describe a committed mesh. */
void eng_mesh_get_info(const struct eng_mesh *mesh, struct eng_mesh_info *info);

/* Return the unique edges uint32_t[edge_count][2], lower index first, sorted by (higher,
 * lower): the numbering of public ground-truth data. */
const uint32_t (*eng_mesh_edges(const struct eng_mesh *mesh))[2];

/* Return the registered positions [vertex_count], exactly as they came. */
const double (*eng_mesh_vertices(const struct eng_mesh *mesh))[3];
/* Return the radii of vertices [vertex_count]; NULL: there are none. */
const double *eng_mesh_radii(const struct eng_mesh *mesh);
/* Write the corners of all triangles of a committed mesh to corners[triangle_count]. */
void eng_mesh_get_corners(const struct eng_mesh *mesh, uint32_t (*corners)[3]);
/* Write the free edges to ends[free_edge_count], and the free points to
 * points[free_point_count]. */
void eng_mesh_get_free(const struct eng_mesh *mesh, uint32_t (*ends)[2],
                       uint32_t *points);

/* Return the bytes held. */
uint64_t eng_mesh_bytes(const struct eng_mesh *mesh);

#endif

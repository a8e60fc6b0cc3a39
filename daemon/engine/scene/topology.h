/* topology.h - the fields of a mesh, for the files that fill, derive or read it.
 *
 * Source: paper section 3.1; Curtis 2008 (representative triangles).
 */
#ifndef ENG_TOPOLOGY_H
#define ENG_TOPOLOGY_H

#include <stdatomic.h>
#include <stddef.h>

#include "box_frame.h"
#include "mesh.h"
#include "pccd_trace.h"

/* Ownership bits of a leaf: bit k: it owns corner k; bit 3 + k: it owns the edge from
 * corner k to corner (k + 1) mod 3; bit 6: it is a face. */
#define ENG_OWNS_VERTEX(k) (1u << (k))
#define ENG_OWNS_EDGE(k)   (8u << (k))
#define ENG_OWNS_FACE      64u

#define ENG_NO_EDGE UINT32_MAX /* a side between equal vertices is not an edge */

/* A leaf that features of a mesh are tested through: each of its triangles, then each
 * free edge, whose last two corners are the same, then each free point, whose corners
 * are. Edges of a leaf are found by its corners (topology.h). */
struct eng_face {
    uint32_t v[3];
    uint32_t owns; /* ENG_OWNS_* */
};

struct eng_body_builder;
struct eng_body_tree;

enum eng_clearance_state {
    ENG_CLEARANCE_UNKNOWN, /* nobody is at it */
    ENG_CLEARANCE_TAKEN,   /* a thread is */
    ENG_CLEARANCE_KNOWN
};

/* Which features of a mesh are crowded (wide_crowded.h). All but the state belongs to
 * whoever has taken it, and does not change any more once it is known. */
struct eng_clearance {
    atomic_int state; /* enum eng_clearance_state */
    double length;    /* the clearance; 0: of no use, too much is crowded */
    /* By enum pccd_tree a bit for each vertex, edge and face; NULL: none is crowded. */
    uint64_t *crowded[PCCD_TREE_FACES + 1];
    uint64_t crowded_count;
    uint64_t work; /* so far */
    struct eng_wide_crowded *search;
};

/* A tree that is being made (body_tree.h): two blocks of memory, of whoever has taken it.
 * NULL: they are not there. */
struct eng_body_build {
    atomic_bool is_taken;
    struct eng_body_builder *builder;
    struct eng_body_tree *tree;
};

struct eng_rings; /* topology.h */
struct eng_stars; /* topology.h */
struct eng_account;
struct eng_wide_order;
struct eng_wide_crowded;

struct eng_mesh {
    atomic_uint references;
    bool committed;
    struct eng_mesh_counts counts;
    struct eng_mesh_counts received; /* prefixes that have arrived */
    struct eng_mesh_info info;
    double (*x)[3]; /* [vertex_count] registered positions */
    /* [all that is named] as received: triangles, then edges and points, whose last
     * vertex is repeated; NULL after commit. */
    uint32_t (*corners)[3];
    struct eng_face *leaves; /* [leaf_count] after commit */
    uint32_t leaf_count;
    uint32_t (*edges)[2]; /* [edge_count] after commit, by (higher, lower) vertex */
    /* By enum pccd_tree a bit for each vertex and each edge that is free; NULL: none. */
    uint64_t *free[PCCD_TREE_EDGES + 1];
    /* Those that are not foreign (mesh.h); NULL: none is. */
    uint64_t *own[PCCD_TREE_EDGES + 1];
    /* After commit, of the registered positions: around all leaves; no corner of them is
     * farther than `radius` from the middle of that; and the size of a typical one
     * beside it. */
    struct eng_bounds bounds;
    double radius;
    double fineness;
    /* Thickness (thickness.h): radii of vertices; after commit also the largest radius of
     * the features that a vertex is of, by which its box grows, and the largest of all.
     * NULL, 0: there are none. */
    double *radii;
    double *reach;
    double radius_max;
    /* Whoever made the mesh is charged for what is found out of it later, too, perhaps in
     * another one's scene; NULL: nobody. */
    struct eng_account *account;
    _Atomic(struct eng_rings *) rings[ENG_RINGS_MAX]; /* [n - 1], those that were asked */
    _Atomic(struct eng_stars *) stars; /* NULL: nobody has asked */
    struct eng_clearance clearance; /* which is found out after commit, if at all */
    /* Of the method wide: the order of the features at the registered positions, which
     * objects share until they need another (wide.h); `order_bytes` of eng_alloc. NULL:
     * there is none. */
    struct eng_wide_order *order;
    uint64_t order_bytes;
    /* Of bodies that turn (body_tree.h): one block of memory. NULL: it is not there. */
    _Atomic(struct eng_body_tree *) body_tree;
    struct eng_body_build body_build;
    atomic_uint_fast64_t body_tree_bytes; /* of what is there of it */
    atomic_uint closed; /* a state of feature.c; 0: it is not known */
};

/* Check that a radius may be set: PCCD_E_INVAL (negative or not finite), PCCD_E_LIMIT
 * (beyond 1e18). */
int eng_mesh_check_radius(double radius);

/* Return the bounds of the mesh's leaves, with its vertices at x. Vertices that are in
 * none do not count. */
struct eng_bounds eng_mesh_measure(const struct eng_mesh *mesh, const double (*x)[3]);

/* Set the middle of the bounds of its leaves. */
static inline void eng_mesh_middle(const struct eng_mesh *mesh, double middle[3])
{
    for (int k = 0; k < 3; k++) {
        middle[k] = 0.5 * mesh->bounds.low[k] + 0.5 * mesh->bounds.high[k];
    }
}

static inline bool eng_mesh_has_bit(const uint64_t *bits, uint32_t feature)
{
    return (bits[feature / 64] >> feature % 64 & 1u) != 0;
}

static inline void eng_mesh_set_bit(uint64_t *bits, uint32_t feature)
{
    bits[feature / 64] |= 1ull << feature % 64;
}

/* Return whether a vertex, or an edge, is free. */
static inline bool eng_mesh_is_free(const struct eng_mesh *mesh, enum pccd_tree tree,
                                    uint32_t feature)
{
    const uint64_t *bits = tree <= PCCD_TREE_EDGES ? mesh->free[tree] : NULL;
    return bits && eng_mesh_has_bit(bits, feature);
}

/* Return whether a vertex or an edge is foreign. Of a face it does not matter: it is
 * first in no pair. */
static inline bool eng_mesh_is_foreign(const struct eng_mesh *mesh, enum pccd_tree tree,
                                       uint32_t feature)
{
    const uint64_t *bits = tree <= PCCD_TREE_EDGES ? mesh->own[tree] : NULL;
    return bits && !eng_mesh_has_bit(bits, feature);
}

static inline bool eng_mesh_has_foreign(const struct eng_mesh *mesh)
{
    return mesh->own[PCCD_TREE_VERTICES] != NULL;
}

/* Return whether it is known which features are crowded. What is said then stays so.
 * [any] */
static inline bool eng_mesh_knows_clearance(const struct eng_mesh *mesh)
{
    return atomic_load_explicit(&mesh->clearance.state, memory_order_acquire) ==
           ENG_CLEARANCE_KNOWN;
}

/* Return the clearance; 0: not known yet, or of no use. [any] */
static inline double eng_mesh_clearance(const struct eng_mesh *mesh)
{
    return eng_mesh_knows_clearance(mesh) ? mesh->clearance.length : 0;
}

/* Return whether a feature is crowded, once the clearance is known. [any] */
static inline bool eng_mesh_is_crowded(const struct eng_mesh *mesh, enum pccd_tree tree,
                                       uint32_t feature)
{
    const uint64_t *bits = mesh->clearance.crowded[tree];
    return bits && eng_mesh_has_bit(bits, feature);
}

/* ---- edges, and who owns what ------------------------------------------------------ */

/* Fill leaves, edges, what is free and the counts of `mesh` from corners and x, by
 * `threads` (0: one). The owner of a feature is the first leaf that has it. PCCD_E_NOMEM,
 * PCCD_E_LIMIT: nothing changed. */
int eng_feature_derive(struct eng_mesh *mesh, uint32_t threads);

/* Write where the edges begin whose higher vertex is v: first[v], v = 0 .. vertex_count.
 * Of a mesh that was derived. */
void eng_feature_index(const struct eng_mesh *mesh, uint32_t *first);

/* Return the edge between two vertices that have one; ENG_NO_EDGE where they are the
 * same. */
uint32_t eng_feature_edge(const struct eng_mesh *mesh, const uint32_t *first, uint32_t a,
                          uint32_t b);

/* Return the edge between two vertices that have one, whichever is given first, without
 * knowing where a vertex's begin. O(log edges) */
uint32_t eng_mesh_edge(const struct eng_mesh *mesh, uint32_t a, uint32_t b);

/* Allocate a bit for each of `count` features, none of them set. NULL: no memory. */
uint64_t *eng_feature_new_bits(uint32_t count);

/* Return whether every vertex in a leaf and every edge is owned exactly once, and by a
 * leaf that has it. O(counts); true when it cannot allocate what it needs. */
bool eng_feature_validate(const struct eng_mesh *mesh);

/* ---- is a mesh closed, so that it has an inside? ----------------------------------- */

struct eng_open_edge {
    uint32_t vertex[2];
    uint32_t runs[2]; /* from the first to the second, and back */
};

/* Find out whether a mesh is closed. PCCD_OK: it is; PCCD_E_INVAL: *open is the first
 * edge, by its number, that is not run through equally often; PCCD_E_NOMEM. O(edges +
 * faces) the first time. */
int eng_mesh_is_closed(struct eng_mesh *mesh, struct eng_open_edge *open);

/* ---- which vertices few edges join ------------------------------------------------- */

/* Have the lists of n = `rings`, 0 .. ENG_RINGS_MAX, of a committed mesh; n = 0 needs
 * none. PCCD_E_LIMIT: they are long, more than 256 vertices on average; PCCD_E_NOMEM;
 * PCCD_E_CANCELLED, where *cancel (NULL: never) becomes true: whatever was made is given
 * away. All edges of what is in a list are looked at: where each vertex has thousands,
 * that takes long. [any] */
int eng_rings_prepare(struct eng_mesh *mesh, uint32_t rings, const atomic_bool *cancel);

/* Return whether at most `rings` edges join the two. The lists are there. [any] */
bool eng_rings_join(const struct eng_mesh *mesh, uint32_t rings, uint32_t v, uint32_t w);

/* Free the lists of a mesh that goes. */
void eng_rings_deinit(struct eng_mesh *mesh);
uint64_t eng_rings_bytes(const struct eng_mesh *mesh);

/* ---- the leaves around a vertex ---------------------------------------------------- */

/* Have the lists of a committed mesh. PCCD_E_NOMEM. O(leaves) the first time. [any] */
int eng_stars_prepare(struct eng_mesh *mesh);

/* Return the leaves, by index and in order, that have the vertex. The lists are there.
 * [any] */
const uint32_t *eng_stars_of(const struct eng_mesh *mesh, uint32_t v, uint64_t *count);

/* Free the lists of a mesh that goes. */
void eng_stars_deinit(struct eng_mesh *mesh);
uint64_t eng_stars_bytes(const struct eng_mesh *mesh);

#endif

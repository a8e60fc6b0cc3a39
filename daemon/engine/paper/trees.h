/* trees.h - the binary trees of boxes over the triangles of a scene.
 *
 * Threads: [compute]; inside a step the team reads it, and writes only boxes of its own.
 *
 * The vertices of all objects lie in one array, as do edges, triangles and nodes; an
 * object owns one range of each. Indices into these arrays ("global") name features. So
 * one traversal covers every collision between objects and within them, and an object
 * comes or goes without touching the others.
 */
#ifndef ENG_TREES_H
#define ENG_TREES_H

#include <assert.h>
#include <stdatomic.h>
#include <stddef.h>

#include "aabb.h"
#include "sort.h"
#include "world.h"

#define ENG_LEAF    UINT32_MAX /* in eng_node.left */
#define ENG_NO_NODE UINT32_MAX /* root of an empty scene */

/* Says if a node's children may be looked at at once (rebuild.h). */
enum eng_gate { ENG_GATE_NONE = 0, ENG_GATE_REGION = 1 };

/* The three records with a box. Each is a struct eng_box with named words. */
struct eng_node {
    _Alignas(64) float lo0[3];
    uint32_t left; /* node, or ENG_LEAF */
    float hi0[3];
    uint32_t right; /* node; of a leaf: its triangle */
    float lo1[3];
    uint32_t count; /* triangles below */
    float hi1[3];
    uint8_t gate;    /* enum eng_gate */
    uint8_t foreign; /* no feature below it is first in a pair that is looked for; 0: it
                      * may be */
    uint16_t reserved;
};

struct eng_edge {
    _Alignas(64) float lo0[3];
    uint32_t a; /* vertices */
    float hi0[3];
    uint32_t b;
    float lo1[3];
    uint32_t object;
    float hi1[3];
    uint32_t reserved;
};

struct eng_vertex {
    _Alignas(64) float lo0[3];
    uint32_t object;
    float hi0[3];
    uint32_t reserved0;
    float lo1[3];
    uint32_t reserved1;
    float hi1[3];
    uint32_t reserved2;
};

static_assert(sizeof(struct eng_node) == 64 && offsetof(struct eng_node, left) == 12,
              "node");
static_assert(sizeof(struct eng_edge) == 64 && offsetof(struct eng_edge, a) == 12, "");
static_assert(sizeof(struct eng_vertex) == 64 &&
                  offsetof(struct eng_vertex, object) == 12,
              "vertex");

static inline struct eng_box *eng_box_of(void *record)
{
    return record;
}

static inline const struct eng_box *eng_box_of_const(const void *record)
{
    return record;
}

/* The knowledge of reconstruction about a node, beside the nodes: a traversal does not
 * need it. */
struct eng_upkeep {
    atomic_uint gate;  /* of a region's root: rebuild.h */
    uint32_t object;   /* index; ENG_NO_OBJECT: above them */
    float built_ratio; /* of an inner node: the metric when it was last built */
};

#define ENG_OWNS_BITS         127u
#define ENG_FOREIGN_VERTEX(k) (128u << (k))
#define ENG_FOREIGN_EDGE(k)   (1024u << (k))

/* A leaf of a mesh: a triangle, a free edge or a free point (topology.h). */
struct eng_triangle {
    uint32_t v[3];
    uint32_t e[3];   /* edge from v[k] to v[(k+1)%3], or ENG_NO_EDGE */
    uint32_t owns;   /* ENG_OWNS_*, and ENG_FOREIGN_* of what is foreign (mesh.h) */
    uint32_t object; /* index */
};

/* Levels of a scene's tree, at most. Medians give an object of n triangles ceil(log2 n)
 * levels; k objects have ceil(log2 k) above them. With n + k <= 2^31 the sum is largest
 * for n = k = 2^30. */
#define ENG_LEVELS_MAX (30u + 30u)

/* The part of an object in the arrays below. Counts are 0 until a step asks for it. */
struct eng_paper_object {
    struct eng_range edges;
    struct eng_range triangles;
    struct eng_range
        nodes; /* in pre-order, a parent precedes its children; first = root */
};

struct eng_trees {
    struct eng_ranges edge_ranges;
    struct eng_ranges triangle_ranges;
    struct eng_ranges node_ranges;
    uint32_t box_capacity; /* of the vertices' boxes */
    uint32_t edge_capacity;
    uint32_t triangle_capacity;
    uint32_t node_capacity;
    struct eng_vertex *vertices; /* by the scene's indices */
    struct eng_edge *edges;
    struct eng_triangle *triangles; /* global indices, .object filled in */
    struct eng_node *nodes;
    struct eng_upkeep *upkeep; /* [node_capacity] */

    /* The tree over the objects. */
    struct eng_range top; /* nodes above the objects, pre-order; count 0: none */
    uint32_t root;        /* ENG_NO_NODE: no objects */
    bool top_is_stale;    /* objects came or went since it was built */
    bool top_is_fresh;    /* built since the last step */
    uint64_t frames;      /* framing.number of the last step by `paper` */
    uint64_t thickness;   /* thickness.number in that step */
    uint64_t boxes_of;    /* the step whose boxes they are (moving.h); 0: of none */
    bool boxes_are_old; /* that step had to end before they were made: some are older */
    bool has_foreign;     /* some objects have foreign features */

    struct eng_split_item *top_items; /* [top_item_capacity] scratch to build it */
    uint32_t top_item_capacity;
};

/* Return the trees of a scene, which begin what is in its slot (paper.h). */
static inline struct eng_trees *eng_trees_of(const struct eng_scene *scene)
{
    return scene->slots[ENG_SLOT_PAPER];
}

static inline const struct eng_paper_object *
eng_paper_object_of(const struct eng_object *object)
{
    static const struct eng_paper_object nothing;
    const struct eng_paper_object *planted = object->slots[ENG_SLOT_PAPER];
    return planted ? planted : &nothing;
}

/* Return whether it is a node of the tree over the objects. */
static inline bool eng_is_above_objects(const struct eng_scene *scene, uint32_t node_idx)
{
    const struct eng_trees *trees = eng_trees_of(scene);
    return node_idx - trees->top.first < trees->top.count;
}

/* Return all nodes of the subtree of a node that belongs to an object: consecutive ones,
 * in pre-order, 2 n - 1 of n triangles. */
static inline struct eng_range eng_subtree_in_object(const struct eng_scene *scene,
                                                     uint32_t root)
{
    const struct eng_trees *trees = eng_trees_of(scene);
    return (struct eng_range){root, 2 * trees->nodes[root].count - 1};
}

/* Return the nodes above objects in the subtree of one of them: consecutive, too. */
struct eng_range eng_subtree_above_objects(const struct eng_scene *scene, uint32_t root);

/* Return whether `node` is in the subtree of `root`, or `root` itself. O(objects below
 * root). */
bool eng_node_is_below(const struct eng_scene *scene, uint32_t root, uint32_t node);

void eng_trees_init(struct eng_trees *trees);
void eng_trees_deinit(struct eng_trees *trees);
uint64_t eng_trees_bytes(const struct eng_trees *trees);

/* ---- features ---------------------------------------------------------------------- */

/* For functions of a vertex (1 point), an edge (2) or a face (3): the number of points is
 * a constant in the calling code, so no branch is left. */
#define ENG_FEATURE_INLINE static inline __attribute__((always_inline))

/* Write the vertices of a feature to v[points]; `feature`: its index among the scene's of
 * its sort. */
ENG_FEATURE_INLINE void eng_feature_vertices(const struct eng_trees *trees,
                                             uint32_t points, uint32_t feature,
                                             uint32_t *v)
{
    if (points == 1) {
        v[0] = feature;
    } else if (points == 2) {
        v[0] = trees->edges[feature].a;
        v[1] = trees->edges[feature].b;
    } else {
        v[0] = trees->triangles[feature].v[0];
        v[1] = trees->triangles[feature].v[1];
        v[2] = trees->triangles[feature].v[2];
    }
}

/* Return the index of a feature's object. */
ENG_FEATURE_INLINE uint32_t eng_feature_object(const struct eng_trees *trees,
                                               uint32_t points, uint32_t feature)
{
    return points == 1   ? trees->vertices[feature].object
           : points == 2 ? trees->edges[feature].object
                         : trees->triangles[feature].object;
}

/* Return the index of the first feature of that sort that an object has. */
ENG_FEATURE_INLINE uint32_t eng_feature_first(const struct eng_object *object,
                                              uint32_t points)
{
    return points == 1   ? object->vertices.first
           : points == 2 ? eng_paper_object_of(object)->edges.first
                         : eng_paper_object_of(object)->triangles.first;
}

/* ---- building them ----------------------------------------------------------------- */

/* Build the hierarchy of an object in its node range from the positions that the scene
 * stands at: links, counts and triangles; boxes are left to refit. PCCD_E_NOMEM. */
int eng_build_object(struct eng_scene *scene, uint32_t object_idx);

/* Give every object that has none its ranges of edges, triangles and nodes, its topology
 * there with global indices, and its hierarchy, as it stands. Scenes that are never
 * stepped by the method paper do without. PCCD_E_NOMEM, PCCD_E_LIMIT: some may have got
 * theirs; it can be tried again. */
int eng_paper_add_objects(struct eng_scene *scene);

/* Give back what eng_paper_add_objects took for an object, if it did. */
void eng_paper_drop_object(struct eng_scene *scene, struct eng_object *object);

/* Build the tree over all objects from the boxes of their roots, and set trees->root.
 * Takes its nodes from the scene. PCCD_E_NOMEM, PCCD_E_LIMIT: the old tree stays, still
 * stale. */
int eng_build_top(struct eng_scene *scene);

/* Return whether the nodes' boxes are those of the scene's last motion. They are not
 * after a step in which whatever moves turns. */
bool eng_tree_has_boxes(const struct eng_scene *scene);

/* Return whether every parent precedes its children and, if their boxes are of the last
 * motion, contains them at both ends, counts add up, and every triangle of every object
 * is in exactly one leaf. Test and debug builds. */
bool eng_tree_validate(const struct eng_scene *scene);

#endif

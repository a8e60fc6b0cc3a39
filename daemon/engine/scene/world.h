/* daemon/engine/scene/world.h - the inside of a scene: flat arrays over all its objects.
 *
 * Room:     engine. May include: aabb.h, frames.h, ingest.h, masks.h, median.h, range.h,
 *           scene.h, topology.h, wide.h.
 * Does:     show struct eng_scene to the phases of a step: build, merge, refit,
 *           traversal, filter, solver, results.
 * Threads:  [compute]; inside a step the team reads it, and writes only boxes of its own.
 *
 * Vertices, edges, triangles and nodes of all objects live in one array each; an object
 * owns one range of each. Indices into these arrays ("global") name features inside the
 * engine; records carry object id and local index. So one traversal covers every inter-
 * and self-collision, and an object comes or goes without touching the others.
 */
#ifndef ENG_WORLD_H
#define ENG_WORLD_H

#include <stdatomic.h>

#include "aabb.h"
#include "frames.h"
#include "ingest.h"
#include "masks.h"
#include "median.h"
#include "range.h"
#include "scene.h"
#include "topology.h"
#include "wide.h"

#define ENG_LEAF      UINT32_MAX /* in eng_node.left */
#define ENG_NO_NODE   UINT32_MAX /* root of an empty scene */
#define ENG_NO_OBJECT UINT32_MAX

/* Whether a node's children may be looked at without further ado (rebuild.h). */
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
    uint32_t gate; /* enum eng_gate */
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

/* What reconstruction knows of a node, beside the nodes: a traversal does not need it. */
struct eng_upkeep {
    atomic_uint gate;  /* of a region's root: rebuild.h */
    uint32_t object;   /* index; ENG_NO_OBJECT: above them */
    float built_ratio; /* of an inner node: the metric when it was last built */
};

struct eng_object {
    struct eng_mesh *mesh; /* NULL: this index is free */
    uint32_t id;           /* what records carry */
    struct eng_range vertices;
    struct eng_wide_order *order; /* of its features in the trees of the method wide */
    /* Its binary hierarchy, of the method paper: count 0 until a step asks for it. Nodes
     * are in pre-order, a parent precedes its children; first = root. */
    struct eng_range edges;
    struct eng_range triangles;
    struct eng_range nodes;
    struct eng_bounds bounds[2]; /* of its triangles, in x[0] and in x[1] */
    struct eng_frame frame;      /* of its boxes; not in use while framing.number is 0 */
    bool still;      /* x[0] and x[1] hold the same positions of this object */
    uint64_t staged; /* stage number that last wrote to it */
};

/* What an object was before a replacement that is not settled. */
struct eng_replaced {
    uint32_t object;
    struct eng_object before;
};

struct eng_write;       /* stage.h: a range written by the step being staged */
struct eng_step_memory; /* step.c: what one step leaves for the next */

struct eng_scene {
    struct eng_scene_settings settings;
    struct eng_object *objects;
    uint32_t object_capacity; /* indices 0 .. capacity-1; free ones have mesh = NULL */
    uint32_t object_count;
    uint64_t triangle_count;       /* of all objects */
    struct eng_replaced *replaced; /* not settled yet */
    uint32_t replaced_count, replaced_capacity;

    struct eng_ranges vertex_ranges;
    struct eng_ranges edge_ranges;
    struct eng_ranges triangle_ranges;
    struct eng_ranges node_ranges;
    uint32_t vertex_capacity; /* of positions */
    uint32_t box_capacity;    /* of the vertices' boxes */
    uint32_t edge_capacity, triangle_capacity, node_capacity;

    /* x[now] holds the positions that the scene stands at. A step writes its end
     * positions to x[1 - now] and then flips `now`; during and after the step, x[1 - now]
     * is t = 0 and x[now] is t = 1. */
    double (*x[2])[3];
    unsigned now;
    double (*start)[3]; /* x0 of the step being staged, where given */
    uint32_t start_capacity;

    /* Of the method paper (tree/object.c). */
    struct eng_vertex *vertices;
    struct eng_edge *edges;
    struct eng_triangle *triangles; /* global indices, .object filled in */
    struct eng_node *nodes;
    struct eng_upkeep *upkeep; /* [node_capacity] */

    /* The tree over the objects. */
    struct eng_range top; /* nodes above the objects, pre-order; count 0: none */
    uint32_t root;        /* ENG_NO_NODE: no objects */
    bool top_is_stale;    /* objects came or went since it was built */
    bool top_is_fresh;    /* built since the last step */
    uint64_t tree_frames; /* framing.number of the last step by `paper` */
    struct eng_split_item *top_items; /* [top_item_capacity] scratch to build it */
    uint32_t top_item_capacity;
    uint32_t step; /* number of the step; goes round */

    struct eng_framing framing;
    struct eng_wide wide; /* the trees of the method wide */
    struct eng_masks masks;

    /* Staging. */
    bool staging, is_owed; /* owed: the last step has moved it, and given up */
    uint64_t stage;
    uint64_t stage_ns;
    struct eng_copiers copiers; /* of its writes */
    struct eng_write *writes;   /* [write_capacity] */
    uint32_t write_count, write_capacity;

    struct eng_step_memory *memory;
    uint64_t builds; /* hierarchies built since the scene was made */
};

/* Is it a node of the tree over the objects? */
static inline bool eng_is_above_objects(const struct eng_scene *scene, uint32_t node_idx)
{
    return node_idx - scene->top.first < scene->top.count;
}

/* The object that staged or stands at `object_idx`, or NULL. */
struct eng_object *eng_scene_object(const struct eng_scene *scene, uint32_t object_idx);

/* A capacity for `end` items: grown by an eighth, which is what may lie idle, so that
 * adding objects one by one copies each array a logarithmic number of times. */
uint32_t eng_world_grown(uint32_t capacity, uint32_t end);

/* Grow one array of items of `bytes`; `array` is the address of the pointer to it, which
 * is unchanged on failure (ENG_E_NOMEM). */
int eng_world_grow(void *array, uint32_t capacity, size_t bytes);

/* Make room for the positions up to the end of the vertex ranges. ENG_E_NOMEM:
 * unchanged. */
int eng_world_reserve(struct eng_scene *scene);

#endif

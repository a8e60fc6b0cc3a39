/* client/ctl/mesh/gltf_node.h - the nodes of a glTF file, and where they are.
 *
 * Room:     client/ctl. May include: gltf_file.h.
 * Does:     read the trees of nodes, tell which a scene shows, and place each in doubles
 *           by its translation, rotation and scale, or its matrix, and its parents.
 * Does not: know what is at a node.
 * Threads:  one at a time.
 * Source:   "glTF 2.0 Specification", 3.5.
 */
#ifndef CTL_GLTF_NODE_H
#define CTL_GLTF_NODE_H

#include "gltf_file.h"

/* Where something is: its axes, and its origin in the last column. */
struct gltf_place {
    double m[3][4];
};

struct gltf_node {
    const json_t *json;
    int64_t parent, child, sibling;               /* child: the first one; -1: none */
    double translation[3], rotation[4], scale[3]; /* now; rotation of any length but 0 */
    bool has_matrix;                              /* then `local` is that */
    bool is_shown;
    bool moves_mesh; /* it or what is below it has vertices, or is a joint */
    struct gltf_place local, world;
    double *weights; /* [weight_count]: of the morph targets, now; NULL: none */
    size_t weight_count;
};

struct gltf_tree {
    struct gltf_node *nodes;
    size_t count;
    size_t *order; /* [count]: all nodes, parents first */
    size_t
        *shown; /* [shown_count]: those of the scene, parents first, as they are listed */
    size_t shown_count;
};

/* Errors: E_FORMAT, E_INDEX, E_NOMEM. gltf_tree_deinit also after an error. */
int gltf_tree_read(struct gltf *gltf, struct gltf_tree *tree);
void gltf_tree_deinit(struct gltf_tree *tree);
/* It and its parents move a mesh. */
void gltf_tree_mark(struct gltf_tree *tree, size_t node);
/* Compute `world` of all nodes that move a mesh. E_FORMAT: a rotation of length 0. */
int gltf_tree_place(struct gltf *gltf, struct gltf_tree *tree);

/* False: the rotation has no length. */
bool gltf_place_of(const double translation[3], const double rotation[4],
                   const double scale[3], struct gltf_place *place);
struct gltf_place gltf_place_product(const struct gltf_place *a,
                                     const struct gltf_place *b);
/* The columns of a matrix of four rows, the last of which is to be 0 0 0 1: false if
 * not. */
bool gltf_place_of_matrix(const double columns[16], struct gltf_place *place);
/* A point of the place, outside. */
void gltf_place_apply(const struct gltf_place *place, double x[3]);

#endif

/* refit_box.h - the box of one edge or node of the trees, and the frame that a vertex is
 * measured in.
 *
 * Threads: [team]; inline only. A box is written by one thread.
 * Source: paper section 6.1.
 */
#ifndef ENG_REFIT_BOX_H
#define ENG_REFIT_BOX_H

#include "thickness.h"
#include "trees.h"

/* The frame that the boxes of a vertex of a binary hierarchy are measured in, or NULL. */
static inline const struct eng_frame *eng_frame_of_vertex(const struct eng_scene *scene,
                                                          uint32_t vertex)
{
    return scene->framing.number > 0
               ? &scene->objects[eng_trees_of(scene)->vertices[vertex].object].frame
               : NULL;
}

/* The box of a vertex that goes from x0 to x1, with its thickness. */
static inline void eng_refit_vertex(const struct eng_scene *scene, uint32_t vertex,
                                    const double x0[3], const double x1[3],
                                    struct eng_box *box)
{
    eng_box_of_point(box, eng_frame_of_vertex(scene, vertex), x0, x1);
    if (scene->thickness.is_on) {
        const struct eng_object *object =
            &scene->objects[eng_trees_of(scene)->vertices[vertex].object];
        float growth =
            eng_thickness_growth(scene, object, vertex - object->vertices.first);
        /* Of an object that is not thick it is the same whether others are: it may be
         * kept when another one becomes thick. */
        for (int k = 0; k < 3 && growth > 0; k++) {
            box->lo0[k] = -eng_thickness_grown(-box->lo0[k], growth);
            box->hi0[k] = eng_thickness_grown(box->hi0[k], growth);
            box->lo1[k] = -eng_thickness_grown(-box->lo1[k], growth);
            box->hi1[k] = eng_thickness_grown(box->hi1[k], growth);
        }
    }
}

static inline void eng_refit_edge(struct eng_trees *trees, uint32_t e)
{
    struct eng_edge *edge = &trees->edges[e];
    eng_box_unite(eng_box_of(edge), eng_box_of(&trees->vertices[edge->a]),
                  eng_box_of(&trees->vertices[edge->b]));
}

/* Is all that could be first in a pair below a node foreign? */
static inline bool eng_node_is_foreign(const struct eng_trees *trees,
                                       const struct eng_node *node)
{
    if (node->left != ENG_LEAF) {
        return trees->nodes[node->left].foreign && trees->nodes[node->right].foreign;
    }
    static_assert(ENG_FOREIGN_VERTEX(0) == 128 * ENG_OWNS_VERTEX(0) &&
                      ENG_FOREIGN_EDGE(0) == 128 * ENG_OWNS_EDGE(0),
                  "bits of what is owned, in the same order");
    uint32_t owns = trees->triangles[node->right].owns;
    return (owns & ~(owns / 128) & (ENG_OWNS_BITS - ENG_OWNS_FACE)) == 0;
}

/* Mark nodes whose children are marked; of a range the last first. */
static inline void eng_foreign_mark(struct eng_trees *trees, struct eng_range nodes)
{
    for (uint32_t i = nodes.count; i-- > 0;) {
        struct eng_node *node = &trees->nodes[nodes.first + i];
        node->foreign = eng_node_is_foreign(trees, node);
    }
}

static inline void eng_refit_node(struct eng_trees *trees, uint32_t idx)
{
    struct eng_node *node = &trees->nodes[idx];
    struct eng_box *box = eng_box_of(node);
    if (node->left == ENG_LEAF) {
        const uint32_t *v = trees->triangles[node->right].v;
        eng_box_unite(box, eng_box_of(&trees->vertices[v[0]]),
                      eng_box_of(&trees->vertices[v[1]]));
        eng_box_unite(box, box, eng_box_of(&trees->vertices[v[2]]));
    } else {
        eng_box_unite(box, eng_box_of(&trees->nodes[node->left]),
                      eng_box_of(&trees->nodes[node->right]));
    }
}

#endif

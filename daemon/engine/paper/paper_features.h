/* paper_features.h - looks up the vertices and the object of a vertex, edge or face, for
 * the method `paper`.
 *
 * Say of a vertex (1 point), an edge (2) or a face (3) where it is stored, and which
 * vertices and object it has. The number of points is a constant in the calling code, so
 * no branch is left.
 *
 * Threads: [team]; what it reads does not change within a step.
 */
#ifndef ENG_PAPER_FEATURES_H
#define ENG_PAPER_FEATURES_H

#include <assert.h>

#include "kinds.h"
#include "trees.h"

#define ENG_FEATURE_INLINE static inline __attribute__((always_inline))

/* Its vertices to v[points]; `feature`: its index among the scene's of its sort. */
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

/* The index of its object. */
ENG_FEATURE_INLINE uint32_t eng_feature_object(const struct eng_trees *trees,
                                               uint32_t points, uint32_t feature)
{
    return points == 1   ? trees->vertices[feature].object
           : points == 2 ? trees->edges[feature].object
                         : trees->triangles[feature].object;
}

/* The index of the first feature of that sort that an object has. */
ENG_FEATURE_INLINE uint32_t eng_feature_first(const struct eng_object *object,
                                              uint32_t points)
{
    return points == 1   ? object->vertices.first
           : points == 2 ? eng_planted_of(object)->edges.first
                         : eng_planted_of(object)->triangles.first;
}

/* Features of that sort that one triangle has; it need not own each. */
ENG_FEATURE_INLINE uint32_t eng_feature_count(uint32_t points)
{
    return points == 3 ? 1 : 3;
}

/* Does the leaf own its feature k? Its face, which it has to have (eng_feature_has_face),
 * and of the others those that no leaf before it has. */
ENG_FEATURE_INLINE bool eng_feature_is_owned(const struct eng_triangle *triangle,
                                             uint32_t points, uint32_t k)
{
    return points == 1   ? (triangle->owns & ENG_OWNS_VERTEX(k)) != 0
           : points == 2 ? (triangle->owns & ENG_OWNS_EDGE(k)) != 0
                         : true;
}

/* Of a vertex or an edge that it owns: is it foreign (mesh.h)? */
ENG_FEATURE_INLINE bool eng_feature_is_foreign(const struct eng_triangle *triangle,
                                               uint32_t points, uint32_t k)
{
    return (triangle->owns &
            (points == 1 ? ENG_FOREIGN_VERTEX(k) : ENG_FOREIGN_EDGE(k))) != 0;
}

static inline bool eng_feature_has_face(const struct eng_triangle *triangle)
{
    return (triangle->owns & ENG_OWNS_FACE) != 0;
}

/* Is it a free point, or a free edge? */
static inline bool eng_feature_is_free_point(const struct eng_triangle *triangle)
{
    return (triangle->owns & ENG_OWNS_BITS) == ENG_OWNS_VERTEX(0) &&
           triangle->v[0] == triangle->v[1];
}

static inline bool eng_feature_is_free_edge(const struct eng_triangle *triangle)
{
    return !eng_feature_has_face(triangle) && triangle->v[0] != triangle->v[1];
}

/* The index of feature k of the triangle below `leaf`. */
ENG_FEATURE_INLINE uint32_t eng_feature_of(const struct eng_trees *trees, uint32_t points,
                                           const struct eng_node *leaf, uint32_t k)
{
    const struct eng_triangle *triangle = &trees->triangles[leaf->right];
    return points == 1 ? triangle->v[k] : points == 2 ? triangle->e[k] : leaf->right;
}

/* Its box: that of a face is its leaf's. */
ENG_FEATURE_INLINE const struct eng_box *eng_feature_box(const struct eng_trees *trees,
                                                         uint32_t points,
                                                         const struct eng_node *leaf,
                                                         uint32_t feature)
{
    return points == 1   ? eng_box_of_const(&trees->vertices[feature])
           : points == 2 ? eng_box_of_const(&trees->edges[feature])
                         : eng_box_of_const(leaf);
}

#endif

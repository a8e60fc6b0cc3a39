/* oracle_features.h - lists the vertices, edges and faces of a scene, for whoever
 * tries every pair of them.
 */
#ifndef ORACLE_ORACLE_FEATURES_H
#define ORACLE_ORACLE_FEATURES_H

#include "oracle_scene.h"

/* A vertex, an edge or a face of any object. */
struct oracle_feature {
    uint32_t object; /* index into the objects */
    uint32_t index;
    uint32_t points; /* 1, 2 or 3 vertices: */
    uint32_t v[3];
    /* A vertex that nothing has but a point that is named, an edge that no triangle
     * has. */
    bool is_free;
    double lo[3]; /* of its motion */
    double hi[3];
};

struct oracle_features {
    struct oracle_feature *items;
    size_t count;
    size_t capacity;
};

/* Those of `points` points: vertices in use, edges or faces, object by object, by index.
 * Ends the process where memory ends. */
void oracle_features_list(const struct oracle_object *objects, uint32_t object_count,
                          uint32_t points, struct oracle_features *features);
void oracle_features_deinit(struct oracle_features *features);

/* Those of them that are free stay. */
void oracle_features_keep_free(struct oracle_features *features);

/* Are they of one object, with a vertex in common? */
bool oracle_features_share_vertex(const struct oracle_feature *a,
                                  const struct oracle_feature *b);

/* realloc that ends the process where memory ends. */
void *oracle_grow(void *block, size_t bytes);

#endif

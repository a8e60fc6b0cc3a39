/* oracle_scene.h - finds every contact of a small scene by brute force and exact
 * arithmetic.
 */
#ifndef ORACLE_ORACLE_SCENE_H
#define ORACLE_ORACLE_SCENE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "oracle.h"

struct oracle_object {
    uint32_t object_id;
    uint32_t vertex_count;
    uint32_t triangle_count;
    const double (*x0)[3];
    const double (*x1)[3];
    const uint32_t (*triangles)[3];
    /* Edges and points that are named by themselves. */
    uint32_t edge_count;
    uint32_t point_count;
    const uint32_t (*edges)[2];
    const uint32_t *points;
    /* How thick it is, which oracle_near.h looks at: radii of vertices [vertex_count],
     * NULL: none; and which pairs within it are left thin: those that are nearer than
     * rest_distance where it was registered, and those that so many edges join. */
    const double *radii;
    const double (*registered)[3]; /* NULL: rest_distance is 0 */
    double rest_distance;
    uint32_t rest_rings;
};

/* VF: a vertex of object a and a face of object b. EE: (object_a, feature_a) comes before
 * (object_b, feature_b). Edges are the unique pairs of distinct vertices of the
 * triangles and of what is named, lower index first, numbered by (higher, lower). */
struct oracle_pair {
    uint32_t kind;
    uint32_t object_a;
    uint32_t feature_a;
    uint32_t object_b;
    uint32_t feature_b;
};

struct oracle_contacts {
    struct oracle_pair *pairs; /* sorted by the five words in their order */
    size_t count;
    uint64_t queries; /* put to the oracle */
    uint64_t beside;  /* pairs that no axis separates: oracle_is_apart says no */
};

/* Find all contacts of a scene, those of an object with itself, too. Ends the process
 * where memory ends. The caller frees *contacts with oracle_contacts_deinit. */
void oracle_scene(const struct oracle_object *objects, uint32_t object_count,
                  struct oracle_contacts *contacts);
/* Find those of pairs of objects, by their ids, which `may_meet` says yes to; of an
 * object and itself as well. */
void oracle_scene_where(const struct oracle_object *objects, uint32_t object_count,
                        bool (*may_meet)(const void *context, uint32_t a, uint32_t b),
                        const void *context, struct oracle_contacts *contacts);
void oracle_contacts_deinit(struct oracle_contacts *contacts);

/* Compare two pairs for their order, as qsort and bsearch want it. */
int oracle_pair_compare(const void *a, const void *b);

/* List the edges of an object, numbered as above. Freed by the caller. */
uint32_t (*oracle_edges(const struct oracle_object *object, uint32_t *count))[2];

/* Return whether an axis separates the features of a pair: all points of the one lie
 * above all points of the other along it, at both ends of the motion. */
bool oracle_is_apart(enum oracle_kind kind, const double p[8][3]);

/* Write the eight points of a pair. `edges` of each object as oracle_edges gives them. */
void oracle_vf_points(const struct oracle_object *a, uint32_t vertex,
                      const struct oracle_object *b, uint32_t face, double p[8][3]);
void oracle_ee_points(const struct oracle_object *a, const uint32_t edge_a[2],
                      const struct oracle_object *b, const uint32_t edge_b[2],
                      double p[8][3]);

#endif

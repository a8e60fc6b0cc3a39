/* oracle_near.h - finds all that is near in a small scene, by brute force.
 *
 * Give all vertex-face and edge-edge pairs that share no vertex, and those of free
 * points, to oracle_distance.h, and all edges and faces; merge pairs to the features
 * between which their distance is; find each vertex's least distance.
 *
 * Everywhere objects stand still: their x0 is their x1, the positions at the moment.
 */
#ifndef ORACLE_ORACLE_NEAR_H
#define ORACLE_ORACLE_NEAR_H

#include <stdbool.h>
#include <stdint.h>

#include "oracle_distance.h"
#include "oracle_scene.h"
#include "pccd_types.h"

/* ---- Lists the vertices, edges and faces of a scene, for whoever
 * tries every pair of them. */

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

/* List those of `points` points: vertices in use, edges or faces, object by object, by
 * index. Ends the process where memory ends. */
void oracle_features_list(const struct oracle_object *objects, uint32_t object_count,
                          uint32_t points, struct oracle_features *features);
void oracle_features_deinit(struct oracle_features *features);

/* Keep only those of them that are free. */
void oracle_features_keep_free(struct oracle_features *features);

/* Return whether they are of one object, with a vertex in common. */
bool oracle_features_share_vertex(const struct oracle_feature *a,
                                  const struct oracle_feature *b);

/* Call realloc, and end the process where memory ends. */
void *oracle_grow(void *block, size_t bytes);

/* The scene, and who may meet whom in it: NULL: all. */
struct oracle_moment {
    const struct oracle_object *objects;
    uint32_t object_count;
    bool (*may_meet)(const void *context, uint32_t id_a, uint32_t id_b);
    const void *context;
    /* Radii are added to the distance, and what is left thin is left out or, where it is
     * kept, has none: of bounds. */
    bool is_thick;
    bool keeps_thin;
};

/* Get ready to answer a question: what it says of thickness. */
void oracle_moment_thicken(struct oracle_moment *moment, enum pccd_near_what what);

/* A record, and which points of the pair its distance is between (oracle_distance.h). */
struct oracle_near {
    struct pccd_near record;
    uint32_t points;
    uint32_t object[2]; /* indices into the objects, of a and b */
    double radius[2];   /* of these features; 0 where thickness does not count */
};

struct oracle_nears {
    struct oracle_near *items; /* in canonical order */
    size_t count;
    uint64_t queries; /* pairs that were given to exact arithmetic */
    uint64_t ties;    /* oracle_objects.c: pairs as near as the one that was kept */
};

/* All functions end the process where memory ends. The caller frees what they give with
 * the last one. */

/* Find VF and EE pairs, and VE and VV of free points, at most `distance` apart. false,
 * and nothing is found: it would take more than `queries_max` exact decisions. */
bool oracle_near_pairs(const struct oracle_moment *moment, double distance,
                       uint64_t queries_max, struct oracle_nears *pairs);

/* Merge the same pairs to VV, VE, VF and EE, each with the number of its pairs. */
void oracle_near_features(const struct oracle_moment *moment,
                          const struct oracle_nears *pairs,
                          struct oracle_nears *features);

/* Find edges that pass through faces. Returns as oracle_near_pairs. */
bool oracle_near_crossings(const struct oracle_moment *moment, uint64_t queries_max,
                           struct oracle_nears *crossings);

/* Write, for each vertex of objects[at], the least of the pairs that it is a point of: of
 * d_lo less both radii, whose sum is rounded up, then down and to no less than 0;
 * `distance` where there is none. */
void oracle_near_bounds(const struct oracle_moment *moment,
                        const struct oracle_nears *pairs, uint32_t at, double distance,
                        double *bounds);

/* Compare two struct oracle_near for their canonical order, as qsort wants it. */
int oracle_near_compare(const void *a, const void *b);

void oracle_nears_deinit(struct oracle_nears *nears);

/* ---- Pairs of features that may be near, and their records. */

/* Two features that boxes do not keep apart, in the order of their record. */
struct oracle_candidate {
    const struct oracle_feature *a;
    const struct oracle_feature *b;
    bool is_thin; /* it has no radii */
};

struct oracle_candidates {
    struct oracle_candidate *items;
    size_t count;
    size_t capacity;
};

/* Add to *candidates the pairs of one of `left` and one of `right`, of two that may meet,
 * that share no vertex, whose boxes are within `distance` and their radii, and that are
 * not left thin; `left` and `right` may be the same. */
void oracle_candidates_find(const struct oracle_moment *moment,
                            const struct oracle_features *left,
                            const struct oracle_features *right, double distance,
                            struct oracle_candidates *candidates);
void oracle_candidates_deinit(struct oracle_candidates *candidates);

/* Load the points of a candidate, as oracle_candidate_load. One of fewer than four is of
 * VF, with a face that is a segment or a point: its last point is repeated, and comes
 * after itself. */
void oracle_candidate_fill(const struct oracle_moment *moment,
                           const struct oracle_candidate *candidate, double p[5][3],
                           uint8_t rank[5]);
/* Put what was found of VF in the terms of a kind: a weight is where on the edge. */
void oracle_distance_place(uint32_t kind, struct oracle_distance *found);

/* Write the points of a candidate, and the order of (object, vertex); of one that is
 * there twice, the first comes first. */
void oracle_candidate_load(const struct oracle_moment *moment,
                           const struct oracle_candidate *candidate, double p[5][3],
                           uint8_t rank[5]);
/* Write the names of near->record, of enum pccd_kind or pccd_near_kind, near->object and
 * near->radius. */
void oracle_candidate_name(const struct oracle_moment *moment, uint32_t kind,
                           const struct oracle_candidate *candidate,
                           struct oracle_near *near);
void oracle_near_write(const struct oracle_distance *distance, struct oracle_near *near);

/* Add one of zeros, and return it. */
struct oracle_near *oracle_nears_add(struct oracle_nears *nears);
void oracle_nears_sort(struct oracle_nears *nears);

/* ---- The nearest features of objects, and how deep objects are in each
 * other, by brute force and exact arithmetic.
 *
 * `asked`: two objects by id; or one, or none (0), with all others; of them those that
 * may meet. All functions end the process where memory ends. */

/* Find, for each two, the pair whose surfaces are nearest, its distance less its radii,
 * the first of equals; an edge that passes through a face is a pair at distance 0. None
 * where that is more than `distance`, which may be INFINITY. false, and nothing is found:
 * it would take more than `queries_max` exact decisions. */
bool oracle_objects_nearest(const struct oracle_moment *moment, const uint32_t asked[2],
                            double distance, uint64_t queries_max,
                            struct oracle_nears *nears);

/* Find, for each vertex that is inside the surface of another object, the nearest of its
 * faces, the first of equals; and how many edges pass through faces of another object. As
 * above. */
bool oracle_objects_depth(const struct oracle_moment *moment, const uint32_t asked[2],
                          uint64_t queries_max, struct oracle_nears *nears,
                          uint64_t *crossings);

/* Measure the VF or EE pair of two objects that `named` names, or the edge that passes
 * through a face. false: it names nothing that there is. */
bool oracle_objects_measure(const struct oracle_moment *moment,
                            const struct pccd_near *named, struct oracle_near *near);

/* ---- Is a point inside a surface of triangles?
 *
 * Count in integers how often a closed surface winds around a point: by the triangles
 * that a ray passes through, in a direction that is drawn at random until the ray meets
 * no edge and no vertex. */

/* Find how often a surface winds around a point. x: finite. False: the point is on one of
 * the triangles, and *winding is 0. */
bool oracle_winding(const double point[3], const double (*x)[3],
                    const uint32_t (*triangles)[3], uint32_t triangle_count,
                    int64_t *winding);

#endif

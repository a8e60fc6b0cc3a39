/* near_best.h - the nearest of the pairs of features that were looked at so far.
 *
 * Take a pair whose surfaces are nearer, exactly, or as near and before in canonical
 * order; say how far away a pair may be and still matter; describe the pair.
 *
 * Threads: one thread for one struct eng_near_best.
 * Source: elementary/BOUNDS.md, "Which distance is less".
 */
#ifndef ENG_NEAR_BEST_H
#define ENG_NEAR_BEST_H

#include "distance_order.h"
#include "world.h"

/* A vertex and a face, two edges, an edge and a face that it may pass through, or a free
 * point and a free edge or point; of two different objects, and named as in a record but
 * that an edge is the higher of its vertices << 32 | the lower: edges are numbered in
 * that order. */
struct eng_near_pair {
    uint32_t kind;
    uint32_t object[2]; /* index, of a and b */
    uint64_t feature[2];
    uint32_t point[5]; /* index in the scene's positions, in the order of distance.h; of
                        * fewer than four the last one is repeated */
};

/* Make the pair of vertex `v` and face `f` of two objects. */
struct eng_near_pair eng_near_vf(const struct eng_scene *scene, uint32_t of_vertex,
                                 uint32_t v, uint32_t of_face, uint32_t f);
/* Make the pair of edges of two objects, each given by its vertices. */
struct eng_near_pair eng_near_ee(const struct eng_scene *scene, uint32_t a,
                                 const uint32_t edge_a[2], uint32_t b,
                                 const uint32_t edge_b[2]);
/* Make the pair of an edge, given by its vertices, and face `f`. */
struct eng_near_pair eng_near_ef(const struct eng_scene *scene, uint32_t of_edge,
                                 const uint32_t edge[2], uint32_t of_face, uint32_t f);

/* Make the pair of a point and an edge, given by its vertices. */
struct eng_near_pair eng_near_ve(const struct eng_scene *scene, uint32_t of_vertex,
                                 uint32_t v, uint32_t of_edge, const uint32_t edge[2]);
/* Make the pair of two points. */
struct eng_near_pair eng_near_vv(const struct eng_scene *scene, uint32_t a, uint32_t v,
                                 uint32_t b, uint32_t w);

/* Limits of what a pair's surfaces, its distance less its radii, are apart; >= 0. */
struct eng_near_limits {
    double distance; /* what is farther does not count; INFINITY: all does */
    double gap;      /* what is nearer by at most that need not be found */
    double most[2];  /* the largest radii of the two objects; zeros: they are thin */
};

struct eng_near_best {
    const struct eng_scene *scene;
    const double (*x)[3]; /* the scene's positions at the moment */
    struct eng_distances *distances;
    struct eng_distance_order *order;
    struct eng_near_limits limits;
    double radii; /* the sum of both largest, rounded up */
    bool is_made;
    struct eng_near_pair pair;
    double radius[2]; /* of the pair */
    double lo;        /* its surfaces are apart by what is between these */
    double hi;
    bool is_least;  /* no surfaces are nearer */
    bool has_parts; /* it is known what its distance is between: these indices */
    uint32_t part_count;
    uint32_t parts[4];
    uint64_t looked; /* pairs since looked was 0 */
};

/* Begin: no pair is kept yet. */
void eng_near_best_begin(struct eng_near_best *best,
                         const struct eng_near_limits *limits);

/* Return a distance: a pair whose distance is more, whatever its radii, need not be
 * looked at; negative: none need. */
double eng_near_best_reach(const struct eng_near_best *best);

/* Look at a pair, and keep it as best->pair if none is kept that comes before it: by how
 * far their surfaces are apart, then by canonical order. One that is beyond
 * limits.distance, or nearer by at most limits.gap, may be left out. An edge and a face
 * are at distance 0 if the edge passes through, else they are left out. */
void eng_near_best_look(struct eng_near_best *best, const struct eng_near_pair *pair);

/* Write the record of a pair. */
void eng_near_describe(const struct eng_near_best *best, const struct eng_near_pair *pair,
                       struct pccd_near *record);

#endif

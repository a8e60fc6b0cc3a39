/* oracle_near.h - finds everything that is near in a small scene at one moment, by brute
 * force and exact arithmetic.
 *
 * Give all vertex-face and edge-edge pairs that share no vertex, and those of free
 * points, to oracle_distance.h, and all edges and faces; merge pairs to the features
 * between which their distance is; find each vertex's least distance.
 *
 * Everywhere objects stand still: their x0 is their x1, the positions at the moment.
 */
#ifndef ORACLE_ORACLE_NEAR_H
#define ORACLE_ORACLE_NEAR_H

#include "oracle_distance.h"
#include "oracle_scene.h"
#include "pccd_types.h"

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
    uint64_t ties;    /* oracle_objects.h: pairs as near as the one that was kept */
};

/* All functions end the process where memory ends. The caller frees what they give with
 * the last one. */

/* VF and EE pairs, and VE and VV of free points, at most `distance` apart. false, and
 * nothing is found: it would take more than `queries_max` exact decisions. */
bool oracle_near_pairs(const struct oracle_moment *moment, double distance,
                       uint64_t queries_max, struct oracle_nears *pairs);

/* The same pairs merged to VV, VE, VF and EE, each with the number of its pairs. */
void oracle_near_features(const struct oracle_moment *moment,
                          const struct oracle_nears *pairs,
                          struct oracle_nears *features);

/* Edges that pass through faces. As oracle_near_pairs. */
bool oracle_near_crossings(const struct oracle_moment *moment, uint64_t queries_max,
                           struct oracle_nears *crossings);

/* Of each vertex of objects[at] the least of the pairs that it is a point of: of d_lo
 * less both radii, whose sum is rounded up, then down and to no less than 0; `distance`
 * where there is none. */
void oracle_near_bounds(const struct oracle_moment *moment,
                        const struct oracle_nears *pairs, uint32_t at, double distance,
                        double *bounds);

/* Canonical order of struct oracle_near, as qsort wants it. */
int oracle_near_compare(const void *a, const void *b);

void oracle_nears_deinit(struct oracle_nears *nears);

#endif

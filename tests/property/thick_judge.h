/* tests/property/thick_judge.h - judges thick features of two small objects by all pairs.
 *
 * Room:     tests/property; engine (scene.h), client/oracle.
 * Does:     hold the scene of a play as all pairs see it: two objects of triangles, edges
 *           and points, their radii and what they leave thin; decide each pair by the
 *           oracle.
 * Threads:  one.
 */
#ifndef TESTS_THICK_JUDGE_H
#define TESTS_THICK_JUDGE_H

#include "eng_way.h"
#include "oracle_thick.h"

#define THICK_OBJECTS   2u
#define THICK_TRIANGLES 4u
#define THICK_VERTICES  (THICK_TRIANGLES + 2)
#define THICK_NAMED_MAX 8u
#define THICK_EDGES_MAX (3 * THICK_TRIANGLES + THICK_NAMED_MAX)
#define THICK_PAIRS_MAX 1024u
#define THICK_WAYS_MAX  32u

/* What an object is made of, as it is named. */
struct thick_shape {
    uint32_t triangle_count;
    uint32_t edge_count;
    uint32_t point_count;
    uint32_t triangles[THICK_TRIANGLES][3];
    uint32_t edges[THICK_NAMED_MAX][2];
    uint32_t points[THICK_NAMED_MAX];
};

struct thick_body {
    struct eng_mesh *mesh;
    struct thick_shape shape;
    uint32_t edge_count; /* unique, in their order */
    uint32_t edges[THICK_EDGES_MAX][2];
    bool is_free_edge[THICK_EDGES_MAX];
    bool is_vertex[THICK_VERTICES]; /* of anything */
    bool is_free_point[THICK_VERTICES];
    double x[2][THICK_VERTICES][3]; /* at both ends of the step */
    double radii[THICK_VERTICES];   /* of the mesh; not 0: it has some */
    double rest[THICK_VERTICES][3]; /* as registered */
    struct eng_object_thickness thickness;
};

struct thick_truth {
    struct pccd_pair name;
    bool is_candidate; /* in mode pairs; never of free points that keep no distance */
    bool is_thick;
    bool is_inside;
    struct oracle_first *first; /* NULL: no contact */
};

struct thick_play {
    struct prng prng;
    struct thick_body bodies[THICK_OBJECTS];
    double separation;
    double approach;
    double base; /* where object 1 is along x, .. */
    double far;  /* .. and object 2, beside it */
    double unit;
    uint64_t contacts[PCCD_KIND_COUNT]; /* of all steps so far */
    struct thick_truth truths[THICK_PAIRS_MAX];
    uint32_t truth_count;
    struct eng_scene *scenes[THICK_WAYS_MAX];
};

/* Find out what features a body of that shape has. */
void thick_judge_shape(struct thick_body *body);

/* All pairs in canonical order, to play->truths; those of before are forgotten. */
void thick_judge_decide(struct thick_play *play);
void thick_judge_forget(struct thick_play *play);

/* Is a pair within the distance and its radii at an end of the step, and not left thin
 * for its rest? */
bool thick_judge_is_near(const struct thick_play *play, const struct thick_truth *truth,
                         double distance, uint32_t end);

#endif

/* tests/property/thick_judge.h - judges thick features of two small objects by all pairs.
 *
 * Room:     tests/property; engine (scene.h), client/oracle.
 * Does:     hold the scene of a play as all pairs see it: two strips of triangles, their
 *           radii and what they leave thin; decide each pair by the oracle.
 * Threads:  one.
 */
#ifndef TESTS_THICK_JUDGE_H
#define TESTS_THICK_JUDGE_H

#include "eng_way.h"
#include "oracle_thick.h"

#define THICK_OBJECTS   2u
#define THICK_TRIANGLES 4u /* a strip */
#define THICK_VERTICES  (THICK_TRIANGLES + 2)
#define THICK_EDGES     (2 * THICK_TRIANGLES + 1)
#define THICK_PAIRS_MAX 512u
#define THICK_WAYS_MAX  32u

struct thick_body {
    struct eng_mesh *mesh;
    double x[2][THICK_VERTICES][3]; /* at both ends of the step */
    double radii[THICK_VERTICES];   /* of the mesh; not 0: it has some */
    double rest[THICK_VERTICES][3]; /* as registered */
    struct eng_object_thickness thickness;
};

struct thick_truth {
    struct pccd_pair name;
    bool is_candidate; /* in mode pairs */
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
    struct thick_truth truths[THICK_PAIRS_MAX];
    uint32_t truth_count;
    struct eng_scene *scenes[THICK_WAYS_MAX];
};

/* All pairs in canonical order, to play->truths; those of before are forgotten. */
void thick_judge_decide(struct thick_play *play);
void thick_judge_forget(struct thick_play *play);

/* Is a pair within the distance and its radii at an end of the step, and not left thin
 * for its rest? */
bool thick_judge_is_near(const struct thick_play *play, const struct thick_truth *truth,
                         double distance, uint32_t end);

#endif

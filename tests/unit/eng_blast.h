/* eng_blast.h - a scene that flies to pieces, so that a tree built at its start becomes
 * useless.
 *
 * Hold a scene of single triangles, put together like a sheet at time 0, each with a
 * velocity of its own; run steps between any two times. Neighbours end far from each
 * other.
 */
#ifndef TEST_ENG_BLAST_H
#define TEST_ENG_BLAST_H

#include "eng_kit.h"

#include "step.h"
#include "world.h"

#define BLAST_SIDE      34u
#define BLAST_TRIANGLES (2 * BLAST_SIDE * BLAST_SIDE)
#define BLAST_VERTICES  (3 * BLAST_TRIANGLES)

struct blast {
    struct eng_scene *scene;
    uint32_t idx;
    double rest[BLAST_VERTICES][3];
    double velocity[BLAST_VERTICES][3];
};

/* `region_triangles` small: many regions, and high nodes above them. */
void blast_init(struct blast *blast, const struct eng_scene_settings *settings);
void blast_deinit(struct blast *blast);

/* The step from time t0 to t1; the tree must be a tree afterwards. */
struct eng_step_result blast_run(struct blast *blast, double t0, double t1,
                                 struct eng_question settings);

/* Fresh hierarchies at the present positions. */
void blast_rebuild(struct blast *blast);

#endif

/* truth_engine.h - steps of the engine on public scenes and queries.
 *
 * Threads: one; teams of up to four.
 */
#ifndef TRUTH_ENGINE_H
#define TRUTH_ENGINE_H

#include "eng_kit.h"
#include "step.h"
#include "truth_kit.h"

/* The settings of a step in way `i`: alone by the method of the paper, then by each
 * method with each instruction set, by teams. */
uint32_t truth_way_count(void);
struct eng_question truth_way(uint32_t i);

/* A mesh of the object. The caller releases it. */
struct eng_mesh *truth_mesh(const struct oracle_object *object);

/* The object, of that thickness (NULL: none), moved to its end in one step. The scene is
 * the caller's, and holds the records. */
struct eng_scene *truth_run(struct eng_mesh *mesh, const struct oracle_object *object,
                            const struct eng_object_thickness *thickness,
                            const struct eng_question *settings,
                            struct eng_step_result *result);

/* Two triangles: a query's features, each padded to a triangle with vertices of their own
 * at the place of a vertex that they have. */
struct truth_two {
    struct oracle_object object;
    double x[2][6][3];
};
void truth_two_init(struct truth_two *two, bool is_vf, const double p[8][3]);

/* The record of the query itself: vertex 0 and face 0, or edges 0-1 and 2-3. NULL: there
 * is none. */
const struct pccd_contact *truth_two_find(bool is_vf, const struct eng_mesh *mesh,
                                          const struct eng_step_result *result);

#endif

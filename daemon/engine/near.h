/* near.h - how near the features of a scene are at one moment: distances, closest
 * features, crossings, depth.
 *
 * Answer from the trees of a method, at one end of the step that the scene has moved on
 * by; boxes are made only where the last step left none. What is staged is moved first.
 */
#ifndef ENG_NEAR_H
#define ENG_NEAR_H

#include "pccd_types.h"
#include "question.h"
#include "scene.h"
#include "step_result.h"

/* The record of a vertex in VERTICES, as it is hashed. */
struct eng_vertex_bound {
    uint32_t object;
    uint32_t vertex;
    double bound;
};

/* Answer a question about what is near. PCCD_OK with *result, also when incomplete;
 * PCCD_E_INVAL: settings out of range, or (result->open_object != 0) DEPTH of a mesh
 * whose triangles are not closed; PCCD_E_HANDLE: no object of that id; PCCD_E_LIMIT:
 * distance and radii add up to more than 1e18; PCCD_E_NOMEM.
 *
 * PAIRS, FEATURES, VERTICES and NEAREST look at what is within the distance and the radii
 * of both features, their exact sum (scene.h). Pairs that are left thin for their rest
 * VERTICES takes without radii, the others not at all. */
int eng_near(struct eng_scene *scene, const struct eng_question *question,
             struct eng_step_result *result);

/* Count how the step begins that the scene has just made with these settings: its
 * crossings and, if it has an approach, the pairs within their distance. As above. */
int eng_near_start(struct eng_scene *scene, const struct eng_question *step,
                   struct eng_step_result *result);

#endif

/* step.h - computes one step of a scene: every contact between the positions at its
 * beginning and at its end.
 *
 * Source: paper sections 4-6; the contract of an answer is in README.md.
 */
#ifndef ENG_STEP_H
#define ENG_STEP_H

#include "pccd_types.h"
#include "question.h"
#include "scene.h"
#include "step_result.h"

/* An empty scene; `settings` NULL: the defaults. PCCD_E_INVAL, PCCD_E_NOMEM. */
int eng_scene_new(const struct eng_scene_settings *settings, struct eng_scene **scene);

/* Once, of a committed mesh that is in no scene yet: find the order of its features that
 * objects begin with, by so many threads (0: one), so that all of them share it. Without
 * it each has its own; no answer depends on it. PCCD_E_STATE, PCCD_E_NOMEM. */
int eng_mesh_arrange(struct eng_mesh *mesh, uint32_t threads);

/* Run the step that was staged on `scene` (without staging: everything stands still; of a
 * part, question->span: the last step once more).
 * Returns PCCD_OK with *result, also when incomplete; PCCD_E_AGAIN (brief.h): positions
 * have moved on. Settings out of range (PCCD_E_INVAL), a separation beyond 1e18
 * (PCCD_E_LIMIT), PCCD_E_NOMEM: as before. */
int eng_step(struct eng_scene *scene, const struct eng_question *question,
             struct eng_step_result *result);

/* How much work the next step with these settings will be, as the last ones were;
 * nanoseconds of one thread. A guess by the size of the scene before the first. */
uint64_t eng_step_expects(const struct eng_scene *scene,
                          const struct eng_question *question);

/* Is so much work, in steps that do not depend on each other, worth a team? */
bool eng_step_is_enough(uint64_t work_ns);

/* No step is to follow soon: free the threads' scratch, 0.8 MB each. The answer stays. */
void eng_step_tidy(struct eng_scene *scene);

/* What it would say of a step that has to end before it begins: nothing was found. Of the
 * settings, mode, method and scheduler matter. [any] */
void eng_step_nothing(const struct eng_question *question,
                      struct eng_step_result *result);

#endif

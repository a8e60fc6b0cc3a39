/* step.h - computes one step of a scene: every contact between the positions at its
 * beginning and at its end.
 *
 * Source: paper sections 4-6; the contract of an answer is in README.md.
 */
#ifndef ENG_STEP_H
#define ENG_STEP_H

#include <stdint.h>

#include "pccd_trace.h"
#include "pccd_types.h"
#include "question.h"
#include "scene.h"
#include "step_result.h"

/* Make an empty scene; `settings` NULL: the defaults. PCCD_E_INVAL, PCCD_E_NOMEM. */
int eng_scene_new(const struct eng_scene_settings *settings, struct eng_scene **scene);

/* Find the order of a mesh's features that objects begin with, by so many threads (0:
 * one), so that all of them share it: once, of a committed mesh that is in no scene yet.
 * Without it each has its own; no answer depends on it. PCCD_E_STATE, PCCD_E_NOMEM. */
int eng_mesh_sort_features(struct eng_mesh *mesh, uint32_t threads);

/* Return whether the step would count what begins within r, where that is not the same
 * sum for all pairs: some have a clearance. Such a step is PCCD_E_INVAL. */
bool eng_step_refuses_start(const struct eng_scene *scene,
                            const struct eng_question *question);

/* Run the step that was staged on `scene` (without staging: everything stands still; of a
 * part, question->span: the last step once more).
 * Returns PCCD_OK with *result, also when incomplete; PCCD_E_AGAIN (below): positions
 * have moved on. Settings out of range (PCCD_E_INVAL), a separation beyond 1e18
 * (PCCD_E_LIMIT), PCCD_E_NOMEM: as before. */
int eng_step(struct eng_scene *scene, const struct eng_question *question,
             struct eng_step_result *result);

/* Move the scene on, and find nothing: as eng_step, whose end has come before it begins.
 * With the method wide nothing is made for it that the scene does not have yet. */
int eng_move(struct eng_scene *scene, const struct eng_question *question,
             struct eng_step_result *result);

/* Return how much work the next step with these settings will be, as the last ones were;
 * nanoseconds of one thread. A guess by the size of the scene before the first. */
uint64_t eng_step_expects(const struct eng_scene *scene,
                          const struct eng_question *question);

/* Return whether so much work, in steps that do not depend on each other, is worth a
 * team. */
bool eng_team_pays(uint64_t work_ns);

/* Free the threads' scratch, 0.8 MB each, as no step is to follow soon. The answer
 * stays. */
void eng_step_free_scratch(struct eng_scene *scene);

/* Write the result of a step that has to end before it begins: nothing was found. Of the
 * settings, mode, method and scheduler matter. [any] */
void eng_step_empty_result(const struct eng_question *question,
                           struct eng_step_result *result);

/* Read the boxes of a level, the root being level 0, as the last step that used the tree
 * left them. Copies the count boxes from the first on that there are; `to` is not looked
 * at with count 0. Returns how many boxes the level has; 0: there is no such level, or no
 * step has made its boxes since objects came or went (one whose objects all turn, or one
 * in body space, makes none of wide), or the last one was stopped while it did, or one by
 * the other method has put objects into other frames. Boxes are in coordinates: those
 * that were measured in frames are rounded outward once more. wide: O(count), with frames
 * O(features below them); paper: O(nodes down to the level). [compute], between steps */
uint32_t eng_level_boxes(const struct eng_scene *scene, enum pccd_tree tree,
                         uint32_t level, uint32_t first, uint32_t count,
                         struct pccd_box *to);

/* ---- steps that end soon ----------------------------------------------------------- */

/* Return whether the next step with these settings can be asked for as a brief one, with
 * `brief` set, by somebody who must not be held up: its last step in that mode was short,
 * and none of the sizes that the time of a step grows with is more than a few hundred.
 * What depends on the positions is bounded by the step itself, by counts and not by a
 * clock: it ends with PCCD_E_AGAIN before it tests more candidates than a few, or one
 * that takes a search or exact arithmetic: the scene has moved on then, and the next
 * step, unless it is staged, is the same step once more. So it takes some tens of
 * microseconds at most, by one thread.
 *
 * With `alone` set, too, nobody but who asks is held up: it may be of some thousand
 * vertices, and take 10 ms at most, where things are as bad as can be.
 *
 * A large scene's steps can be brief, too, as long as it is at rest: nothing is written
 * in this one (not `is_staged`), nothing moved in the last one, and its answer, which has
 * few records, is at hand. */
bool eng_step_can_be_brief(const struct eng_scene *scene,
                           const struct eng_question *question, bool is_staged);

#endif

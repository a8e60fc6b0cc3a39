/* brief.h - decides whether a step is small enough for the thread that serves sockets
 * to compute it at once, without handing it to another thread.
 */
#ifndef ENG_BRIEF_H
#define ENG_BRIEF_H

#include "question.h"
#include "scene.h"
#include "team.h"

/* Whether the next step with these settings can be asked for as a brief one, with `brief`
 * set, by somebody who must not be held up: its last step in that mode was short, and
 * none of the sizes that the time of a step grows with is more than a few hundred. What
 * depends on the positions is bounded by the step itself, by counts and not by a clock:
 * it ends with PCCD_E_AGAIN before it tests more candidates than a few, or one that takes
 * a search or exact arithmetic: the scene has moved on then, and the next step, unless it
 * is staged, is the same step once more. So it takes some tens of microseconds at most,
 * by one thread.
 *
 * A large scene's steps can be brief, too, as long as it is at rest: nothing is written
 * in this one (not `is_staged`), nothing moved in the last one, and its answer, which has
 * few records, is at hand. */
bool eng_step_can_be_brief(const struct eng_scene *scene,
                           const struct eng_question *question, bool is_staged);

/* The boxes and records at hand have been looked at: is what is left of a brief step
 * bounded as above? */
bool eng_brief_is_bounded(const struct eng_scene *scene, const struct eng_team *team);

/* Are they settings of a step that can be brief: whose work is bounded as above? */
bool eng_brief_fits(const struct eng_question *question);

#endif

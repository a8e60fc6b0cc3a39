/* daemon/engine/schedule/brief.h - steps that are certain to end soon.
 *
 * Room:     engine. May include: step.h.
 * Does:     say which steps are, and bound them.
 * Threads:  [compute].
 */
#ifndef ENG_BRIEF_H
#define ENG_BRIEF_H

#include "step.h"

/* Pairs that a brief step tests, at most: each takes up to 0.3 us of a vector kernel, as
 * none is searched for. */
#define ENG_BRIEF_TESTS 64u

/* Whether the next step with these settings can be asked for as a brief one, with `brief`
 * set, by somebody who must not be held up: its last step in that mode was short, and
 * none of the sizes that the time of a step grows with is more than a few hundred. What
 * depends on the positions is bounded by the step itself, by counts and not by a clock:
 * it ends with ENG_E_LONG before it tests more candidates than a few, or one that takes a
 * search or exact arithmetic: the scene has moved on then, and the next step, unless it
 * is staged, is the same step once more. So it takes some tens of microseconds at most,
 * by one thread. */
bool eng_step_can_be_brief(const struct eng_scene *scene,
                           const struct eng_step_settings *settings);

/* The method that the settings lead to. */
enum eng_method eng_step_method(const struct eng_step_settings *settings);

/* Are they settings of a step that can be brief: whose work is bounded as above? */
bool eng_brief_fits(const struct eng_step_settings *settings);

#endif

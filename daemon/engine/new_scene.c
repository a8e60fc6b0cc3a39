/* daemon/engine/new_scene.c - a scene is made.
 *
 * Room:     engine.
 * Does:     make an empty scene in which each method, and the step, has its slot.
 * Threads:  [compute].
 */
#include "paper.h"
#include "step.h"
#include "step_memory.h"
#include "wide_state.h"

int eng_scene_new(const struct eng_scene_settings *settings, struct eng_scene **scene)
{
    static const struct eng_slot_calls *const owners[ENG_SLOTS] = {
        [ENG_SLOT_PAPER] = &eng_paper_slot,
        [ENG_SLOT_WIDE] = &eng_wide_slot,
        [ENG_SLOT_STEP] = &eng_step_slot};
    return eng_world_new(settings, owners, scene);
}

/* wide_state.h - everything that the method `wide` keeps for a scene.
 *
 * Threads: [compute]; inside a step as each part says.
 */
#ifndef ENG_WIDE_STATE_H
#define ENG_WIDE_STATE_H

#include "wide.h"
#include "wide_owner.h"
#include "wide_resort.h"

struct eng_wide_state {
    struct eng_wide trees;         /* first: eng_wide_of finds them by it */
    struct eng_wide_owners owners; /* made anew after the trees */
    struct eng_wide_resort resort;
    uint64_t left_out; /* triangles of rigid objects that `resort` has learned without */
};

static_assert(offsetof(struct eng_wide_state, trees) == 0, "eng_wide_of");

static inline struct eng_wide_state *eng_wide_state_of(const struct eng_scene *scene)
{
    return scene->slots[ENG_SLOT_WIDE];
}

extern const struct eng_slot_calls eng_wide_slot;

#endif

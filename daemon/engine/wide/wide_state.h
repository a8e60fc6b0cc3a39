/* wide_state.h - everything that the method `wide` keeps for a scene.
 *
 * Threads: [compute]; inside a step as each part says.
 */
#ifndef ENG_WIDE_STATE_H
#define ENG_WIDE_STATE_H

#include "method.h"
#include "wide.h"
#include "wide_leads.h"
#include "wide_owner.h"
#include "wide_resort.h"

struct eng_wide_state {
    struct eng_wide trees;         /* first: eng_wide_of finds them by it */
    struct eng_wide_owners owners; /* made anew after the trees */
    struct eng_wide_resort resort;
    struct eng_wide_leads leads; /* of bounds of vertices, once they were asked for */
    uint64_t left_out; /* triangles of rigid objects that `resort` has learned without */
};

static_assert(offsetof(struct eng_wide_state, trees) == 0, "eng_wide_of");

static inline struct eng_wide_state *eng_wide_state_of(const struct eng_scene *scene)
{
    return scene->slots[ENG_SLOT_WIDE];
}

extern const struct eng_slot_calls eng_wide_slot;

/* The functions that a step calls. */
extern const struct eng_method_calls eng_method_wide;

/* Do parts of it (method.h): the refit by all threads, with eng_refit_begin before the
 * region and eng_refit_release and eng_refit_await after it; and the leaves of an
 * object. All objects have the root of a tree; what is not in the object's slots is
 * left out on the way down. */
bool eng_wide_refit_by_team(struct eng_team *team, struct eng_worker *worker);
bool eng_wide_leaves_of(const struct eng_scene *scene, uint32_t object_idx,
                        enum pccd_tree tree, uint32_t end, struct eng_leaves *leaves);
void eng_wide_leaves_open(const struct eng_leaves *leaves, uint32_t node,
                         struct eng_leaves_below *below);
uint32_t eng_wide_leaves_index(const struct eng_leaves *leaves, uint32_t node);

#endif

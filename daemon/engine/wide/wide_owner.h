/* wide_owner.h - knows which objects lie below each node of the wide trees, so that pairs
 * that may not meet are culled high in the tree.
 *
 * Know for every node which objects are below it and what these may meet; cull the pairs
 * of nodes that may not meet (masks.h) before their boxes are compared any further.
 *
 * Threads: made by [compute]; read by the [team].
 *
 * A block of features belongs to one object, because objects begin at multiples of 16
 * slots. So what is culled there is exactly what may not meet, and nothing is left to
 * check later. Higher up, a node that lies wholly within one object is treated as the
 * object. Any other node is culled if no group of its objects is in the masks of the
 * other node. Example: a thousand things that stand still and ignore each other cost only
 * a few tests.
 *
 * A rigid object does not meet itself (rigid.h), but for features of it that are crowded:
 * then only blocks that have such are joined. Which objects these are is
 * asked of the masks while traversing, as it may change with every step.
 */
#ifndef ENG_WIDE_OWNER_H
#define ENG_WIDE_OWNER_H

#include <stdbool.h>
#include <stdint.h>

#include "wide.h"

struct eng_wide_owners {
    const struct eng_wide *wide;   /* the trees that they are made for, .. */
    uint32_t assembled;            /* .. as they were then */
    const struct eng_masks *masks; /* NULL: they are not made, or nothing is left out */
    struct eng_wide_owner *of[ENG_WIDE_TREES]; /* [capacity] by block, as the boxes */
    uint32_t capacity[ENG_WIDE_TREES];
    uint32_t version;       /* of the masks that they were made by, .. */
    uint32_t rigid_version; /* .. and of what was known to be crowded (rigid.h) */
};

void eng_wide_owners_deinit(struct eng_wide_owners *owners);
uint64_t eng_wide_owners_bytes(const struct eng_wide_owners *owners);

/* Make the owners anew, O(blocks), before a step, the trees being put together, when the
 * masks have changed, the trees, or what is known to be crowded. No more than a look
 * while nothing can be left out. *has_changed: the masks have. PCCD_E_NOMEM. [compute] */
int eng_wide_owners_prepare(struct eng_wide_owners *owners, const struct eng_wide *wide,
                            const struct eng_scene *scene, bool *has_changed);

/* Return, in a step, whether there is anything to ask. What objects leave out of
 * themselves is known only once their positions are. [any] */
bool eng_wide_owners_are_on(const struct eng_wide_owners *owners);

/* Return whether the step looks for no pair of what is in a block of the lowest level, as
 * it is of an object that turns. [any] */
bool eng_wide_owners_is_apart(const struct eng_wide_owners *owners, enum pccd_tree kind,
                              uint32_t block);

/* Return whether anything below node n may meet anything below node m of a level, of the
 * two trees of a kind of pair (of one tree n == m for a node with itself). [any] */
bool eng_wide_owners_allow(const struct eng_wide_owners *owners, enum pccd_kind kind,
                           uint32_t level, uint32_t n, uint32_t m);

/* Leave in `below`, the pairs of nodes of level - 1 that (n, m) of `level`, which may
 * meet, led to, those that may meet, in their order. [any] */
void eng_wide_owners_keep(const struct eng_wide_owners *owners, enum pccd_kind kind,
                          uint32_t level, uint32_t n, uint32_t m,
                          struct eng_wide_list *below);

#endif

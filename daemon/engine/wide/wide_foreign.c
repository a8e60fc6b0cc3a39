/* daemon/engine/wide/wide_foreign.c - which features of the wide trees are foreign.
 *
 * Room:     engine.
 * Does:     see wide_foreign.h.
 * Threads:  wide_foreign.h.
 */
#include "wide_foreign.h"

/* Features of both sides, either of which may come first. */
static bool has_one_tree(enum pccd_kind kind)
{
    return eng_wide_tree_of(kind, 0) == eng_wide_tree_of(kind, 1);
}

const uint16_t *eng_wide_foreign_marks(const struct eng_wide *wide, enum pccd_kind kind,
                                       int side, uint32_t level)
{
    const struct eng_wide_tree *tree = &wide->trees[eng_wide_tree_of(kind, side)];
    bool may_be_first = side == 0 || has_one_tree(kind);
    return tree->has_own && may_be_first ? tree->own + tree->first[level] : NULL;
}

static bool is_own(const uint16_t *own, uint32_t slot)
{
    return own[slot / ENG_WIDE] >> slot % ENG_WIDE & 1u;
}

uint32_t eng_wide_foreign_keep(const struct eng_wide *wide, enum pccd_kind kind,
                               uint32_t *a, uint32_t *b, uint32_t count)
{
    enum pccd_tree tree = eng_wide_tree_of(kind, 0);
    const uint16_t *own = wide->trees[tree].own;
    uint32_t kept = 0;
    if (!wide->trees[tree].has_own || !has_one_tree(kind)) {
        return count;
    }
    for (uint32_t i = 0; i < count; i++) {
        bool is_own_a = is_own(own, a[i]), is_own_b = is_own(own, b[i]);
        bool stays = is_own_a;
        if (is_own_a != is_own_b) { /* of few; their keys are far apart in memory */
            bool is_a =
                eng_wide_key_of(wide, tree, a[i]) < eng_wide_key_of(wide, tree, b[i]);
            stays = is_a == is_own_a;
        }
        a[kept] = a[i];
        b[kept] = b[i];
        kept += stays;
    }
    return kept;
}

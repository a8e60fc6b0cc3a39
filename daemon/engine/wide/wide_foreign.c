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
        bool is_a = eng_wide_key_of(wide, tree, a[i]) < eng_wide_key_of(wide, tree, b[i]);
        uint32_t first = is_a ? a[i] : b[i];
        a[kept] = a[i];
        b[kept] = b[i];
        kept += own[first / ENG_WIDE] >> first % ENG_WIDE & 1u;
    }
    return kept;
}

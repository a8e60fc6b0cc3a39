/* wide_free.c - which features of the wide trees are free. */
#include "wide_free.h"

uint32_t eng_wide_kinds(const struct eng_wide *wide, bool thick)
{
    bool points = wide->trees[PCCD_TREE_VERTICES].has_free;
    bool edges = wide->trees[PCCD_TREE_EDGES].has_free;
    uint32_t kinds = 1u << PCCD_VF | 1u << PCCD_EE;
    kinds |= thick && points && edges ? 1u << PCCD_VE : 0;
    kinds |= thick && points ? 1u << PCCD_VV : 0;
    return kinds;
}

/* Is child (or slot) i of a level of a tree free, or has it below it what is? */
static bool is_free(const struct eng_wide_tree *tree, uint32_t level, uint32_t i)
{
    return tree->free[tree->first[level] + i / ENG_WIDE] >> i % ENG_WIDE & 1u;
}

uint32_t eng_wide_free_keep(const struct eng_wide *wide, enum pccd_kind kind,
                            uint32_t level, uint32_t *a, uint32_t *b, uint32_t count)
{
    const struct eng_wide_tree *tree_a = &wide->trees[eng_wide_tree_of(kind, 0)];
    const struct eng_wide_tree *tree_b = &wide->trees[eng_wide_tree_of(kind, 1)];
    uint32_t kept = 0;
    for (uint32_t i = 0; i < count; i++) {
        a[kept] = a[i];
        b[kept] = b[i];
        kept += is_free(tree_a, level, a[i]) && is_free(tree_b, level, b[i]);
    }
    return kept;
}

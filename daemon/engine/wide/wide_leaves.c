/* wide_leaves.c - the leaves of one object in one of the wide trees: faces, or what is
 * free of its edges or vertices. */
#include "wide_state.h"

#include "wide_cells.h"

#define BLOCK_BITS 28u /* blocks are fewer than 2^28 */

static_assert(ENG_WIDE_LEVELS_MAX <= ENG_LEAVES_LEVELS_MAX, "levels of opened nodes");

static uint32_t node_of(uint32_t level, uint32_t block)
{
    assert(level < ENG_WIDE_LEVELS_MAX && block < 1u << BLOCK_BITS);
    return level << BLOCK_BITS | block;
}

bool eng_wide_leaves_of(const struct eng_scene *scene, uint32_t object_idx,
                        enum pccd_tree tree, uint32_t end, struct eng_leaves *leaves)
{
    const struct eng_wide *wide = eng_wide_of(scene);
    const struct eng_mesh_info *info = &scene->objects[object_idx].mesh->info;
    const struct eng_wide_object *object =
        eng_wide_object_of(&scene->objects[object_idx]);
    const uint32_t counts[ENG_WIDE_TREES] = {info->free_point_count,
                                             info->free_edge_count, info->triangle_count};
    assert(end <= 1);
    *leaves = (struct eng_leaves){.scene = scene,
                                  .object = object_idx,
                                  .tree = tree,
                                  .end = end,
                                  .root = node_of(wide->level_count - 1, 0),
                                  .first = object->first[tree],
                                  .count = object->order->count[tree]};
    return counts[tree] > 0;
}

/* Boxes in a block, of their whole numbers. */
static void box_below(const struct eng_wide *wide, enum pccd_tree tree, uint32_t block,
                       uint32_t end, struct eng_leaves_below *below)
{
    const struct eng_wide_back back = eng_wide_back_of(&wide->quantising);
    for (int k = 0; k < 3; k++) {
        const uint32_t *row = wide->trees[tree].quantised[block].row[end][k];
        const eng_wide_side none = {0};
        for (uint32_t i = 0; i < ENG_WIDE; i += 4) {
            eng_wide_bits both; /* below: the lower half; above: the upper one */
            memcpy(&both, row + i, sizeof both);
            eng_wide_bits low = eng_wide_distances(
                (both << 16) >> 16, none + back.cell[k], none + back.below[k]);
            eng_wide_bits high = eng_wide_distances(both >> 16, none + back.cell[k],
                                                    none + back.above[k]);
            memcpy(&below->own[0][k][i], &low, sizeof low);
            memcpy(&below->own[1][k][i], &high, sizeof high);
        }
    }
    below->low = (const float(*)[ENG_WIDE])below->own[0];
    below->high = (const float(*)[ENG_WIDE])below->own[1];
}

static void rows_of(const struct eng_wide_block *block, uint32_t end,
                    struct eng_leaves_below *below)
{
    below->low = block->row[ENG_LOW0 + end];
    below->high = block->row[ENG_HIGH0 + end];
}

/* A bit for each of 16 i .. 16 i + 15 that is in first .. last. */
static uint32_t within(uint32_t i, uint32_t first, uint32_t last)
{
    uint32_t begin = i * ENG_WIDE;
    uint32_t low = first > begin ? first - begin : 0;
    uint32_t high = last < begin ? 0 : last - begin + 1;
    high = high < ENG_WIDE ? high : ENG_WIDE;
    return low < high ? (1u << high) - (1u << low) : 0;
}

void eng_wide_leaves_open(const struct eng_leaves *leaves, uint32_t node,
                          struct eng_leaves_below *below)
{
    static_assert(ENG_LOW1 == ENG_LOW0 + 1 && ENG_HIGH1 == ENG_HIGH0 + 1, "ends");
    const struct eng_wide *wide = eng_wide_of(leaves->scene);
    const struct eng_wide_tree *tree = &wide->trees[leaves->tree];
    uint32_t level = node >> BLOCK_BITS;
    uint32_t block = node & ((1u << BLOCK_BITS) - 1);
    uint32_t last = leaves->first + leaves->count - 1;
    uint32_t shift = level * ENG_WIDE_BITS;
    below->children = within(block, leaves->first >> shift, last >> shift);
    if (leaves->tree != PCCD_TREE_FACES) {
        below->children &= tree->free[tree->first[level] + block];
    }
    below->leaves = level == 0 ? below->children : 0;
    if (level > 0) {
        for (uint32_t i = 0; i < ENG_WIDE; i++) {
            below->child[i] = (level - 1) << BLOCK_BITS | (block * ENG_WIDE + i);
        }
    } else {
        for (uint32_t i = 0; i < ENG_WIDE; i++) {
            below->child[i] = block * ENG_WIDE + i;
        }
    }
    if (wide->has_quantised) {
        box_below(wide, leaves->tree, tree->first[level] + block, leaves->end, below);
    } else {
        rows_of(eng_wide_blocks(tree, level) + block, leaves->end, below);
    }
}

uint32_t eng_wide_leaves_index(const struct eng_leaves *leaves, uint32_t node)
{
    return (uint32_t)eng_wide_key_of(eng_wide_of(leaves->scene), leaves->tree, node);
}

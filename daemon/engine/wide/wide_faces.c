/* wide_faces.c - the faces of one object in the wide trees. */
#include "wide_state.h"

#include "wide_cells.h"

#define BLOCK_BITS 28u /* blocks are fewer than 2^28 */

static_assert(ENG_WIDE_LEVELS_MAX <= ENG_FACES_LEVELS_MAX, "levels of opened nodes");

static uint32_t node_of(uint32_t level, uint32_t block)
{
    assert(level < ENG_WIDE_LEVELS_MAX && block < 1u << BLOCK_BITS);
    return level << BLOCK_BITS | block;
}

void eng_wide_faces_of(const struct eng_scene *scene, uint32_t object_idx, uint32_t end,
                       struct eng_faces *faces)
{
    const struct eng_wide *wide = eng_wide_of(scene);
    const struct eng_wide_object *object =
        eng_wide_object_of(&scene->objects[object_idx]);
    assert(end <= 1 && object->order->count[PCCD_TREE_FACES] > 0);
    *faces = (struct eng_faces){.scene = scene,
                                .object = object_idx,
                                .end = end,
                                .root = node_of(wide->level_count - 1, 0),
                                .first = object->first[PCCD_TREE_FACES],
                                .count = object->order->count[PCCD_TREE_FACES]};
}

/* Boxes of the faces in a block of slots, of their whole numbers. */
static void box_faces(const struct eng_wide *wide, uint32_t block, uint32_t end,
                      struct eng_faces_below *below)
{
    const struct eng_quantising *quantising = &wide->quantising;
    for (int k = 0; k < 3; k++) {
        const uint32_t *row = wide->trees[PCCD_TREE_FACES].quantised[block].row[end][k];
        double cell = 1 / (double)quantising->scale[k];
        for (uint32_t i = 0; i < ENG_WIDE; i++) {
            int16_t low = (int16_t)(row[i] & 0xffff);
            int16_t high = (int16_t)(row[i] >> 16);
            below->own[0][k][i] = eng_wide_distance_of(low, cell, quantising->below[k]);
            below->own[1][k][i] = eng_wide_distance_of(high, cell, quantising->above[k]);
        }
    }
    below->low = (const float(*)[ENG_WIDE])below->own[0];
    below->high = (const float(*)[ENG_WIDE])below->own[1];
}

static void rows_of(const struct eng_wide_block *block, uint32_t end,
                    struct eng_faces_below *below)
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

void eng_wide_faces_open(const struct eng_faces *faces, uint32_t node,
                         struct eng_faces_below *below)
{
    static_assert(ENG_LOW1 == ENG_LOW0 + 1 && ENG_HIGH1 == ENG_HIGH0 + 1, "ends");
    const struct eng_wide *wide = eng_wide_of(faces->scene);
    const struct eng_wide_tree *tree = &wide->trees[PCCD_TREE_FACES];
    uint32_t level = node >> BLOCK_BITS;
    uint32_t block = node & ((1u << BLOCK_BITS) - 1);
    uint32_t last = faces->first + faces->count - 1;
    uint32_t shift = level * ENG_WIDE_BITS;
    below->children = within(block, faces->first >> shift, last >> shift);
    below->faces = level == 0 ? below->children : 0;
    if (level > 0) {
        for (uint32_t i = 0; i < ENG_WIDE; i++) {
            below->child[i] = (level - 1) << BLOCK_BITS | (block * ENG_WIDE + i);
        }
        rows_of(eng_wide_blocks(tree, level) + block, faces->end, below);
        return;
    }
    for (uint32_t i = 0; i < ENG_WIDE; i++) {
        below->child[i] = block * ENG_WIDE + i;
    }
    if (wide->has_quantised) {
        box_faces(wide, block, faces->end, below);
    } else {
        rows_of(eng_wide_blocks(tree, 0) + block, faces->end, below);
    }
}

uint32_t eng_wide_faces_index(const struct eng_faces *faces, uint32_t node)
{
    return (uint32_t)eng_wide_of(faces->scene)->trees[PCCD_TREE_FACES].keys[node];
}

/* paper_faces.c - the faces of one object in the binary tree. */
#include "paper_faces.h"

#include <string.h>

#define LEVELS 4u /* of binary nodes that are opened at once */

static_assert(1u << LEVELS == ENG_WIDE &&
                  (ENG_LEVELS_MAX + LEVELS - 1) / LEVELS <= ENG_FACES_LEVELS_MAX,
              "levels");

void eng_paper_faces_of(const struct eng_scene *scene, uint32_t object_idx, uint32_t end,
                        struct eng_faces *faces)
{
    const struct eng_planted *planted = eng_planted_of(&scene->objects[object_idx]);
    assert(end <= 1 && planted->nodes.count > 0);
    *faces = (struct eng_faces){.scene = scene,
                                .object = object_idx,
                                .end = end,
                                .root = planted->nodes.first,
                                .first = planted->triangles.first,
                                .count = planted->triangles.count};
}

static void put_box(const struct eng_node *node, uint32_t end, uint32_t i,
                    struct eng_faces_below *below)
{
    const float *low = end == 0 ? node->lo0 : node->lo1;
    const float *high = end == 0 ? node->hi0 : node->hi1;
    for (int k = 0; k < 3; k++) {
        below->own[0][k][i] = -low[k];
        below->own[1][k][i] = high[k];
    }
}

void eng_paper_faces_open(const struct eng_faces *faces, uint32_t node,
                          struct eng_faces_below *below)
{
    const struct eng_node *nodes = eng_trees_of(faces->scene)->nodes;
    uint32_t count = 1;
    below->child[0] = node;
    for (uint32_t level = 0; level < LEVELS; level++) {
        uint32_t end = count;
        for (uint32_t i = 0; i < end; i++) {
            const struct eng_node *open = &nodes[below->child[i]];
            if (open->left != ENG_LEAF) {
                below->child[i] = open->left;
                below->child[count++] = open->right;
            }
        }
    }
    assert(count <= ENG_WIDE);
    memset(below->own, 0, sizeof below->own);
    below->faces = 0;
    for (uint32_t i = 0; i < count; i++) {
        const struct eng_node *child = &nodes[below->child[i]];
        put_box(child, faces->end, i, below);
        below->faces |= (uint32_t)(child->left == ENG_LEAF) << i;
    }
    below->low = (const float(*)[ENG_WIDE])below->own[0];
    below->high = (const float(*)[ENG_WIDE])below->own[1];
    below->children = (1u << count) - 1;
}

uint32_t eng_paper_faces_index(const struct eng_faces *faces, uint32_t node)
{
    return eng_trees_of(faces->scene)->nodes[node].right - faces->first;
}

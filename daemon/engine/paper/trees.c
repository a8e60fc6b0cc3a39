/* trees.c - the binary hierarchies over the triangles of a scene. */
#include "trees.h"

#include <string.h>

#include "memory.h"

void eng_trees_init(struct eng_trees *trees)
{
    memset(trees, 0, sizeof *trees);
    eng_ranges_init(&trees->edge_ranges, PROTO_COUNT_MAX);
    eng_ranges_init(&trees->triangle_ranges, PROTO_COUNT_MAX);
    eng_ranges_init(&trees->node_ranges, UINT32_MAX - 1);
    trees->root = ENG_NO_NODE;
}

void eng_trees_deinit(struct eng_trees *trees)
{
    eng_ranges_deinit(&trees->edge_ranges);
    eng_ranges_deinit(&trees->triangle_ranges);
    eng_ranges_deinit(&trees->node_ranges);
    eng_free(trees->vertices);
    eng_free(trees->edges);
    eng_free(trees->triangles);
    eng_free(trees->nodes);
    eng_free(trees->upkeep);
    eng_free(trees->top_items);
}

uint64_t eng_trees_bytes(const struct eng_trees *trees)
{
    return (uint64_t)trees->box_capacity * sizeof *trees->vertices +
           (uint64_t)trees->edge_capacity * sizeof *trees->edges +
           (uint64_t)trees->triangle_capacity * sizeof *trees->triangles +
           (uint64_t)trees->node_capacity *
               (sizeof *trees->nodes + sizeof *trees->upkeep) +
           (uint64_t)trees->top_item_capacity * sizeof *trees->top_items;
}

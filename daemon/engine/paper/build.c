/* build.c - the hierarchy of one object, and the tree over the objects.
 *
 * Source: paper sections 6.2 and 7.
 */
#include "build.h"

#include <assert.h>

#include "array.h"
#include "grow.h"
#include "memory.h"

/* Centroids of an object's triangles at its present positions. */
static void list_triangles(const struct eng_scene *scene, struct eng_range triangles,
                           const struct eng_frame *frame, struct eng_split_item *items)
{
    const struct eng_trees *trees = eng_trees_of(scene);
    const double(*x)[3] = (const double(*)[3])scene->x[scene->now];
    for (uint32_t i = 0; i < triangles.count; i++) {
        const uint32_t *v = trees->triangles[triangles.first + i].v;
        for (int k = 0; k < 3; k++) {
            /* Within 1e18 like the corners. */
            double mean = (x[v[0]][k] + x[v[1]][k] + x[v[2]][k]) / 3.0;
            items[i].centroid[k] = (float)eng_frame_at(frame, mean, k);
        }
        items[i].id = triangles.first + i;
    }
}

/* Their boxes. */
static void list_boxes(const struct eng_scene *scene, struct eng_range triangles,
                       const struct eng_frame *frame, struct eng_sah_box *boxes)
{
    const struct eng_trees *trees = eng_trees_of(scene);
    const double(*x)[3] = (const double(*)[3])scene->x[scene->now];
    for (uint32_t i = 0; i < triangles.count; i++) {
        const uint32_t *v = trees->triangles[triangles.first + i].v;
        for (int k = 0; k < 3; k++) {
            double lo = x[v[0]][k] < x[v[1]][k] ? x[v[0]][k] : x[v[1]][k];
            double hi = x[v[0]][k] < x[v[1]][k] ? x[v[1]][k] : x[v[0]][k];
            lo = lo < x[v[2]][k] ? lo : x[v[2]][k];
            hi = hi > x[v[2]][k] ? hi : x[v[2]][k];
            boxes[i].lo[k] = (float)eng_frame_at(frame, lo, k);
            boxes[i].hi[k] = (float)eng_frame_at(frame, hi, k);
        }
    }
}

int eng_build_object(struct eng_scene *scene, uint32_t object_idx)
{
    assert(eng_planted_of(&scene->objects[object_idx])->triangles.count >= 1);
    struct eng_trees *trees = eng_trees_of(scene);
    const struct eng_object *object = &scene->objects[object_idx];
    uint32_t count = eng_planted_of(object)->triangles.count;
    bool by_sah = scene->settings.quality == PCCD_QUALITY_SAH;
    struct eng_split_item *items = eng_alloc(count, sizeof *items);
    struct eng_sah_box *boxes = by_sah ? eng_alloc(count, sizeof *boxes) : NULL;
    if (!items || (by_sah && !boxes)) {
        eng_free(items);
        eng_free(boxes);
        return PCCD_E_NOMEM;
    }
    list_triangles(scene, eng_planted_of(object)->triangles, &object->frame, items);
    if (by_sah) {
        list_boxes(scene, eng_planted_of(object)->triangles, &object->frame, boxes);
    }
    struct eng_grower grower = {
        .items = items,
        .nodes = trees->nodes,
        .sah = {.boxes = boxes, .first_id = eng_planted_of(object)->triangles.first}};
    eng_grow_begin(&grower, count, eng_planted_of(object)->nodes.first,
                   eng_object_levels(scene, count));
    eng_grow(&grower);
    scene->builds++;
    eng_free(items);
    eng_free(boxes);
    return PCCD_OK;
}

uint32_t eng_object_levels(const struct eng_scene *scene, uint32_t triangle_count)
{
    assert(triangle_count >= 1);
    return eng_grow_levels(triangle_count) +
           (scene->settings.quality == PCCD_QUALITY_SAH ? ENG_LEVELS_SPARE : 0);
}

/* The roots of all objects, with the centres of their moving boxes, scaled. */
static uint32_t list_roots(const struct eng_scene *scene, struct eng_split_item *items)
{
    struct eng_trees *trees = eng_trees_of(scene);
    uint32_t count = 0;
    for (uint32_t i = 0; i < scene->object_capacity; i++) {
        if (scene->objects[i].mesh) {
            uint32_t root = eng_planted_of(&scene->objects[i])->nodes.first;
            items[count++] = eng_split_item_of(&trees->nodes[root], root);
        }
    }
    return count;
}

/* Items for that many objects. They stay: the tree is rebuilt within steps. */
static int reserve_items(struct eng_scene *scene, uint32_t count)
{
    struct eng_trees *trees = eng_trees_of(scene);
    if (count <= trees->top_item_capacity) {
        return PCCD_OK;
    }
    uint32_t capacity = eng_array_grown(trees->top_item_capacity, count);
    int status = eng_array_grow(&trees->top_items, capacity, sizeof *trees->top_items);
    if (status == PCCD_OK) {
        trees->top_item_capacity = capacity;
    }
    return status;
}

/* Nodes for the tree over `count` >= 2 objects. */
static int take_nodes(struct eng_scene *scene, uint32_t count, uint32_t *first)
{
    struct eng_trees *trees = eng_trees_of(scene);
    int status = reserve_items(scene, count);
    if (status == PCCD_OK) {
        status = eng_ranges_take(&trees->node_ranges, count - 1, first);
    }
    if (status == PCCD_OK) {
        status = eng_tree_reserve(scene);
        if (status != PCCD_OK) {
            eng_ranges_give(&trees->node_ranges, *first, count - 1);
        }
    }
    return status;
}

int eng_build_top(struct eng_scene *scene)
{
    struct eng_trees *trees = eng_trees_of(scene);
    uint32_t count = scene->object_count;
    uint32_t first = 0;
    if (count > 1) {
        int status = take_nodes(scene, count, &first);
        if (status != PCCD_OK) {
            return status;
        }
    }
    if (trees->top.count > 0) {
        eng_ranges_give(&trees->node_ranges, trees->top.first, trees->top.count);
    }
    trees->top = (struct eng_range){first, count > 1 ? count - 1 : 0};
    trees->root = ENG_NO_NODE;
    if (count > 1) {
        uint32_t found = list_roots(scene, trees->top_items);
        assert(found == count);
        struct eng_grower grower = {
            .items = trees->top_items, .nodes = trees->nodes, .over_roots = true};
        eng_grow_begin(&grower, found, first, eng_grow_levels(found));
        eng_grow(&grower);
        for (uint32_t i = 0; i < trees->top.count; i++) {
            trees->upkeep[first + i].object = ENG_NO_OBJECT;
        }
        trees->root = first;
    } else if (count == 1) {
        struct eng_split_item only;
        list_roots(scene, &only);
        trees->root = only.id;
    }
    trees->top_is_stale = false;
    trees->top_is_fresh = true;
    return PCCD_OK;
}

/* build.c - the hierarchies of the objects come and go, and the tree over them.
 *
 * Source: paper sections 6.2 and 7.
 */
#include "trees.h"

#include <assert.h>
#include <string.h>

#include "grow.h"
#include "memory.h"
#include "rebuild.h"
#include "refit.h"
#include "topology.h"

/* ---- room -------------------------------------------------------------------------- */

static int take(struct eng_ranges *ranges, uint32_t count, struct eng_range *range)
{
    uint32_t first = 0;
    int status = count > 0 ? eng_ranges_take(ranges, count, &first) : PCCD_OK;
    if (status == PCCD_OK) {
        *range = (struct eng_range){first, count};
    }
    return status;
}

static void give(struct eng_ranges *ranges, struct eng_range *range)
{
    if (range->count > 0) {
        eng_ranges_give(ranges, range->first, range->count);
        range->count = 0;
    }
}

void eng_paper_drop_object(struct eng_scene *scene, struct eng_object *object)
{
    struct eng_trees *trees = eng_trees_of(scene);
    struct eng_paper_object *planted = object->slots[ENG_SLOT_PAPER];
    if (planted) {
        give(&trees->edge_ranges, &planted->edges);
        give(&trees->triangle_ranges, &planted->triangles);
        give(&trees->node_ranges, &planted->nodes);
        eng_free(planted);
        object->slots[ENG_SLOT_PAPER] = NULL;
    }
}

/* Up to these ends, and that of the vertices. */
static int reserve_up_to(struct eng_scene *scene, uint32_t edge_end,
                         uint32_t triangle_end, uint32_t node_end)
{
    struct eng_trees *trees = eng_trees_of(scene);
    int status = eng_array_extend(&trees->vertices, &trees->box_capacity,
                                  scene->vertex_ranges.end, sizeof *trees->vertices);
    if (status == PCCD_OK) {
        status = eng_array_extend(&trees->edges, &trees->edge_capacity, edge_end,
                                  sizeof *trees->edges);
    }
    if (status == PCCD_OK) {
        status = eng_array_extend(&trees->triangles, &trees->triangle_capacity,
                                  triangle_end, sizeof *trees->triangles);
    }
    uint32_t upkeep_capacity = trees->node_capacity;
    if (status == PCCD_OK) {
        status = eng_array_extend(&trees->upkeep, &upkeep_capacity, node_end,
                                  sizeof *trees->upkeep);
    }
    if (status == PCCD_OK) {
        status = eng_array_extend(&trees->nodes, &trees->node_capacity, node_end,
                                  sizeof *trees->nodes);
    }
    return status;
}

/* Make room in the arrays of binary hierarchies up to the end of each range allocator.
 * PCCD_E_NOMEM: can be tried again. */
static int reserve_trees(struct eng_scene *scene)
{
    const struct eng_trees *trees = eng_trees_of(scene);
    return reserve_up_to(scene, trees->edge_ranges.end, trees->triangle_ranges.end,
                         trees->node_ranges.end);
}

/* Whatever was taken when this fails, eng_paper_drop_object gives back. */
static int take_all(struct eng_scene *scene, struct eng_object *object)
{
    struct eng_trees *trees = eng_trees_of(scene);
    const struct eng_mesh_info *info = &object->mesh->info;
    struct eng_paper_object *planted = eng_alloc(1, sizeof *planted);
    if (!planted) {
        return PCCD_E_NOMEM;
    }
    *planted = (struct eng_paper_object){0};
    object->slots[ENG_SLOT_PAPER] = planted;
    int status = take(&trees->edge_ranges, info->edge_count, &planted->edges);
    if (status == PCCD_OK) {
        status =
            take(&trees->triangle_ranges, object->mesh->leaf_count, &planted->triangles);
    }
    if (status == PCCD_OK) {
        /* 2n - 1 of n <= 2^31 - 1 fits. */
        status =
            take(&trees->node_ranges, 2 * object->mesh->leaf_count - 1, &planted->nodes);
    }
    return status == PCCD_OK ? reserve_trees(scene) : status;
}

/* The topology with global indices; first_edge: eng_feature_index. */
static void copy_in(struct eng_scene *scene, uint32_t object_idx,
                    const uint32_t *first_edge)
{
    assert(scene->objects[object_idx].mesh);
    struct eng_trees *trees = eng_trees_of(scene);
    const struct eng_object *object = &scene->objects[object_idx];
    const struct eng_mesh *mesh = object->mesh;
    const struct eng_paper_object *planted = eng_paper_object_of(object);
    uint32_t v0 = object->vertices.first;
    uint32_t e0 = planted->edges.first;
    memset(trees->vertices + v0, 0, object->vertices.count * sizeof *trees->vertices);
    for (uint32_t i = 0; i < object->vertices.count; i++) {
        trees->vertices[v0 + i].object = object_idx;
    }
    if (planted->edges.count > 0) {
        memset(trees->edges + e0, 0, planted->edges.count * sizeof *trees->edges);
    }
    for (uint32_t i = 0; i < planted->edges.count; i++) {
        trees->edges[e0 + i].a = v0 + mesh->edges[i][0];
        trees->edges[e0 + i].b = v0 + mesh->edges[i][1];
        trees->edges[e0 + i].object = object_idx;
    }
    for (uint32_t i = 0; i < planted->triangles.count; i++) {
        struct eng_triangle *triangle = &trees->triangles[planted->triangles.first + i];
        const struct eng_face *face = &mesh->leaves[i];
        triangle->owns = face->owns;
        triangle->object = object_idx;
        for (int k = 0; k < 3; k++) {
            uint32_t edge =
                eng_feature_edge(mesh, first_edge, face->v[k], face->v[(k + 1) % 3]);
            triangle->v[k] = v0 + face->v[k];
            triangle->e[k] = edge == ENG_NO_EDGE ? ENG_NO_EDGE : e0 + edge;
            if (eng_mesh_is_foreign(mesh, PCCD_TREE_VERTICES, face->v[k])) {
                triangle->owns |= ENG_FOREIGN_VERTEX(k);
            }
            if (edge != ENG_NO_EDGE && eng_mesh_is_foreign(mesh, PCCD_TREE_EDGES, edge)) {
                triangle->owns |= ENG_FOREIGN_EDGE(k);
            }
        }
    }
    memset(trees->nodes + planted->nodes.first, 0,
           planted->nodes.count * sizeof *trees->nodes);
    for (uint32_t i = 0; i < planted->nodes.count; i++) {
        trees->upkeep[planted->nodes.first + i].object = object_idx;
    }
}

/* ---- one object -------------------------------------------------------------------- */

/* Centroids of an object's triangles at its present positions. */
static void list_triangles(const struct eng_scene *scene, struct eng_range triangles,
                           const struct eng_box_frame *frame,
                           struct eng_split_item *items)
{
    const struct eng_trees *trees = eng_trees_of(scene);
    const double(*x)[3] = (const double(*)[3])scene->x[scene->now];
    for (uint32_t i = 0; i < triangles.count; i++) {
        const uint32_t *v = trees->triangles[triangles.first + i].v;
        for (int k = 0; k < 3; k++) {
            /* Within 1e18 like the corners. */
            double mean = (x[v[0]][k] + x[v[1]][k] + x[v[2]][k]) / 3.0;
            items[i].centroid[k] = (float)eng_box_frame_at(frame, mean, k);
        }
        items[i].id = triangles.first + i;
    }
}

int eng_build_object(struct eng_scene *scene, uint32_t object_idx)
{
    assert(eng_paper_object_of(&scene->objects[object_idx])->triangles.count >= 1);
    const struct eng_object *object = &scene->objects[object_idx];
    const struct eng_paper_object *planted = eng_paper_object_of(object);
    struct eng_split_item *items = eng_alloc(planted->triangles.count, sizeof *items);
    if (!items) {
        return PCCD_E_NOMEM;
    }
    list_triangles(scene, planted->triangles, &object->frame, items);
    struct eng_grower grower = {.items = items, .nodes = eng_trees_of(scene)->nodes};
    eng_grow_begin(&grower, planted->triangles.count, planted->nodes.first);
    eng_grow(&grower);
    scene->builds++;
    eng_free(items);
    return PCCD_OK;
}

/* Boxes of all objects that have hierarchies, where the scene stands, in the frames that
 * they have now. The positions of a step that is staged already wait in the other buffer,
 * which is looked away from. */
static void refit_where_they_stand(struct eng_scene *scene, uint32_t first, uint32_t end)
{
    double(*staged)[3] = scene->x[1 - scene->now];
    scene->x[1 - scene->now] = scene->x[scene->now];
    for (uint32_t i = first; i < end; i++) {
        if (eng_paper_object_of(&scene->objects[i])->nodes.count > 0) {
            eng_refit_object(scene, &scene->objects[i], NULL);
        }
    }
    scene->x[1 - scene->now] = staged;
}

static int plant(struct eng_scene *scene, uint32_t object_idx)
{
    assert(!scene->objects[object_idx].slots[ENG_SLOT_PAPER]);
    struct eng_object *object = &scene->objects[object_idx];
    const struct eng_mesh *mesh = object->mesh;
    uint32_t *first_edge =
        eng_alloc((size_t)mesh->info.vertex_count + 1, sizeof *first_edge);
    if (!first_edge) {
        return PCCD_E_NOMEM;
    }
    int status = take_all(scene, object);
    if (status == PCCD_OK) {
        eng_feature_index(mesh, first_edge);
        copy_in(scene, object_idx, first_edge);
    }
    eng_free(first_edge);
    if (status == PCCD_OK) {
        status = eng_build_object(scene, object_idx);
    }
    if (status != PCCD_OK) {
        eng_paper_drop_object(scene, object);
        return status;
    }
    if (eng_mesh_has_foreign(mesh)) {
        eng_trees_of(scene)->has_foreign = true;
        eng_foreign_mark(eng_trees_of(scene), eng_paper_object_of(object)->nodes);
    }
    refit_where_they_stand(scene, object_idx, object_idx + 1);
    if (!object->is_new) { /* it may stand, and have moved in the step before */
        eng_trees_of(scene)->boxes_of = 0;
    }
    eng_regions_mark(scene, eng_paper_object_of(object)->nodes);
    eng_metric_note_built(scene, eng_paper_object_of(object)->nodes);
    return PCCD_OK;
}

/* At most what a range allocator hands out. */
static uint32_t end_of(const struct eng_ranges *ranges, uint64_t more)
{
    return more < ranges->limit - ranges->end ? ranges->end + (uint32_t)more
                                              : ranges->limit;
}

/* Room for all objects without a hierarchy, and for the nodes above them, at once: one by
 * one, each array would grow past what it needs. */
static int reserve_for(struct eng_scene *scene)
{
    struct eng_trees *trees = eng_trees_of(scene);
    uint64_t edges = 0;
    uint64_t triangles = 0;
    for (uint32_t i = 0; i < scene->object_capacity; i++) {
        const struct eng_object *object = &scene->objects[i];
        if (object->mesh && eng_paper_object_of(object)->nodes.count == 0) {
            edges += object->mesh->info.edge_count;
            triangles += object->mesh->leaf_count;
        }
    }
    if (triangles == 0) {
        return PCCD_OK;
    }
    return reserve_up_to(
        scene, end_of(&trees->edge_ranges, edges),
        end_of(&trees->triangle_ranges, triangles),
        end_of(&trees->node_ranges, 2 * triangles + scene->object_count));
}

int eng_paper_add_objects(struct eng_scene *scene)
{
    struct eng_trees *trees = eng_trees_of(scene);
    int status = reserve_for(scene);
    for (uint32_t i = 0; i < scene->object_capacity && status == PCCD_OK; i++) {
        if (scene->objects[i].mesh &&
            eng_paper_object_of(&scene->objects[i])->nodes.count == 0) {
            status = plant(scene, i);
        }
    }
    if (status == PCCD_OK && (scene->framing.number != trees->frames)) {
        /* Those that had a hierarchy before have boxes in other frames. */
        trees->boxes_of = 0;
        refit_where_they_stand(scene, 0, scene->object_capacity);
    }
    return status;
}

/* ---- the tree over the objects ----------------------------------------------------- */

/* The roots of all objects, with the centres of their moving boxes, scaled. */
static uint32_t list_roots(const struct eng_scene *scene, struct eng_split_item *items)
{
    struct eng_trees *trees = eng_trees_of(scene);
    uint32_t count = 0;
    for (uint32_t i = 0; i < scene->object_capacity; i++) {
        if (scene->objects[i].mesh) {
            uint32_t root = eng_paper_object_of(&scene->objects[i])->nodes.first;
            items[count++] = eng_split_item_of(&trees->nodes[root], root);
        }
    }
    return count;
}

/* Items for that many objects. They stay: the tree is rebuilt within steps. */
static int reserve_items(struct eng_scene *scene, uint32_t count)
{
    struct eng_trees *trees = eng_trees_of(scene);
    return eng_array_extend(&trees->top_items, &trees->top_item_capacity, count,
                            sizeof *trees->top_items);
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
        status = reserve_trees(scene);
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
        eng_grow_begin(&grower, found, first);
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

/* ---- checks ------------------------------------------------------------------------ */

static bool contains(const struct eng_node *outer, const struct eng_node *inner)
{
    for (int k = 0; k < 3; k++) {
        if (!(outer->lo0[k] <= inner->lo0[k] && outer->hi0[k] >= inner->hi0[k] &&
              outer->lo1[k] <= inner->lo1[k] && outer->hi1[k] >= inner->hi1[k])) {
            return false;
        }
    }
    return true;
}

bool eng_tree_has_boxes(const struct eng_scene *scene)
{
    const struct eng_trees *trees = eng_trees_of(scene);
    return !trees->top_is_stale && !trees->boxes_are_old && trees->boxes_of != 0 &&
           trees->boxes_of == scene->moving.number &&
           trees->frames == scene->framing.number &&
           trees->thickness == scene->thickness.number;
}

static bool leaf_contains_triangle(const struct eng_scene *scene,
                                   const struct eng_node *leaf)
{
    const struct eng_trees *trees = eng_trees_of(scene);
    const double(*x0)[3] = (const double(*)[3])scene->x[1 - scene->now];
    const double(*x1)[3] = (const double(*)[3])scene->x[scene->now];
    for (int corner = 0; corner < 3; corner++) {
        uint32_t v = trees->triangles[leaf->right].v[corner];
        struct eng_box point = {.word0 = 0};
        eng_refit_vertex(scene, v, x0[v], x1[v], &point);
        for (int k = 0; k < 3; k++) {
            if (!(leaf->lo0[k] <= point.lo0[k] && point.hi0[k] <= leaf->hi0[k] &&
                  leaf->lo1[k] <= point.lo1[k] && point.hi1[k] <= leaf->hi1[k])) {
                return false;
            }
        }
    }
    return true;
}

static bool validate_node(const struct eng_scene *scene, uint32_t idx)
{
    struct eng_trees *trees = eng_trees_of(scene);
    const struct eng_node *node = &trees->nodes[idx];
    const bool has_boxes = eng_tree_has_boxes(scene);
    if (node->left == ENG_LEAF) {
        return node->count == 1 &&
               (!has_boxes || leaf_contains_triangle(scene, node));
    }
    const struct eng_node *left = &trees->nodes[node->left];
    const struct eng_node *right = &trees->nodes[node->right];
    return node->count == left->count + right->count &&
           (!has_boxes || (contains(node, left) && contains(node, right)));
}

/* A number whose sums tell sets of triangles apart. */
static uint64_t mark_of(uint32_t triangle)
{
    uint64_t z = (triangle + 1) * 0x9e3779b97f4a7c15u;
    return (z ^ z >> 29) * 0xbf58476d1ce4e5b9u;
}

static bool validate_object(const struct eng_scene *scene,
                            const struct eng_object *object)
{
    struct eng_trees *trees = eng_trees_of(scene);
    uint64_t marks = 0;
    uint32_t end = eng_paper_object_of(object)->nodes.first +
                   eng_paper_object_of(object)->nodes.count;
    for (uint32_t i = eng_paper_object_of(object)->nodes.first; i < end; i++) {
        const struct eng_node *node = &trees->nodes[i];
        if (!validate_node(scene, i)) {
            return false;
        }
        if (node->left == ENG_LEAF) {
            marks += mark_of(node->right);
        } else if (node->left != i + 1 || node->right >= end ||
                   node->right != node->left + 2 * trees->nodes[node->left].count - 1) {
            return false;
        }
    }
    for (uint32_t i = 0; i < eng_paper_object_of(object)->triangles.count; i++) {
        marks -= mark_of(eng_paper_object_of(object)->triangles.first + i);
    }
    return marks == 0 && trees->nodes[eng_paper_object_of(object)->nodes.first].count ==
                             eng_paper_object_of(object)->triangles.count;
}

/* Check that the gates of an object's nodes are at the roots of its regions, and there
 * alone. */
static bool validate_regions(const struct eng_scene *scene,
                             const struct eng_object *object)
{
    struct eng_trees *trees = eng_trees_of(scene);
    uint32_t end = eng_paper_object_of(object)->nodes.first +
                   eng_paper_object_of(object)->nodes.count;
    uint32_t region_end =
        eng_paper_object_of(object)->nodes.first; /* of the region walked through last */
    bool any = scene->settings.rebuild_ratio > 0;
    for (uint32_t i = eng_paper_object_of(object)->nodes.first; i < end; i++) {
        const struct eng_node *node = &trees->nodes[i];
        bool is_high = node->count > scene->settings.region_triangles;
        bool is_root = !is_high && i >= region_end;
        bool has_gate = any && is_root && node->count >= ENG_EXAMINE_MIN;
        if (node->gate != (has_gate ? ENG_GATE_REGION : ENG_GATE_NONE) ||
            (is_high && i < region_end) ||
            (node->foreign && !eng_node_is_foreign(trees, node))) {
            return false;
        }
        if (is_root) {
            region_end = i + 2 * node->count - 1;
        }
        /* Nobody may hold a gate between steps: it is an odd number then. */
        if (has_gate &&
            atomic_load_explicit(&trees->upkeep[i].gate, memory_order_relaxed) % 2 == 0) {
            return false;
        }
    }
    return true;
}

bool eng_tree_validate(const struct eng_scene *scene)
{
    const struct eng_trees *trees = eng_trees_of(scene);
    uint64_t triangles = 0;
    for (uint32_t i = 0; i < scene->object_capacity; i++) {
        const struct eng_object *object = &scene->objects[i];
        if (object->mesh) {
            triangles += eng_paper_object_of(object)->triangles.count;
            if (!validate_object(scene, object) || !validate_regions(scene, object)) {
                return false;
            }
        }
    }
    for (uint32_t i = 0; i < trees->top.count; i++) {
        if (!validate_node(scene, trees->top.first + i)) {
            return false;
        }
    }
    return trees->root == ENG_NO_NODE ? triangles == 0
                                      : trees->nodes[trees->root].count == triangles;
}

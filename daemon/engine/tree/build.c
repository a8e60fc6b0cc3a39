/* build.c - the hierarchy of one object, and the tree over the objects.
 *
 * Room:     engine.
 * Does:     one routine splits any list of items with centroids; a subtree of n items
 *           takes the 2n - 1 nodes that follow each other in pre-order, so the place of
 *           every node is known before it is built.
 * Threads:  [compute].
 * Source:   paper sections 6.2 and 7.
 */
#include "build.h"

#include <string.h>

#include "median.h"
#include "memory.h"

/* Median splits halve the count: 2^32 items are 33 levels; the other half of
 * each waits. */
#define STACK_MAX 64

/* A subtree to be built: items[first .. first+count-1] into the nodes from `node` on. */
struct job {
    uint32_t first;
    uint32_t count;
    uint32_t node;
};

/* Where leaves come from: with `leaf_step` 2 a leaf is a node of its own; with 1 the leaf
 * is an existing root and only inner nodes are placed. */
struct builder {
    struct eng_scene *scene;
    struct eng_split_item *items;
    bool over_objects;
    uint32_t object; /* for eng_node.object */
};

static int longest_axis(const struct eng_split_item *items, uint32_t count)
{
    float lo[3];
    float hi[3];
    memcpy(lo, items[0].centroid, sizeof lo);
    memcpy(hi, items[0].centroid, sizeof hi);
    for (uint32_t i = 1; i < count; i++) {
        for (int k = 0; k < 3; k++) {
            lo[k] = items[i].centroid[k] < lo[k] ? items[i].centroid[k] : lo[k];
            hi[k] = items[i].centroid[k] > hi[k] ? items[i].centroid[k] : hi[k];
        }
    }
    int axis = 0;
    for (int k = 1; k < 3; k++) {
        if (hi[k] - lo[k] > hi[axis] - lo[axis]) {
            axis = k;
        }
    }
    return axis;
}

/* Nodes that a subtree of `count` items occupies. */
static uint32_t nodes_of(const struct builder *builder, uint32_t count)
{
    return builder->over_objects ? count - 1 : 2 * count - 1;
}

static uint32_t triangles_below(const struct builder *builder,
                                const struct eng_split_item *items, uint32_t count)
{
    if (!builder->over_objects) {
        return count;
    }
    uint32_t sum = 0;
    for (uint32_t i = 0; i < count; i++) {
        sum += builder->scene->nodes[items[i].id].count;
    }
    return sum;
}

/* The node for the child subtree [first, count) and, unless it is complete, its job. */
static uint32_t place_child(const struct builder *builder, struct job *stack,
                            uint32_t *stack_count, struct job child)
{
    if (builder->over_objects && child.count == 1) {
        return builder->items[child.first].id;
    }
    assert(*stack_count < STACK_MAX);
    stack[(*stack_count)++] = child;
    return child.node;
}

static void build(const struct builder *builder, uint32_t count, uint32_t root)
{
    struct job stack[STACK_MAX];
    uint32_t stack_count = 0;
    stack[stack_count++] = (struct job){0, count, root};
    while (stack_count > 0) {
        struct job job = stack[--stack_count];
        struct eng_split_item *items = builder->items + job.first;
        struct eng_node *node = &builder->scene->nodes[job.node];
        node->count = triangles_below(builder, items, job.count);
        node->object = builder->object;
        if (job.count == 1) {
            node->left = ENG_LEAF;
            node->right = items[0].id;
            continue;
        }
        uint32_t half = job.count / 2;
        eng_median_split(items, job.count, half, longest_axis(items, job.count));
        struct job left = {job.first, half, job.node + 1};
        struct job right = {job.first + half, job.count - half,
                            job.node + 1 + nodes_of(builder, half)};
        node->left = place_child(builder, stack, &stack_count, left);
        node->right = place_child(builder, stack, &stack_count, right);
    }
}

int eng_build_object(struct eng_scene *scene, uint32_t object_idx)
{
    const struct eng_object *object = &scene->objects[object_idx];
    uint32_t count = object->triangles.count;
    struct eng_split_item *items = eng_alloc(count, sizeof *items);
    if (!items) {
        return ENG_E_NOMEM;
    }
    const double(*x)[3] = (const double(*)[3])scene->x[scene->now];
    for (uint32_t i = 0; i < count; i++) {
        uint32_t t = object->triangles.first + i;
        const uint32_t *v = scene->triangles[t].v;
        for (int k = 0; k < 3; k++) {
            /* Scaled sum: only the order matters, and 3e18 must not overflow a float. */
            items[i].centroid[k] = (float)((x[v[0]][k] + x[v[1]][k] + x[v[2]][k]) / 3.0);
        }
        items[i].id = t;
    }
    struct builder builder = {scene, items, false, object_idx};
    build(&builder, count, object->nodes.first);
    scene->builds++;
    eng_free(items);
    return ENG_OK;
}

/* Collect the roots of all objects; returns their number. */
static uint32_t collect_roots(const struct eng_scene *scene, struct eng_split_item *items)
{
    uint32_t count = 0;
    for (uint32_t i = 0; i < scene->object_capacity; i++) {
        if (!scene->objects[i].mesh) {
            continue;
        }
        uint32_t root = scene->objects[i].nodes.first;
        const struct eng_node *node = &scene->nodes[root];
        for (int k = 0; k < 3; k++) {
            items[count].centroid[k] =
                0.25f * (node->lo0[k] + node->hi0[k] + node->lo1[k] + node->hi1[k]);
        }
        items[count++].id = root;
    }
    return count;
}

int eng_build_top(struct eng_scene *scene)
{
    uint32_t count = scene->object_count;
    uint32_t first = 0;
    struct eng_split_item *items = NULL;
    if (count > 1) {
        items = eng_alloc(count, sizeof *items);
        if (!items) {
            return ENG_E_NOMEM;
        }
        int status = eng_ranges_take(&scene->node_ranges, count - 1, &first);
        if (status == ENG_OK) {
            status = eng_world_reserve(scene);
            if (status != ENG_OK) {
                eng_ranges_give(&scene->node_ranges, first, count - 1);
            }
        }
        if (status != ENG_OK) {
            eng_free(items);
            return status;
        }
    }
    if (scene->top.count > 0) {
        eng_ranges_give(&scene->node_ranges, scene->top.first, scene->top.count);
    }
    scene->top = (struct eng_range){first, count > 1 ? count - 1 : 0};
    scene->root = ENG_NO_NODE;
    if (count > 1) {
        struct builder builder = {scene, items, true, UINT32_MAX};
        uint32_t found = collect_roots(scene, items);
        assert(found == count);
        build(&builder, found, first);
        scene->root = first;
    } else if (count == 1) {
        struct eng_split_item only;
        collect_roots(scene, &only);
        scene->root = only.id;
    }
    eng_free(items);
    scene->top_is_stale = false;
    return ENG_OK;
}

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

static bool leaf_contains_triangle(const struct eng_scene *scene,
                                   const struct eng_node *leaf)
{
    const double(*x0)[3] = (const double(*)[3])scene->x[1 - scene->now];
    const double(*x1)[3] = (const double(*)[3])scene->x[scene->now];
    for (int corner = 0; corner < 3; corner++) {
        uint32_t v = scene->triangles[leaf->right].v[corner];
        for (int k = 0; k < 3; k++) {
            if (!((double)leaf->lo0[k] <= x0[v][k] && x0[v][k] <= (double)leaf->hi0[k] &&
                  (double)leaf->lo1[k] <= x1[v][k] && x1[v][k] <= (double)leaf->hi1[k])) {
                return false;
            }
        }
    }
    return true;
}

static bool validate_node(const struct eng_scene *scene, uint32_t idx)
{
    const struct eng_node *node = &scene->nodes[idx];
    if (node->left == ENG_LEAF) {
        return node->count == 1 && leaf_contains_triangle(scene, node);
    }
    const struct eng_node *left = &scene->nodes[node->left];
    const struct eng_node *right = &scene->nodes[node->right];
    return node->count == left->count + right->count && contains(node, left) &&
           contains(node, right);
}

static bool validate_object(const struct eng_scene *scene,
                            const struct eng_object *object)
{
    uint64_t leaf_sum = 0;
    uint64_t leaves = 0;
    uint32_t end = object->nodes.first + object->nodes.count;
    for (uint32_t i = object->nodes.first; i < end; i++) {
        const struct eng_node *node = &scene->nodes[i];
        if (!validate_node(scene, i)) {
            return false;
        }
        if (node->left == ENG_LEAF) {
            leaf_sum += node->right - object->triangles.first;
            leaves++;
        } else if (node->left <= i || node->right <= i || node->left >= end ||
                   node->right >= end) {
            return false;
        }
    }
    uint64_t n = object->triangles.count;
    return leaves == n && leaf_sum == n * (n - 1) / 2;
}

bool eng_tree_validate(const struct eng_scene *scene)
{
    uint64_t triangles = 0;
    for (uint32_t i = 0; i < scene->object_capacity; i++) {
        const struct eng_object *object = &scene->objects[i];
        if (object->mesh) {
            triangles += object->triangles.count;
            if (!validate_object(scene, object)) {
                return false;
            }
        }
    }
    for (uint32_t i = 0; i < scene->top.count; i++) {
        if (!validate_node(scene, scene->top.first + i)) {
            return false;
        }
    }
    return scene->root == ENG_NO_NODE ? triangles == 0
                                      : scene->nodes[scene->root].count == triangles;
}

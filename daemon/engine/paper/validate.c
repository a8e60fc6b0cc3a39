/* validate.c - checks of whole hierarchies. */
#include "build.h"
#include "rebuild.h"
#include "refit.h"

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
    if (node->left == ENG_LEAF) {
        return node->count == 1 && leaf_contains_triangle(scene, node);
    }
    const struct eng_node *left = &trees->nodes[node->left];
    const struct eng_node *right = &trees->nodes[node->right];
    return node->count == left->count + right->count && contains(node, left) &&
           contains(node, right);
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
    uint32_t end =
        eng_planted_of(object)->nodes.first + eng_planted_of(object)->nodes.count;
    for (uint32_t i = eng_planted_of(object)->nodes.first; i < end; i++) {
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
    for (uint32_t i = 0; i < eng_planted_of(object)->triangles.count; i++) {
        marks -= mark_of(eng_planted_of(object)->triangles.first + i);
    }
    return marks == 0 && trees->nodes[eng_planted_of(object)->nodes.first].count ==
                             eng_planted_of(object)->triangles.count;
}

/* Are the gates of an object's nodes at the roots of its regions, and there alone? */
static bool validate_regions(const struct eng_scene *scene,
                             const struct eng_object *object)
{
    struct eng_trees *trees = eng_trees_of(scene);
    uint32_t end =
        eng_planted_of(object)->nodes.first + eng_planted_of(object)->nodes.count;
    uint32_t region_end =
        eng_planted_of(object)->nodes.first; /* of the region walked through last */
    bool any = scene->settings.rebuild_ratio > 0;
    for (uint32_t i = eng_planted_of(object)->nodes.first; i < end; i++) {
        const struct eng_node *node = &trees->nodes[i];
        bool is_high = node->count > scene->settings.rebuild_triangles_max;
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
            triangles += eng_planted_of(object)->triangles.count;
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

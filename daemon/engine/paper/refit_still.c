/* refit_still.c - marks of what moves, and boxes of that alone. */
#include "refit_still.h"

#include "moving.h"
#include "refit_box.h"
#include "subtree.h"

/* ---- before the refit -------------------------------------------------------------- */

/* Marks begin anew. Other records get theirs when an object is planted. */
static void forget_marks(const struct eng_scene *scene)
{
    struct eng_trees *trees = eng_trees_of(scene);
    assert(scene->vertex_ranges.end <= trees->box_capacity);
    for (uint32_t i = 0; i < scene->vertex_ranges.end; i++) {
        trees->vertices[i].moved = 0;
    }
    for (uint32_t i = 0; i < trees->edge_ranges.end; i++) {
        trees->edges[i].moved = 0;
    }
    for (uint32_t i = 0; i < trees->node_ranges.end; i++) {
        trees->nodes[i].moved = 0;
    }
}

void eng_still_begin(struct eng_scene *scene, bool keeps, bool prunes)
{
    struct eng_trees *trees = eng_trees_of(scene);
    trees->boxes_of = scene->moving.number;
    trees->keeps = keeps;
    trees->marks = keeps || prunes;
    if (trees->marks && trees->mark++ == ENG_MARK_MAX) {
        forget_marks(scene);
        trees->mark = 1;
    }
}

/* ---- vertices, edges --------------------------------------------------------------- */

/* Those that are an object's own. */
static uint32_t refit_own_vertices(struct eng_scene *scene,
                                   const struct eng_object *object,
                                   struct eng_range range)
{
    struct eng_trees *trees = eng_trees_of(scene);
    const double(*x0)[3] = (const double(*)[3])scene->x[1 - scene->now];
    const double(*x1)[3] = (const double(*)[3])scene->x[scene->now];
    uint32_t kept = 0;
    if (object->movement == ENG_STANDS && trees->keeps) {
        return range.count;
    }
    for (uint32_t v = range.first; v < range.first + range.count; v++) {
        if (eng_moves_vertex(scene, object, v - object->vertices.first)) {
            trees->vertices[v].moved = trees->mark;
        } else if (trees->keeps) {
            kept++;
            continue;
        }
        eng_refit_vertex(scene, v, x0[v], x1[v], eng_box_of(&trees->vertices[v]));
    }
    return kept;
}

static uint32_t refit_own_edges(struct eng_scene *scene, const struct eng_object *object,
                                struct eng_range range)
{
    struct eng_trees *trees = eng_trees_of(scene);
    uint32_t kept = 0;
    if (object->movement == ENG_STANDS && trees->keeps) {
        return range.count;
    }
    for (uint32_t e = range.first; e < range.first + range.count; e++) {
        struct eng_edge *edge = &trees->edges[e];
        if (trees->vertices[edge->a].moved == trees->mark ||
            trees->vertices[edge->b].moved == trees->mark) {
            edge->moved = trees->mark;
        } else if (trees->keeps) {
            kept++;
            continue;
        }
        eng_refit_edge(trees, e);
    }
    return kept;
}

/* The beginning of `range` that is in `own`, which its first is in; it is taken away. */
static struct eng_range take_own(struct eng_range *range, struct eng_range own)
{
    uint32_t left = own.count - (range->first - own.first);
    struct eng_range taken = {range->first, left < range->count ? left : range->count};
    assert(range->first - own.first < own.count);
    range->first += taken.count;
    range->count -= taken.count;
    return taken;
}

uint64_t eng_still_refit_vertices(struct eng_scene *scene, struct eng_range range)
{
    const struct eng_trees *trees = eng_trees_of(scene);
    uint64_t kept = 0;
    while (range.count > 0) {
        const struct eng_object *object =
            &scene->objects[trees->vertices[range.first].object];
        kept += refit_own_vertices(scene, object, take_own(&range, object->vertices));
    }
    return kept;
}

uint64_t eng_still_refit_edges(struct eng_scene *scene, struct eng_range range)
{
    const struct eng_trees *trees = eng_trees_of(scene);
    uint64_t kept = 0;
    while (range.count > 0) {
        const struct eng_object *object =
            &scene->objects[trees->edges[range.first].object];
        kept += refit_own_edges(scene, object,
                                take_own(&range, eng_planted_of(object)->edges));
    }
    return kept;
}

/* ---- nodes ------------------------------------------------------------------------- */

/* Does what a node is made of move? */
static bool has_moved(const struct eng_trees *trees, const struct eng_node *node)
{
    if (node->left != ENG_LEAF) {
        return trees->nodes[node->left].moved == trees->mark ||
               trees->nodes[node->right].moved == trees->mark;
    }
    const uint32_t *v = trees->triangles[node->right].v;
    return trees->vertices[v[0]].moved == trees->mark ||
           trees->vertices[v[1]].moved == trees->mark ||
           trees->vertices[v[2]].moved == trees->mark;
}

void eng_still_refit_anew(struct eng_scene *scene, struct eng_range nodes)
{
    struct eng_trees *trees = eng_trees_of(scene);
    for (uint32_t i = nodes.count; i-- > 0;) {
        struct eng_node *node = &trees->nodes[nodes.first + i];
        eng_refit_node(trees, nodes.first + i);
        if (trees->marks) {
            node->moved = (uint16_t)(has_moved(trees, node) ? trees->mark : 0);
        }
        if (trees->has_foreign) {
            node->foreign = eng_node_is_foreign(trees, node);
        }
    }
}

/* Nodes of an object, whole subtrees. */
static uint32_t refit_own_nodes(struct eng_scene *scene, const struct eng_object *object,
                                struct eng_range range)
{
    struct eng_trees *trees = eng_trees_of(scene);
    uint32_t kept = 0;
    if (object->movement == ENG_STANDS && trees->keeps) {
        return (range.count + 1) / 2; /* leaves */
    }
    for (uint32_t i = range.count; i-- > 0;) {
        struct eng_node *node = &trees->nodes[range.first + i];
        if (has_moved(trees, node)) {
            node->moved = (uint16_t)trees->mark;
        } else if (trees->keeps) {
            kept += node->left == ENG_LEAF;
            continue;
        }
        eng_refit_node(trees, range.first + i);
    }
    return kept;
}

static uint32_t refit_child(struct eng_scene *scene, uint32_t root)
{
    const struct eng_trees *trees = eng_trees_of(scene);
    if (eng_is_above_objects(scene, root)) {
        return 0;
    }
    return refit_own_nodes(scene, &scene->objects[trees->upkeep[root].object],
                           eng_subtree_in_object(scene, root));
}

uint64_t eng_still_refit_subtree(struct eng_scene *scene, uint32_t root)
{
    const struct eng_trees *trees = eng_trees_of(scene);
    if (!eng_is_above_objects(scene, root)) {
        return refit_child(scene, root);
    }
    struct eng_range range = eng_subtree_above_objects(scene, root);
    uint64_t kept = 0;
    for (uint32_t i = range.count; i-- > 0;) {
        const struct eng_node *node = &trees->nodes[range.first + i];
        kept += refit_child(scene, node->left);
        kept += refit_child(scene, node->right);
        /* The tree over the objects may have been built since the last step. */
        eng_still_refit_anew(scene, (struct eng_range){range.first + i, 1});
    }
    return kept;
}

uint64_t eng_still_refit(struct eng_scene *scene)
{
    const struct eng_trees *trees = eng_trees_of(scene);
    uint64_t kept = 0;
    for (uint32_t i = 0; i < scene->object_capacity; i++) {
        const struct eng_object *object = &scene->objects[i];
        if (!object->mesh) {
            continue;
        }
        const struct eng_planted *planted = eng_planted_of(object);
        kept += refit_own_vertices(scene, object, object->vertices);
        kept += refit_own_edges(scene, object, planted->edges);
        kept += refit_own_nodes(scene, object, planted->nodes);
    }
    eng_still_refit_anew(scene, trees->top);
    return kept;
}

/* daemon/engine/refit.c - bottom-up update of every box.
 *
 * Room:     engine.
 * Does:     vertices from positions with directed rounding, edges and leaves from vertices,
 *           inner nodes from children: pre-order means that walking a node range backwards
 *           meets children before parents.
 * Threads:  [compute].
 * Source:   paper section 6.1.
 */
#include "refit.h"

static void refit_vertices(struct eng_scene *scene, struct eng_range range)
{
    const double(*x0)[3] = (const double(*)[3])scene->x[1 - scene->now];
    const double(*x1)[3] = (const double(*)[3])scene->x[scene->now];
    for (uint32_t v = range.first; v < range.first + range.count; v++) {
        eng_box_of_point(eng_box_of(&scene->vertices[v]), x0[v], x1[v]);
    }
}

static void refit_edges(struct eng_scene *scene, struct eng_range range)
{
    for (uint32_t e = range.first; e < range.first + range.count; e++) {
        struct eng_edge *edge = &scene->edges[e];
        eng_box_unite(eng_box_of(edge), eng_box_of(&scene->vertices[edge->a]),
                      eng_box_of(&scene->vertices[edge->b]));
    }
}

static void refit_nodes(struct eng_scene *scene, struct eng_range range)
{
    for (uint32_t i = range.count; i-- > 0;) {
        struct eng_node *node = &scene->nodes[range.first + i];
        struct eng_box *box = eng_box_of(node);
        if (node->left == ENG_LEAF) {
            const uint32_t *v = scene->triangles[node->right].v;
            eng_box_unite(box, eng_box_of(&scene->vertices[v[0]]),
                          eng_box_of(&scene->vertices[v[1]]));
            eng_box_unite(box, box, eng_box_of(&scene->vertices[v[2]]));
        } else {
            eng_box_unite(box, eng_box_of(&scene->nodes[node->left]),
                          eng_box_of(&scene->nodes[node->right]));
        }
    }
}

void eng_refit_object(struct eng_scene *scene, const struct eng_object *object)
{
    refit_vertices(scene, object->vertices);
    refit_edges(scene, object->edges);
    refit_nodes(scene, object->nodes);
}

void eng_refit(struct eng_scene *scene)
{
    for (uint32_t i = 0; i < scene->object_capacity; i++) {
        if (scene->objects[i].mesh) {
            eng_refit_object(scene, &scene->objects[i]);
        }
    }
    refit_nodes(scene, scene->top);
}

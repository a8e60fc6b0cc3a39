/* daemon/engine/tree/refit.c - bottom-up update of every box.
 *
 * Room:     engine.
 * Does:     vertices from positions with directed rounding, edges and leaves from
 *           vertices, inner nodes from children: pre-order means that walking a node
 *           range backwards meets children before parents.
 * Threads:  [compute].
 * Source:   paper section 6.1.
 */
#include "refit.h"

#include <string.h>

#include "memory.h"

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

static void refit_node(struct eng_scene *scene, uint32_t idx)
{
    struct eng_node *node = &scene->nodes[idx];
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

static void refit_nodes(struct eng_scene *scene, struct eng_range range)
{
    for (uint32_t i = range.count; i-- > 0;) {
        refit_node(scene, range.first + i);
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

void eng_refit_plan_deinit(struct eng_refit_plan *plan)
{
    eng_free(plan->nodes);
    memset(plan, 0, sizeof *plan);
}

int eng_refit_plan(struct eng_refit_plan *plan, const struct eng_scene *scene,
                   uint32_t wanted)
{
    uint32_t capacity = scene->object_count + 2 * wanted; /* opening one adds two */
    if (capacity > plan->capacity) {
        uint32_t *nodes = eng_alloc(capacity, sizeof *nodes);
        if (!nodes) {
            return ENG_E_NOMEM;
        }
        eng_refit_plan_deinit(plan);
        plan->nodes = nodes;
        plan->capacity = capacity;
    }
    plan->opened = 0;
    plan->count = 0;
    for (uint32_t i = 0; i < scene->object_capacity; i++) {
        if (scene->objects[i].mesh) {
            plan->nodes[plan->count++] = scene->objects[i].nodes.first;
        }
    }
    while (plan->opened < plan->count && plan->count - plan->opened < wanted) {
        const struct eng_node *node = &scene->nodes[plan->nodes[plan->opened++]];
        if (node->left != ENG_LEAF) {
            plan->nodes[plan->count++] = node->left;
            plan->nodes[plan->count++] = node->right;
        }
    }
    return ENG_OK;
}

/* Every thread's even share of a range. */
static struct eng_range share_of(struct eng_range range, uint32_t thread,
                                 uint32_t threads)
{
    uint64_t begin = (uint64_t)range.count * thread / threads;
    uint64_t end = (uint64_t)range.count * (thread + 1) / threads;
    return (struct eng_range){range.first + (uint32_t)begin, (uint32_t)(end - begin)};
}

static void refit_subtrees(struct eng_team *team)
{
    struct eng_scene *scene = team->scene;
    const struct eng_refit_plan *plan = team->plan;
    for (;;) {
        uint32_t i = plan->opened + atomic_fetch_add_explicit(&team->next_subtree, 1,
                                                              memory_order_relaxed);
        if (i >= plan->count) {
            break;
        }
        uint32_t root = plan->nodes[i];
        refit_nodes(scene, (struct eng_range){root, 2 * scene->nodes[root].count - 1});
    }
}

/* A part of the refit is done, its work begun at `begin_ns`. */
static void end_part(struct eng_worker *worker, uint64_t begin_ns)
{
    worker->record.refit_ns += eng_now_ns() - begin_ns;
    eng_worker_trace(worker, ENG_TRACE_REFIT, begin_ns, 0, 0);
}

void eng_refit_by_team(struct eng_team *team, struct eng_worker *worker)
{
    struct eng_scene *scene = team->scene;
    const struct eng_refit_plan *plan = team->plan;
    uint32_t thread = worker->thread;
    uint64_t begin_ns = eng_now_ns();
    for (uint32_t i = 0; i < scene->object_capacity; i++) {
        if (scene->objects[i].mesh) {
            refit_vertices(scene,
                           share_of(scene->objects[i].vertices, thread, team->count));
        }
    }
    end_part(worker, begin_ns);
    eng_worker_barrier(worker);
    begin_ns = eng_now_ns();
    for (uint32_t i = 0; i < scene->object_capacity; i++) {
        if (scene->objects[i].mesh) {
            refit_edges(scene, share_of(scene->objects[i].edges, thread, team->count));
        }
    }
    /* Boxes of nodes need those of vertices only, so no barrier before them. */
    refit_subtrees(team);
    end_part(worker, begin_ns);
    eng_worker_barrier(worker);
    if (thread == 0) {
        begin_ns = eng_now_ns();
        for (uint32_t i = plan->opened; i-- > 0;) {
            refit_node(scene, plan->nodes[i]);
        }
        refit_nodes(scene, scene->top);
        end_part(worker, begin_ns);
    }
}

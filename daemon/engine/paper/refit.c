/* refit.c - bottom-up update of every box.
 *
 * Vertices from positions with directed rounding, edges and leaves from vertices, inner
 * nodes from children: pre-order means that walking a node range backwards meets children
 * before parents.
 *
 * Source: paper section 6.1.
 *
 * By a team: chunks of vertices on demand; when all are done, which need not mean that
 * all threads are there, subtrees, then chunks of edges, which fill the gaps. Leaves
 * could take their boxes from positions, and those of the features that their triangle
 * owns on the way: one pass per subtree, nothing to wait for in between. It takes twice
 * the time (a corner is rounded six times, edges are written in the order of the leaves),
 * 1.65 times with SSE2, so it loses on any number of threads.
 */
#include "refit.h"

#include <assert.h>
#include <omp.h>

#include "refit_still.h"
#include "subtree.h"
#include "wait.h"

void eng_refit_vertices(struct eng_scene *scene, struct eng_range range)
{
    struct eng_trees *trees = eng_trees_of(scene);
    const double(*x0)[3] = (const double(*)[3])scene->x[1 - scene->now];
    const double(*x1)[3] = (const double(*)[3])scene->x[scene->now];
    for (uint32_t v = range.first; v < range.first + range.count; v++) {
        eng_refit_vertex(scene, v, x0[v], x1[v], eng_box_of(&trees->vertices[v]));
    }
}

void eng_refit_edges(struct eng_scene *scene, struct eng_range range)
{
    struct eng_trees *trees = eng_trees_of(scene);
    for (uint32_t e = range.first; e < range.first + range.count; e++) {
        eng_refit_edge(trees, e);
    }
}

void eng_refit_nodes(struct eng_scene *scene, struct eng_range range)
{
    struct eng_trees *trees = eng_trees_of(scene);
    for (uint32_t i = range.count; i-- > 0;) {
        eng_refit_node(trees, range.first + i);
    }
}

static void refit_child(struct eng_scene *scene, uint32_t idx)
{
    if (!eng_is_above_objects(scene, idx)) {
        eng_refit_nodes(scene, eng_subtree_in_object(scene, idx));
    }
}

void eng_refit_subtree(struct eng_scene *scene, uint32_t root)
{
    struct eng_trees *trees = eng_trees_of(scene);
    if (!eng_is_above_objects(scene, root)) {
        eng_refit_nodes(scene, eng_subtree_in_object(scene, root));
        return;
    }
    struct eng_range range = eng_subtree_above_objects(scene, root);
    for (uint32_t i = range.count; i-- > 0;) {
        const struct eng_node *node = &trees->nodes[range.first + i];
        refit_child(scene, node->left);
        refit_child(scene, node->right);
        eng_refit_node(trees, range.first + i);
    }
}

void eng_refit_object(struct eng_scene *scene, const struct eng_object *object)
{
    eng_refit_vertices(scene, object->vertices);
    eng_refit_edges(scene, eng_planted_of(object)->edges);
    eng_refit_nodes(scene, eng_planted_of(object)->nodes);
}

void eng_refit(struct eng_scene *scene)
{
    const struct eng_trees *trees = eng_trees_of(scene);
    for (uint32_t i = 0; i < scene->object_capacity; i++) {
        if (scene->objects[i].mesh) {
            eng_refit_object(scene, &scene->objects[i]);
        }
    }
    eng_refit_nodes(scene, trees->top);
}

/* Relaxed: what is taken was made before the region. */
static uint32_t next(atomic_uint *counter)
{
    return atomic_fetch_add_explicit(counter, 1, memory_order_relaxed);
}

/* Vertices until none are left to take. */
static void vertices_by_team(struct eng_team *team, struct eng_worker *worker,
                             const struct eng_refit_plan *plan)
{
    const struct eng_refit_chunks *chunks = &plan->vertices;
    struct eng_refit_progress *progress = &team->refit;
    for (uint32_t i = next(&progress->next_vertices); i < chunks->count;
         i = next(&progress->next_vertices)) {
        if (eng_trees_of(team->scene)->marks) {
            worker->tally.still_features +=
                eng_still_refit_vertices(team->scene, chunks->ranges[i]);
        } else {
            eng_refit_vertices(team->scene, chunks->ranges[i]);
        }
        /* Release: pairs with the acquire of the wait. */
        atomic_fetch_add_explicit(&progress->vertices_done, 1, memory_order_acq_rel);
    }
}

/* Roots that are dealt out in turn, then the next one that nobody has taken; beyond the
 * last: none. `turn` counts what this thread was dealt. */
static uint32_t next_root(struct eng_team *team, const struct eng_refit_plan *plan,
                          uint32_t *turn)
{
    uint32_t dealt =
        (uint32_t)omp_get_thread_num() + *turn * (uint32_t)omp_get_num_threads();
    if (dealt < plan->dealt) {
        ++*turn;
        return dealt;
    }
    return plan->dealt + next(&team->refit.next_root);
}

/* Root `i` is up to date: go on with the nodes above it for as long as the other child
 * was ready before. True: the root of all was reached. */
static bool climb(struct eng_scene *scene, struct eng_refit_plan *plan, uint32_t i)
{
    uint32_t up = plan->root_parent[i];
    /* Release our child, acquire the other. */
    while (up != ENG_NO_NODE && atomic_fetch_sub_explicit(&plan->unfinished[up], 1,
                                                          memory_order_acq_rel) == 1) {
        eng_still_refit_anew(scene, (struct eng_range){plan->opened[up], 1});
        up = plan->opened_parent[up];
    }
    return up == ENG_NO_NODE;
}

/* Parts of the second half that this thread has done: chunks of edges, the root. */
static uint32_t rest_by_team(struct eng_team *team, struct eng_worker *worker,
                             struct eng_refit_plan *plan)
{
    bool marks = eng_trees_of(team->scene)->marks;
    uint32_t turn = 0;
    uint32_t done = 0;
    for (uint32_t i = next_root(team, plan, &turn); i < plan->root_count;
         i = next_root(team, plan, &turn)) {
        if (marks) {
            worker->tally.still_features +=
                eng_still_refit_subtree(team->scene, plan->roots[i]);
        } else {
            eng_refit_subtree(team->scene, plan->roots[i]);
        }
        done += climb(team->scene, plan, i);
    }
    for (uint32_t i = next(&team->refit.next_edges); i < plan->edges.count;
         i = next(&team->refit.next_edges)) {
        if (marks) {
            worker->tally.still_features +=
                eng_still_refit_edges(team->scene, plan->edges.ranges[i]);
        } else {
            eng_refit_edges(team->scene, plan->edges.ranges[i]);
        }
        done++;
    }
    return done;
}

/* A part of the refit that began at `begin_ns`. */
static void record(struct eng_worker *worker, uint64_t begin_ns)
{
    worker->record.refit_ns += common_now_ns() - begin_ns;
    eng_worker_trace(worker, PCCD_TRACE_REFIT, begin_ns, 0, 0);
}

bool eng_refit_by_team(struct eng_team *team, struct eng_worker *worker,
                       struct eng_refit_plan *plan)
{
    assert(plan->root_count >= 1);
    /* team->count is not looked at: who ends the refit may be writing it already. */
    uint64_t begin_ns = common_now_ns();
    vertices_by_team(team, worker, plan);
    record(worker, begin_ns);
    eng_wait_for(worker, &team->refit.vertices_done, plan->vertices.count);
    begin_ns = common_now_ns();
    uint32_t done = rest_by_team(team, worker, plan);
    record(worker, begin_ns);
    if (done == 0) {
        return false;
    }
    /* Release what we did; the last one acquires what all did. */
    uint32_t before =
        atomic_fetch_add_explicit(&team->refit.rest_done, done, memory_order_acq_rel);
    return before + done == plan->edges.count + 1;
}

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
#include <string.h>

#include "memory.h"
#include "wait.h"

/* ---- boxes ------------------------------------------------------------------------- */

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

void eng_refit_anew(struct eng_scene *scene, struct eng_range nodes)
{
    eng_refit_nodes(scene, nodes);
    if (eng_trees_of(scene)->has_foreign) {
        eng_foreign_mark(eng_trees_of(scene), nodes);
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
        eng_refit_anew(scene, (struct eng_range){range.first + i, 1});
    }
}

/* Return whether boxes are not wanted any more, as the step has to end. */
static bool is_late(struct eng_worker *worker)
{
    return worker && eng_worker_is_late(worker, 0);
}

/* Make the boxes of a range, the last first, until the step has to end. */
static void make_parts(struct eng_scene *scene, struct eng_worker *worker,
                       struct eng_range range,
                       void (*make)(struct eng_scene *scene, struct eng_range part))
{
    while (range.count > 0 && !is_late(worker)) {
        uint32_t part = range.count < ENG_REFIT_CHUNK ? range.count : ENG_REFIT_CHUNK;
        range.count -= part;
        make(scene, (struct eng_range){range.first + range.count, part});
    }
}

void eng_refit_object(struct eng_scene *scene, const struct eng_object *object,
                      struct eng_worker *worker)
{
    make_parts(scene, worker, object->vertices, eng_refit_vertices);
    make_parts(scene, worker, eng_paper_object_of(object)->edges, eng_refit_edges);
    make_parts(scene, worker, eng_paper_object_of(object)->nodes, eng_refit_nodes);
}

void eng_refit(struct eng_scene *scene, struct eng_worker *worker)
{
    const struct eng_trees *trees = eng_trees_of(scene);
    for (uint32_t i = 0; i < scene->object_capacity; i++) {
        if (scene->objects[i].mesh) {
            eng_refit_object(scene, &scene->objects[i], worker);
        }
    }
    eng_refit_anew(scene, trees->top);
}

/* ---- the plan ---------------------------------------------------------------------- */

void eng_refit_plan_deinit(struct eng_refit_plan *plan)
{
    eng_free(plan->vertices.ranges);
    eng_free(plan->edges.ranges);
    eng_free(plan->roots);
    eng_free(plan->root_parent);
    eng_free(plan->opened);
    eng_free(plan->opened_parent);
    eng_free(plan->unfinished);
    memset(plan, 0, sizeof *plan);
}

uint64_t eng_refit_plan_bytes(const struct eng_refit_plan *plan)
{
    return ((uint64_t)plan->vertices.capacity + plan->edges.capacity) *
               sizeof *plan->vertices.ranges +
           5 * (uint64_t)plan->capacity * sizeof *plan->roots;
}

static int reserve_chunks(struct eng_refit_chunks *chunks, uint32_t capacity)
{
    chunks->count = 0;
    if (capacity <= chunks->capacity) {
        return PCCD_OK;
    }
    struct eng_range *ranges = eng_alloc(capacity, sizeof *ranges);
    if (!ranges) {
        return PCCD_E_NOMEM;
    }
    eng_free(chunks->ranges);
    chunks->ranges = ranges;
    chunks->capacity = capacity;
    return PCCD_OK;
}

/* Append a range; what follows the last chunk and has room in it goes there. */
static void cut(struct eng_refit_chunks *chunks, struct eng_range range)
{
    while (range.count > 0) {
        struct eng_range *last = chunks->ranges + chunks->count - 1;
        bool follows = chunks->count > 0 && last->first + last->count == range.first;
        if (!follows || last->count == ENG_REFIT_CHUNK) {
            assert(chunks->count < chunks->capacity);
            last = &chunks->ranges[chunks->count++];
            *last = (struct eng_range){range.first, 0};
        }
        uint32_t room = ENG_REFIT_CHUNK - last->count;
        uint32_t taken = range.count < room ? range.count : room;
        last->count += taken;
        range.first += taken;
        range.count -= taken;
    }
}

int eng_refit_plan_features(struct eng_refit_plan *plan, const struct eng_scene *scene)
{
    const struct eng_trees *trees = eng_trees_of(scene);
    /* Every object begins and ends at most one chunk that is not full. */
    uint32_t ends = 2 * scene->object_count;
    int status = reserve_chunks(&plan->vertices,
                                ends + scene->vertex_ranges.end / ENG_REFIT_CHUNK);
    if (status == PCCD_OK) {
        status =
            reserve_chunks(&plan->edges, ends + trees->edge_ranges.end / ENG_REFIT_CHUNK);
    }
    for (uint32_t i = 0; i < scene->object_capacity && status == PCCD_OK; i++) {
        if (scene->objects[i].mesh) {
            cut(&plan->vertices, scene->objects[i].vertices);
            cut(&plan->edges, eng_paper_object_of(&scene->objects[i])->edges);
        }
    }
    return status;
}

static int reserve_tree(struct eng_refit_plan *plan, uint32_t capacity)
{
    if (capacity <= plan->capacity) {
        return PCCD_OK;
    }
    struct eng_refit_plan grown = {.capacity = capacity};
    grown.opened = eng_alloc(capacity, sizeof *grown.opened);
    grown.opened_parent = eng_alloc(capacity, sizeof *grown.opened_parent);
    grown.unfinished = eng_alloc(capacity, sizeof *grown.unfinished);
    grown.roots = eng_alloc(capacity + 1, sizeof *grown.roots);
    grown.root_parent = eng_alloc(capacity + 1, sizeof *grown.root_parent);
    if (!grown.opened || !grown.opened_parent || !grown.unfinished || !grown.roots ||
        !grown.root_parent) {
        eng_refit_plan_deinit(&grown);
        return PCCD_E_NOMEM;
    }
    grown.vertices = plan->vertices;
    grown.edges = plan->edges;
    memset(&plan->vertices, 0, sizeof plan->vertices);
    memset(&plan->edges, 0, sizeof plan->edges);
    eng_refit_plan_deinit(plan);
    *plan = grown;
    return PCCD_OK;
}

static void add_root(struct eng_refit_plan *plan, uint32_t node, uint32_t parent)
{
    plan->roots[plan->root_count] = node;
    plan->root_parent[plan->root_count++] = parent;
}

static void add_opened(struct eng_refit_plan *plan, uint32_t node, uint32_t parent)
{
    plan->opened[plan->opened_count] = node;
    plan->opened_parent[plan->opened_count++] = parent;
}

/* Breadth-first, open every node with more than its share of the triangles. */
static void divide_evenly(struct eng_refit_plan *plan, const struct eng_scene *scene,
                          uint32_t subtrees)
{
    struct eng_trees *trees = eng_trees_of(scene);
    const struct eng_node *nodes = trees->nodes;
    uint32_t share = nodes[trees->root].count / subtrees;
    if (nodes[trees->root].left == ENG_LEAF) {
        add_root(plan, trees->root, ENG_NO_NODE);
        return;
    }
    add_opened(plan, trees->root, ENG_NO_NODE);
    for (uint32_t i = 0; i < plan->opened_count; i++) {
        const struct eng_node *node = &nodes[plan->opened[i]];
        const uint32_t children[2] = {node->left, node->right};
        for (int k = 0; k < 2; k++) {
            if (nodes[children[k]].left != ENG_LEAF && nodes[children[k]].count > share &&
                plan->opened_count < plan->capacity) {
                add_opened(plan, children[k], i);
            } else {
                add_root(plan, children[k], i);
            }
        }
    }
}

/* Breadth-first until the queue holds so many nodes; leaves wait in front of it. */
static void divide_by_paper(struct eng_refit_plan *plan, const struct eng_scene *scene,
                            uint32_t subtrees)
{
    struct eng_trees *trees = eng_trees_of(scene);
    uint32_t *roots = plan->roots;
    uint32_t head = 0;
    uint32_t leaves = 0;
    add_root(plan, trees->root, ENG_NO_NODE);
    while (head < plan->root_count && leaves + plan->root_count - head < subtrees) {
        const struct eng_node *node = &trees->nodes[roots[head]];
        uint32_t parent = plan->root_parent[head];
        if (node->left == ENG_LEAF) {
            roots[leaves] = roots[head];
            plan->root_parent[leaves++] = parent;
        } else {
            add_opened(plan, roots[head], parent);
            add_root(plan, node->left, plan->opened_count - 1);
            add_root(plan, node->right, plan->opened_count - 1);
        }
        head++;
    }
    uint32_t queued = plan->root_count - head;
    memmove(roots + leaves, roots + head, queued * sizeof *roots);
    memmove(plan->root_parent + leaves, plan->root_parent + head, queued * sizeof *roots);
    plan->root_count = leaves + queued;
}

int eng_refit_plan_tree(struct eng_refit_plan *plan, const struct eng_scene *scene,
                        enum eng_refit_scheme scheme, uint32_t threads)
{
    assert(threads >= 1);
    const struct eng_trees *trees = eng_trees_of(scene);
    bool by_paper = scheme == ENG_REFIT_PAPER;
    uint32_t subtrees =
        threads * (by_paper ? ENG_REFIT_SUBTREES_PAPER : ENG_REFIT_SUBTREES);
    /* A lopsided tree has more nodes above even shares than shares. */
    int status = reserve_tree(plan, 4 * subtrees);
    if (status != PCCD_OK) {
        return status;
    }
    plan->opened_count = 0;
    plan->root_count = 0;
    plan->dealt = by_paper ? threads : 0;
    if (trees->root == ENG_NO_NODE) {
        return PCCD_OK;
    }
    if (by_paper) {
        divide_by_paper(plan, scene, subtrees);
    } else {
        divide_evenly(plan, scene, subtrees);
    }
    for (uint32_t i = 0; i < plan->opened_count; i++) {
        atomic_init(&plan->unfinished[i], 2);
    }
    return PCCD_OK;
}

/* ---- by a team --------------------------------------------------------------------- */

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
        if (!is_late(worker)) {
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
        eng_refit_anew(scene, (struct eng_range){plan->opened[up], 1});
        up = plan->opened_parent[up];
    }
    return up == ENG_NO_NODE;
}

/* Parts of the second half that this thread has done: chunks of edges, the root. */
static uint32_t rest_by_team(struct eng_team *team, struct eng_worker *worker,
                             struct eng_refit_plan *plan)
{
    uint32_t turn = 0;
    uint32_t done = 0;
    for (uint32_t i = next_root(team, plan, &turn); i < plan->root_count;
         i = next_root(team, plan, &turn)) {
        if (!is_late(worker)) {
            eng_refit_subtree(team->scene, plan->roots[i]);
        }
        done += climb(team->scene, plan, i);
    }
    for (uint32_t i = next(&team->refit.next_edges); i < plan->edges.count;
         i = next(&team->refit.next_edges)) {
        if (!is_late(worker)) {
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

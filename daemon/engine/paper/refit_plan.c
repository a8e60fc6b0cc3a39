/* refit_plan.c - how a team divides the refit.
 *
 * Source: paper section 6.1.
 */
#include "refit_plan.h"

#include <assert.h>
#include <string.h>

#include "memory.h"

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
            cut(&plan->edges, eng_planted_of(&scene->objects[i])->edges);
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

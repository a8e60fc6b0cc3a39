/* rebuild.c - selective, lazy reconstruction. */
#include "rebuild.h"

#include <assert.h>

#include "grow.h"
#include "paper_work.h"
#include "refit.h"
#include "wait.h"

/* Nodes of a part of the tree over the objects that is worth a look: two objects can be
 * arranged in one way only. */
#define TOP_NODES_MIN 2u

static uint32_t node_count_of(const struct eng_node *node)
{
    return 2 * node->count - 1;
}

void eng_regions_mark(struct eng_scene *scene, struct eng_range nodes)
{
    struct eng_trees *trees = eng_trees_of(scene);
    uint32_t end = nodes.first + nodes.count;
    if (scene->settings.rebuild_ratio <= 0) {
        return;
    }
    for (uint32_t i = nodes.first; i < end;) {
        struct eng_node *node = &trees->nodes[i];
        if (node->count > scene->settings.region_triangles) {
            i++;
            continue;
        }
        if (node->count >= ENG_EXAMINE_MIN) {
            node->gate = ENG_GATE_REGION;
            atomic_store_explicit(&trees->upkeep[i].gate, 1, memory_order_relaxed);
        }
        i += node_count_of(node);
    }
}

void eng_metric_note_built(struct eng_scene *scene, struct eng_range nodes)
{
    struct eng_trees *trees = eng_trees_of(scene);
    uint32_t end = nodes.first + nodes.count;
    if (scene->settings.rebuild_ratio <= 0) {
        return;
    }
    for (uint32_t i = nodes.first; i < end;) {
        const struct eng_node *node = &trees->nodes[i];
        if (node->count < ENG_EXAMINE_MIN) {
            i += node_count_of(node);
        } else {
            trees->upkeep[i].built_ratio = eng_metric(trees->nodes, node);
            i++;
        }
    }
}

static bool is_poor(const struct eng_scene *scene, uint32_t node_idx)
{
    struct eng_trees *trees = eng_trees_of(scene);
    return eng_metric_is_poor(eng_metric(trees->nodes, &trees->nodes[node_idx]),
                              trees->upkeep[node_idx].built_ratio,
                              (float)scene->settings.rebuild_ratio);
}

static void note_objects(struct eng_scene *scene, uint32_t first, uint32_t end)
{
    struct eng_trees *trees = eng_trees_of(scene);
    for (uint32_t i = first; i < end; i++) {
        trees->upkeep[i].built_ratio = eng_metric(trees->nodes, &trees->nodes[i]);
    }
}

/* The triangles in a range of nodes. */
static void list_triangles(const struct eng_scene *scene, struct eng_range nodes,
                           struct eng_split_item *items)
{
    struct eng_trees *trees = eng_trees_of(scene);
    uint32_t count = 0;
    for (uint32_t i = nodes.first; i < nodes.first + nodes.count; i++) {
        const struct eng_node *node = &trees->nodes[i];
        if (node->left == ENG_LEAF) {
            items[count++] = eng_split_item_of(node, node->right);
        }
    }
}

/* Build the subtree at `node_idx` anew: all of it is below that node. */
static void rebuild_subtree(struct eng_worker *worker, uint32_t node_idx)
{
    struct eng_scene *scene = worker->scene;
    struct eng_trees *trees = eng_trees_of(scene);
    struct eng_paper_work *work = eng_paper_work_of(worker);
    uint32_t count = trees->nodes[node_idx].count;
    struct eng_range range = {node_idx, node_count_of(&trees->nodes[node_idx])};
    uint64_t begin_ns = eng_worker_slice(worker);
    assert(count <= work->split_capacity);
    list_triangles(scene, range, work->split_items);
    struct eng_grower grower;
    grower.items = work->split_items;
    grower.nodes = NULL;
    grower.over_roots = false;
    eng_grow_begin(&grower, count, node_idx);
    eng_grow(&grower);
    eng_grow_leaves(trees, range, work->split_items);
    eng_refit_anew(scene, (struct eng_range){node_idx + 1, range.count - 1});
    eng_metric_note_built(scene, range);
    worker->record.rebuilds++;
    worker->tally.rebuilt_triangles += count;
    eng_worker_trace(worker, PCCD_TRACE_REBUILD, begin_ns, node_idx, count);
}

/* Build what is below the object roots in a part of the tree over the objects anew: the
 * nodes from `first` to before `end`. */
static void rebuild_objects(struct eng_worker *worker, uint32_t first, uint32_t end)
{
    assert(first < end);
    struct eng_scene *scene = worker->scene;
    struct eng_trees *trees = eng_trees_of(scene);
    uint32_t count = 0;
    uint64_t begin_ns = eng_worker_slice(worker);
    for (uint32_t i = first; i < end; i++) {
        const uint32_t children[2] = {trees->nodes[i].left, trees->nodes[i].right};
        for (int side = 0; side < 2; side++) {
            if (!eng_is_above_objects(scene, children[side])) {
                trees->top_items[count++] =
                    eng_split_item_of(&trees->nodes[children[side]], children[side]);
            }
        }
    }
    struct eng_grower grower;
    grower.items = trees->top_items;
    grower.nodes = trees->nodes;
    grower.over_roots = true;
    eng_grow_begin(&grower, count, first);
    eng_grow(&grower);
    eng_refit_anew(scene, (struct eng_range){first, end - first});
    note_objects(scene, first, end);
    worker->record.rebuilds++;
    worker->tally.rebuilt_triangles += count;
    eng_worker_trace(worker, PCCD_TRACE_REBUILD, begin_ns, first, count);
}

/* A part of the tree over the objects: nodes `first` to before `end`. */
struct part {
    uint32_t first;
    uint32_t end;
};

void eng_rebuild_top(struct eng_worker *worker)
{
    struct eng_scene *scene = worker->scene;
    struct eng_trees *trees = eng_trees_of(scene);
    struct part stack[ENG_GROW_STACK_MAX]; /* one waits on each level */
    uint32_t count = 0;
    uint64_t begin_ns = common_now_ns();
    uint32_t end = trees->top.first + trees->top.count;
    if (scene->settings.rebuild_ratio <= 0) {
        return;
    }
    if (trees->top_is_fresh) {
        note_objects(scene, trees->top.first, end);
        trees->top_is_fresh = false;
        return;
    }
    stack[count++] = (struct part){trees->top.first, end};
    while (count > 0) {
        struct part part = stack[--count];
        if (part.end - part.first < TOP_NODES_MIN) {
            continue;
        }
        const struct eng_node *node = &trees->nodes[part.first];
        if (is_poor(scene, part.first)) {
            rebuild_objects(worker, part.first, part.end);
            continue;
        }
        /* In pre-order the left part, if any, comes first. */
        bool right_is_part = eng_is_above_objects(scene, node->right);
        uint32_t middle = right_is_part ? node->right : part.end;
        assert(count + 2 <= ENG_GROW_STACK_MAX);
        stack[count++] = (struct part){middle, part.end};
        stack[count++] = (struct part){part.first + 1, middle};
    }
    worker->record.rebuild_ns += common_now_ns() - begin_ns;
}

static void examine_region(struct eng_worker *worker, uint32_t root)
{
    const struct eng_scene *scene = worker->scene;
    struct eng_trees *trees = eng_trees_of(scene);
    uint64_t begin_ns = common_now_ns();
    uint32_t end = root + node_count_of(&trees->nodes[root]);
    for (uint32_t i = root; i < end;) {
        const struct eng_node *node = &trees->nodes[i];
        if (node->count < ENG_EXAMINE_MIN) {
            i += node_count_of(node);
        } else if (is_poor(scene, i)) {
            rebuild_subtree(worker, i);
            i += node_count_of(node);
        } else {
            i++;
        }
    }
    worker->record.rebuild_ns += common_now_ns() - begin_ns;
}

/* Until another thread lets go of a gate. */
static uint32_t wait_for(struct eng_worker *worker, const atomic_uint *gate,
                         uint32_t busy)
{
    struct eng_wait wait;
    uint32_t seen;
    worker->record.lock_waits++;
    eng_wait_begin(&wait, worker);
    while ((seen = atomic_load_explicit(gate, memory_order_acquire)) == busy) {
        eng_wait_moment(&wait);
    }
    eng_wait_end(&wait);
    return seen;
}

void eng_region_enter(struct eng_worker *worker, uint32_t root)
{
    assert(eng_trees_of(worker->scene)->nodes[root].gate == ENG_GATE_REGION);
    atomic_uint *gate = &eng_trees_of(worker->scene)->upkeep[root].gate;
    uint32_t ready = eng_gate_ready(worker->scene);
    uint32_t busy = ready - 1;
    uint32_t seen = atomic_load_explicit(gate, memory_order_acquire);
    while (seen != ready) {
        if (seen == busy) {
            seen = wait_for(worker, gate, busy);
        } else if (atomic_compare_exchange_strong_explicit(
                       gate, &seen, busy, memory_order_acquire, memory_order_acquire)) {
            examine_region(worker, root);
            /* Release: pairs with the acquire of those who wait or come later. */
            atomic_store_explicit(gate, ready, memory_order_release);
            return;
        }
    }
}

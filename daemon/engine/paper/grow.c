/* grow.c - builds a tree from the top down, in pieces. */
#include "grow.h"

#include <assert.h>

#include "kernel.h"

/* Items below which a subtree is one piece: about 0.1 ms. */
#define PIECE_ITEMS 1024u

void eng_grow_begin(struct eng_grower *grower, uint32_t count, uint32_t root)
{
    assert(count >= 1 && grower->items);
    assert(!grower->over_roots || (count >= 2 && grower->nodes));
    grower->is_splitting = false;
    grower->stack_count = 1;
    grower->stack[0] = (struct eng_grow_job){0, count, root};
}

/* Nodes that a subtree of `count` items takes. */
static uint32_t nodes_of(const struct eng_grower *grower, uint32_t count)
{
    return grower->over_roots ? count - 1 : 2 * count - 1;
}

static uint32_t triangles_below(const struct eng_grower *grower,
                                const struct eng_grow_job *job)
{
    if (!grower->over_roots) {
        return job->count;
    }
    uint32_t sum = 0;
    for (uint32_t i = 0; i < job->count; i++) {
        sum += grower->nodes[grower->items[job->first + i].id].count;
    }
    return sum;
}

static void write_node(const struct eng_grower *grower, const struct eng_grow_job *job,
                       uint32_t left, uint32_t right)
{
    if (grower->nodes) {
        struct eng_node *node = &grower->nodes[job->node];
        node->left = left;
        node->right = right;
        node->count = triangles_below(grower, job);
        node->gate = ENG_GATE_NONE;
        node->foreign = 0;
        node->reserved = 0;
    }
}

/* The node for a child subtree and, unless it exists already, its job. */
static uint32_t place_child(struct eng_grower *grower, struct eng_grow_job child)
{
    if (grower->over_roots && child.count == 1) {
        return grower->items[child.first].id;
    }
    assert(grower->stack_count < ENG_GROW_STACK_MAX);
    grower->stack[grower->stack_count++] = child;
    return child.node;
}

/* The items of the job are in order: the first half goes left. */
static void split(struct eng_grower *grower)
{
    const struct eng_grow_job *job = &grower->job;
    uint32_t half = job->count / 2;
    struct eng_grow_job left = {job->first, half, job->node + 1};
    struct eng_grow_job right = {job->first + half, job->count - half,
                                 job->node + 1 + nodes_of(grower, half)};
    /* The right one waits: depth first along the left keeps the stack short. */
    uint32_t right_node = place_child(grower, right);
    uint32_t left_node = place_child(grower, left);
    write_node(grower, job, left_node, right_node);
}

/* One pass over the items of one job, or the start of the next. */
static void advance(struct eng_grower *grower)
{
    struct eng_grow_job *job = &grower->job;
    if (grower->is_splitting) {
        if (eng_median_round(&grower->median, grower->items + job->first)) {
            grower->is_splitting = false;
            split(grower);
        }
        return;
    }
    *job = grower->stack[--grower->stack_count];
    struct eng_split_item *items = grower->items + job->first;
    if (job->count == 1) {
        write_node(grower, job, ENG_LEAF, items->id);
    } else {
        grower->is_splitting = true;
        eng_median_begin(&grower->median, job->count, job->count / 2,
                         eng_median_axis(items, job->count), eng_kernels()->come_before);
    }
}

bool eng_grow_piece(struct eng_grower *grower)
{
    if (grower->is_splitting) {
        advance(grower);
    } else if (grower->stack_count > 0) {
        uint32_t others = grower->stack_count - 1;
        bool is_small = grower->stack[others].count <= PIECE_ITEMS;
        do {
            advance(grower);
        } while (is_small && (grower->is_splitting || grower->stack_count > others));
    }
    return grower->is_splitting || grower->stack_count > 0;
}

void eng_grow(struct eng_grower *grower)
{
    while (eng_grow_piece(grower)) {
    }
}

void eng_grow_leaves(struct eng_trees *trees, struct eng_range nodes,
                     const struct eng_split_item *items)
{
    assert(nodes.count % 2 == 1);
    for (uint32_t i = nodes.first; i < nodes.first + nodes.count; i++) {
        if (trees->nodes[i].left == ENG_LEAF) {
            trees->nodes[i].right = items++->id;
        }
    }
}

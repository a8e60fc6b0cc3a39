/* grow.c - a hierarchy from the top down, in pieces. */
#include "grow.h"

#include <assert.h>

#include "kernel.h"

/* Items below which a subtree is one piece: about 0.1 ms. */
#define PIECE_ITEMS 1024u

/* Items below which the heuristic is not asked: there is hardly a choice. */
#define SAH_ITEMS_MIN 5u

uint32_t eng_grow_levels(uint32_t count)
{
    uint32_t levels = 0;
    while ((uint64_t)1 << levels < count) {
        levels++;
    }
    return levels;
}

void eng_grow_begin(struct eng_grower *grower, uint32_t count, uint32_t root,
                    uint32_t levels)
{
    assert(count >= 1 && grower->items && (grower->nodes || grower->links));
    assert(count > 0 && levels >= eng_grow_levels(count));
    assert(levels < ENG_GROW_STACK_MAX);
    grower->stage = ENG_GROW_NEXT;
    grower->stack_count = 1;
    grower->stack[0] = (struct eng_grow_job){0, count, root, levels};
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
    uint32_t count = triangles_below(grower, job);
    if (grower->nodes) {
        struct eng_node *node = &grower->nodes[job->node];
        node->left = left;
        node->right = right;
        node->count = count;
        node->gate = ENG_GATE_NONE;
        node->foreign = 0;
        node->moved = 0;
    } else {
        grower->links[job->node - grower->base] = (struct eng_link){right, count};
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

/* The items of `job` are in order: the first `half` go left. */
static void split_at(struct eng_grower *grower, const struct eng_grow_job *job,
                     uint32_t half)
{
    struct eng_grow_job left = {job->first, half, job->node + 1, job->levels - 1};
    struct eng_grow_job right = {job->first + half, job->count - half,
                                 job->node + 1 + nodes_of(grower, half), job->levels - 1};
    /* The right one waits: depth first along the left keeps the stack short. */
    uint32_t right_node = place_child(grower, right);
    uint32_t left_node = place_child(grower, left);
    write_node(grower, job, left_node, right_node);
}

static struct eng_split_item *items_of(const struct eng_grower *grower,
                                       const struct eng_grow_job *job)
{
    return grower->items + job->first;
}

static void begin_median(struct eng_grower *grower)
{
    const struct eng_grow_job *job = &grower->job;
    grower->stage = ENG_GROW_MEDIAN;
    eng_median_begin(&grower->median, job->count, job->count / 2,
                     eng_median_axis(items_of(grower, job), job->count),
                     eng_kernels()->come_before);
}

/* Take the next job. */
static void begin_job(struct eng_grower *grower)
{
    struct eng_grow_job *job = &grower->job;
    *job = grower->stack[--grower->stack_count];
    if (job->count == 1) {
        write_node(grower, job, ENG_LEAF, items_of(grower, job)->id);
    } else if (grower->sah.boxes && job->count >= SAH_ITEMS_MIN) {
        grower->stage = ENG_GROW_SAH;
        eng_sah_begin(&grower->sah, job->count);
    } else {
        begin_median(grower);
    }
}

/* Follow the heuristic where the depth allows it. */
static void end_sah(struct eng_grower *grower)
{
    const struct eng_grow_job *job = &grower->job;
    uint32_t left = grower->sah.left;
    uint32_t larger = left > job->count - left ? left : job->count - left;
    if (left == 0 || eng_grow_levels(larger) > job->levels - 1) {
        begin_median(grower);
    } else {
        grower->stage = ENG_GROW_NEXT;
        split_at(grower, job, left);
    }
}

/* One pass over the items of one job, or the start of the next. */
static void advance(struct eng_grower *grower)
{
    const struct eng_grow_job *job = &grower->job;
    switch (grower->stage) {
    case ENG_GROW_NEXT:
        begin_job(grower);
        break;
    case ENG_GROW_MEDIAN:
        if (eng_median_round(&grower->median, items_of(grower, job))) {
            grower->stage = ENG_GROW_NEXT;
            split_at(grower, job, job->count / 2);
        }
        break;
    case ENG_GROW_SAH:
        if (eng_sah_pass(&grower->sah, items_of(grower, job), job->count)) {
            end_sah(grower);
        }
        break;
    }
}

bool eng_grow_piece(struct eng_grower *grower)
{
    if (grower->stage != ENG_GROW_NEXT) {
        advance(grower);
    } else if (grower->stack_count > 0) {
        uint32_t others = grower->stack_count - 1;
        bool is_small = grower->stack[others].count <= PIECE_ITEMS;
        do {
            advance(grower);
        } while (is_small &&
                 (grower->stage != ENG_GROW_NEXT || grower->stack_count > others));
    }
    return grower->stage != ENG_GROW_NEXT || grower->stack_count > 0;
}

void eng_grow(struct eng_grower *grower)
{
    while (eng_grow_piece(grower)) {
    }
}

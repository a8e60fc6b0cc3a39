/* bench/traverse.c - the traversal of the engine's tree, with nothing else in it.
 *
 * Room:     bench.
 * Does:     visit what eng_taskunit_perform visits, in the order of a depth-first search.
 * Threads:  one.
 * Source:   daemon/engine/taskunit.c; the same refinement, so that counts are comparable.
 */
#include "traverse.h"

#include <stdlib.h>
#include <string.h>

#include "report.h"
#include "worker.h"

#define PAIRS_MAX 512u /* as ENG_PAIRS_MAX */
#define DEPTH_MAX (2u * ENG_LEVELS_MAX) /* two wait on each level */

struct walk {
    const struct eng_node *nodes;
    const struct bench_swept *swept; /* NULL: moving boxes */
    struct bench_trace *trace;       /* NULL: none */
    struct bench_count count;
    uint32_t pairs[PAIRS_MAX][2];
    uint32_t pair_count;
};

__attribute__((always_inline)) static inline void test(struct walk *walk, uint32_t n,
                                                       uint32_t m)
{
    walk->count.box_tests++;
    if (walk->trace && walk->trace->count < walk->trace->capacity) {
        walk->trace->nodes[walk->trace->count][0] = n;
        walk->trace->nodes[walk->trace->count++][1] = m;
    }
    if (walk->swept ? !bench_swept_overlap(&walk->swept[n], &walk->swept[m])
                    : !eng_box_overlap(eng_box_of_const(&walk->nodes[n]),
                                       eng_box_of_const(&walk->nodes[m]))) {
        return;
    }
    if (walk->nodes[n].left == ENG_LEAF && walk->nodes[m].left == ENG_LEAF) {
        walk->count.leaf_pairs++;
        return;
    }
    assert(walk->pair_count < PAIRS_MAX);
    walk->pairs[walk->pair_count][0] = n;
    walk->pairs[walk->pair_count++][1] = m;
}

__attribute__((always_inline)) static inline void refine(struct walk *walk, uint32_t n,
                                                         uint32_t m)
{
    const struct eng_node *node_n = &walk->nodes[n];
    const struct eng_node *node_m = &walk->nodes[m];
    if (node_n->left == ENG_LEAF) {
        test(walk, n, node_m->left);
        test(walk, n, node_m->right);
    } else if (node_m->left == ENG_LEAF) {
        test(walk, node_n->left, m);
        test(walk, node_n->right, m);
    } else {
        test(walk, node_n->left, node_m->left);
        test(walk, node_n->left, node_m->right);
        test(walk, node_n->right, node_m->left);
        test(walk, node_n->right, node_m->right);
    }
}

/* Always inlined: the callers' constants take the untaken branches out. */
__attribute__((always_inline)) static inline struct bench_count
traverse(const struct eng_scene *scene, const struct bench_swept *swept,
         struct bench_trace *trace)
{
    struct walk walk = {.nodes = scene->nodes, .swept = swept, .trace = trace};
    uint32_t stack[DEPTH_MAX];
    uint32_t depth = 0;
    stack[depth++] = scene->root;
    while (depth > 0) {
        const struct eng_node *node = &scene->nodes[stack[--depth]];
        if (node->left == ENG_LEAF) {
            continue;
        }
        assert(depth + 2 <= DEPTH_MAX);
        stack[depth++] = node->right;
        stack[depth++] = node->left;
        test(&walk, node->left, node->right);
        while (walk.pair_count > 0) {
            walk.pair_count--;
            refine(&walk, walk.pairs[walk.pair_count][0], walk.pairs[walk.pair_count][1]);
        }
    }
    return walk.count;
}

struct bench_count bench_traverse_moving(const struct eng_scene *scene)
{
    return traverse(scene, NULL, NULL);
}

struct bench_count bench_traverse_swept(const struct eng_scene *scene,
                                        const struct bench_swept_tree *tree)
{
    return traverse(scene, tree->boxes, NULL);
}

void bench_traverse_trace(const struct eng_scene *scene, struct bench_trace *trace)
{
    traverse(scene, NULL, trace);
}

static void update_range(struct bench_swept *swept, const struct eng_node *nodes,
                         struct eng_range range)
{
    for (uint32_t i = range.first; i < range.first + range.count; i++) {
        for (int k = 0; k < 3; k++) {
            const struct eng_node *node = &nodes[i];
            swept[i].lo[k] = node->lo0[k] < node->lo1[k] ? node->lo0[k] : node->lo1[k];
            swept[i].hi[k] = node->hi0[k] > node->hi1[k] ? node->hi0[k] : node->hi1[k];
        }
    }
}

/* Nodes are added when a scene steps for the first time. */
static void reserve(struct bench_swept_tree *tree, uint32_t capacity)
{
    if (capacity <= tree->capacity) {
        return;
    }
    free(tree->boxes);
    tree->boxes = aligned_alloc(64, ((size_t)capacity + 1) / 2 * 2 * sizeof *tree->boxes);
    if (!tree->boxes) {
        exit(2);
    }
    memset(tree->boxes, 0, capacity * sizeof *tree->boxes);
    tree->capacity = capacity;
}

void bench_swept_update(struct bench_swept_tree *tree, const struct eng_scene *scene)
{
    reserve(tree, scene->node_capacity);
    for (uint32_t i = 0; i < scene->object_capacity; i++) {
        if (scene->objects[i].mesh) {
            update_range(tree->boxes, scene->nodes, scene->objects[i].nodes);
        }
    }
    update_range(tree->boxes, scene->nodes, scene->top);
}

void bench_swept_deinit(struct bench_swept_tree *tree)
{
    free(tree->boxes);
    *tree = (struct bench_swept_tree){NULL, 0};
}

/* traverse.c - the traversal of the engine's tree, with nothing else in it.
 *
 * Source: paper/taskunit.c; the same refinement, so that counts are comparable.
 */
#include "gather.h"

#include <stdlib.h>
#include <string.h>

#include "report.h"
#include "trees.h"
#include "worker.h"

#define PAIRS_MAX 512u                  /* as ENG_PAIRS_MAX */
#define DEPTH_MAX (2u * ENG_LEVELS_MAX) /* two wait on each level */

struct walk {
    const struct eng_node *nodes;
    struct bench_trace *trace;
    uint32_t pairs[PAIRS_MAX][2];
    uint32_t pair_count;
};

static void test(struct walk *walk, uint32_t n, uint32_t m)
{
    if (walk->trace->count < walk->trace->capacity) {
        walk->trace->nodes[walk->trace->count][0] = n;
        walk->trace->nodes[walk->trace->count++][1] = m;
    }
    if (!eng_box_overlap(eng_box_of_const(&walk->nodes[n]),
                         eng_box_of_const(&walk->nodes[m])) ||
        (walk->nodes[n].left == ENG_LEAF && walk->nodes[m].left == ENG_LEAF)) {
        return;
    }
    assert(walk->pair_count < PAIRS_MAX);
    walk->pairs[walk->pair_count][0] = n;
    walk->pairs[walk->pair_count++][1] = m;
}

static void refine(struct walk *walk, uint32_t n, uint32_t m)
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

void bench_traverse(const struct eng_scene *scene, struct bench_trace *trace)
{
    struct walk walk = {.nodes = eng_trees_of(scene)->nodes, .trace = trace};
    uint32_t stack[DEPTH_MAX];
    uint32_t depth = 0;
    stack[depth++] = eng_trees_of(scene)->root;
    while (depth > 0) {
        const struct eng_node *node = &eng_trees_of(scene)->nodes[stack[--depth]];
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
}

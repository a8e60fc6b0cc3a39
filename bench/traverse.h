/* bench/traverse.h - the traversal of the engine's tree, with nothing else in it.
 *
 * Room:     bench; engine headers.
 * Does:     count pairs of overlapping leaves with the engine's moving boxes or with
 *           swept boxes, over the same nodes in the same order; record which nodes are
 *           tested.
 * Threads:  one.
 */
#ifndef BENCH_TRAVERSE_H
#define BENCH_TRAVERSE_H

#include "aabb.h"
#include "world.h"

/* One box around both ends of the step, the usual way; half the bytes of a moving box. */
struct bench_swept {
    _Alignas(32) float lo[4]; /* [3]: zero */
    float hi[4];
};

struct bench_count {
    uint64_t box_tests;
    uint64_t leaf_pairs;
};

/* The first `capacity` node pairs that were tested. */
struct bench_trace {
    uint32_t (*nodes)[2];
    size_t count;
    size_t capacity;
};

static inline bool bench_swept_overlap(const struct bench_swept *a,
                                       const struct bench_swept *b)
{
    const eng_f4 *va = (const eng_f4 *)(const void *)a;
    const eng_f4 *vb = (const eng_f4 *)(const void *)b;
    eng_i4 apart = (va[0] > vb[1]) | (vb[0] > va[1]);
    return (apart[0] | apart[1] | apart[2]) == 0;
}

/* One for each node; memory grows with the scene. Zero to begin with. */
struct bench_swept_tree {
    struct bench_swept *boxes;
    uint32_t capacity;
};

/* To what the scene's last step left in its nodes. */
void bench_swept_update(struct bench_swept_tree *tree, const struct eng_scene *scene);
void bench_swept_deinit(struct bench_swept_tree *tree);

struct bench_count bench_traverse_moving(const struct eng_scene *scene);
struct bench_count bench_traverse_swept(const struct eng_scene *scene,
                                        const struct bench_swept_tree *tree);
void bench_traverse_trace(const struct eng_scene *scene, struct bench_trace *trace);

#endif

/* traverse.h - the traversal of the engine's tree alone, without tests, to time it.
 *
 * Threads: one.
 */
#ifndef BENCH_TRAVERSE_H
#define BENCH_TRAVERSE_H

#include "aabb.h"
#include "world.h"

/* The first `capacity` node pairs that were tested. */
struct bench_trace {
    uint32_t (*nodes)[2];
    size_t count;
    size_t capacity;
};

void bench_traverse(const struct eng_scene *scene, struct bench_trace *trace);

#endif

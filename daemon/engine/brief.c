/* daemon/engine/brief.c - steps that are certain to end soon.
 *
 * Room:     engine.
 * Does:     bound what a step's time grows with before it begins.
 * Threads:  [compute].
 */
#include "brief.h"

#include <assert.h>

#include "step_memory.h"
#include "wide.h"
#include "wide_test.h"

/* What the last step took, as it is believed (effort.h). */
#define WORK_NS 30000u

/* Blocks of sixteen: boxes are made of each, and all pairs of blocks may be joined. Two
 * blocks are 256 tests of boxes, 0.1 us of a vector kernel, 2 without: 16 pairs of
 * vertices and faces, 36 of edges. */
#define VERTEX_BLOCKS 4u
#define EDGE_BLOCKS   8u
#define FACE_BLOCKS   4u

/* Places for objects, taken or not: some loops of a step are over all of them. */
#define OBJECTS 64u

bool eng_brief_fits(const struct eng_step_settings *settings)
{
    return settings->mode != PCCD_MODE_PAIRS &&
           eng_method_of(settings) == PCCD_METHOD_WIDE;
}

/* The trees are there, and small. */
static bool trees_are_small(const struct eng_wide *wide)
{
    return !wide->is_stale &&
           wide->trees[PCCD_TREE_VERTICES].block_count[0] <= VERTEX_BLOCKS &&
           wide->trees[PCCD_TREE_EDGES].block_count[0] <= EDGE_BLOCKS &&
           wide->trees[PCCD_TREE_FACES].block_count[0] <= FACE_BLOCKS;
}

bool eng_step_can_be_brief(const struct eng_scene *scene,
                           const struct eng_step_settings *settings)
{
    assert(scene && settings);
    const struct eng_step_memory *memory = eng_step_memory_of(scene);
    if (!eng_brief_fits(settings) || scene->object_capacity > OBJECTS ||
        !trees_are_small(eng_wide_of(scene))) {
        return false;
    }
    /* One worker: those of others, once there are any, are freed by some later step. */
    uint64_t work_ns = memory->effort[PCCD_METHOD_WIDE].work_ns[settings->mode];
    return work_ns > 0 && work_ns <= WORK_NS && memory->worker_count == 1 &&
           eng_wide_work_of(memory->workers[0]);
}

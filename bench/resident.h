/* bench/resident.h - a measured scene inside the engine.
 *
 * Room:     bench; engine headers.
 * Does:     register the meshes, add the objects, stage the positions of a step.
 * Threads:  one.
 */
#ifndef BENCH_RESIDENT_H
#define BENCH_RESIDENT_H

#include "step.h"
#include "workload.h"

struct bench_world {
    const struct bench_scene *source;
    struct eng_scene *scene;
    uint32_t object_idx[BENCH_OBJECTS_MAX];
    uint32_t frame; /* where it stands */
};

/* Register and add everything at the positions of `frame`; objects get ids 1, 2, ...
 * Exits with 2 when the engine refuses: there is nothing to measure then. */
void bench_world_init(struct bench_world *world, const struct bench_scene *source,
                      uint32_t frame);
void bench_world_deinit(struct bench_world *world);

/* Step from frame `from` to the next: by end positions alone where the scene stands
 * there, by both ends otherwise. */
void bench_world_step(struct bench_world *world, uint32_t from, enum eng_mode mode,
                      struct eng_step_result *result);

#endif

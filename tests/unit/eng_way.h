/* eng_way.h - lists the settings that must not change the answer of a step, and draws one
 * at random.
 */
#ifndef TEST_ENG_WAY_H
#define TEST_ENG_WAY_H

#include "kernel.h"
#include "prng.h"
#include "step.h"

#define WAY_METHODS 2u
extern const enum pccd_method way_methods[WAY_METHODS];

/* The instruction sets that this processor has, at least the scalar one: [0]. */
uint32_t way_kernels_count(void);
const struct eng_kernels *way_kernels(uint32_t i);

/* Each method by one thread and by two, with each instruction set, by number. */
uint32_t way_count(void);
void way_choose(uint32_t i, struct eng_question *settings);

/* Method, instruction set, threads (1 .. thread_max, however small the work), scheduler,
 * high-level nodes and refit. */
void way_draw(struct prng *prng, uint32_t thread_max, struct eng_question *settings);

/* Return whether the binary tree is what it should be after the step. Wide steps leave
 * its boxes where they were. */
bool way_tree_is_sound(const struct eng_scene *scene,
                       const struct eng_step_result *result);

/* Return whether the last step was taken in body space (bodies.h). */
bool way_was_by_bodies(const struct eng_scene *scene);

/* "method 1, avx2, 3 threads, scheduler 0, high level 1, refit 0" */
#define WAY_TEXT_MAX 128u
void way_tell(const struct eng_question *settings, char text[WAY_TEXT_MAX]);

#endif

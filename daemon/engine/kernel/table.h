/* daemon/engine/kernel/table.h - the kernels of the instruction set being compiled.
 *
 * Room:     engine. May include: kernel.h, lanes.h.
 * Does:     declare what the files of this folder define and table.c lists.
 * Threads:  [any].
 */
#ifndef ENG_TABLE_H
#define ENG_TABLE_H

#include "kernel.h"
#include "lanes.h"

bool ENG_KERNEL(all_within)(const double *x, size_t count, double limit);
bool ENG_KERNEL(widen_within)(double *out, const float *x, size_t count, double limit);
uint32_t ENG_KERNEL(apart)(enum eng_kind kind, const struct eng_point *points,
                           const uint32_t (*quads)[4], uint32_t count, uint32_t *kept);
uint32_t ENG_KERNEL(filter)(enum eng_kind kind, const struct eng_point *points,
                            const uint32_t (*quads)[4], const uint32_t *pairs,
                            uint32_t count, uint32_t *kept);
uint32_t ENG_KERNEL(sift)(enum eng_kind kind, struct eng_sieve *sieve, uint32_t *a,
                          uint32_t *b, uint32_t count);

void ENG_KERNEL(bound_positions)(const double (*x)[3], size_t count,
                                 struct eng_bounds *bounds);
bool ENG_KERNEL(place_points)(const struct eng_point *points, uint32_t count,
                              const struct eng_frame *frame, const struct eng_grid *grid,
                              struct eng_mark *marks);
void ENG_KERNEL(box_points)(const struct eng_point *points, uint32_t count,
                            const struct eng_frame *frame, bool swept,
                            struct eng_extents *boxes);
void ENG_KERNEL(box_fold)(const struct eng_extents *boxes, uint32_t block_count,
                          bool swept, struct eng_wide_block *blocks,
                          struct eng_extents *around);
void ENG_KERNEL(box_unite)(const struct eng_extents *points,
                           const uint32_t *const corner[3], uint32_t block_count,
                           bool swept, struct eng_wide_block *blocks,
                           struct eng_extents *around);
bool ENG_KERNEL(narrow_blocks)(const struct eng_wide_block *blocks,
                               const struct eng_extents *around, uint32_t count,
                               const struct eng_narrowing *narrowing,
                               struct eng_narrow_block *narrow,
                               struct eng_narrow_box *narrow_around, uint32_t *farthest);

uint32_t ENG_KERNEL(join_nodes)(struct eng_join *job, struct eng_join_round *round,
                                uint32_t *out_a, uint32_t *out_b, uint32_t room);
uint32_t ENG_KERNEL(join_edges)(struct eng_join *job, struct eng_join_round *round,
                                uint32_t *out_a, uint32_t *out_b, uint32_t room);
uint32_t ENG_KERNEL(join_faces)(struct eng_join *job, struct eng_join_round *round,
                                uint32_t *out_a, uint32_t *out_b, uint32_t room);
void ENG_KERNEL(bracket)(enum eng_kind kind, const struct eng_point *points,
                         const uint32_t (*quads)[4], uint32_t *pairs, uint32_t count,
                         double tolerance, double t_end, struct eng_bracketed *out);

#endif

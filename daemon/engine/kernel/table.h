/* table.h - the list of kernels that each instruction set must define. */
#ifndef ENG_TABLE_H
#define ENG_TABLE_H

#include "kernel.h"
#include "lanes.h"

bool ENG_KERNEL(all_within)(const double *x, size_t count, double limit);
bool ENG_KERNEL(widen_within)(double *out, const float *x, size_t count, double limit);
uint32_t ENG_KERNEL(reject_axes)(enum pccd_kind kind, const struct eng_point *points,
                                 const uint32_t (*quads)[4], uint32_t count,
                                 uint32_t *kept);
uint32_t ENG_KERNEL(filter)(enum pccd_kind kind, const struct eng_point *points,
                            const uint32_t (*quads)[4], const uint32_t *pairs,
                            uint32_t count, uint32_t *kept);
uint32_t ENG_KERNEL(sift)(enum pccd_kind kind, struct eng_sieve *sieve, uint32_t *a,
                          uint32_t *b, uint32_t count);
uint32_t ENG_KERNEL(sift_near)(uint32_t kind, const struct eng_sieve *sieve, uint32_t end,
                               float reach, uint32_t *a, uint32_t *b, uint32_t count);

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
bool ENG_KERNEL(quantised_blocks)(const struct eng_wide_block *blocks,
                                  const struct eng_extents *around, uint32_t count,
                                  const struct eng_quantising *quantising,
                                  struct eng_quantised_block *quantised,
                                  struct eng_quantised_box *quantised_around,
                                  uint32_t *farthest);

uint64_t ENG_KERNEL(come_before)(const struct eng_split_item *items,
                                 const struct eng_split_item *pivot, int axis);
uint32_t ENG_KERNEL(box_gaps)(const float (*low)[ENG_WIDE], const float (*high)[ENG_WIDE],
                              const float box[2][4], float limit, float square[ENG_WIDE]);

uint32_t ENG_KERNEL(join_nodes)(struct eng_join *job, struct eng_join_round *round,
                                uint32_t *out_a, uint32_t *out_b, uint32_t room);
#define ENG_JOIN_FEATURES(NAME, value, name, ...)                                        \
    uint32_t ENG_KERNEL(join_##name)(struct eng_join * job,                              \
                                     struct eng_join_round * round, uint32_t * out_a,    \
                                     uint32_t * out_b, uint32_t room);
PCCD_KIND_LIST(ENG_JOIN_FEATURES)
ENG_JOIN_FEATURES(EF, 4, ef, )
#undef ENG_JOIN_FEATURES
void ENG_KERNEL(bracket)(enum pccd_kind kind, const struct eng_point *points,
                         const uint32_t (*quads)[4], uint32_t *pairs, uint32_t count,
                         double tolerance, double t_end, struct eng_bracketed *out);
uint32_t ENG_KERNEL(reject_at_end)(enum pccd_kind kind, const struct eng_point *points,
                                   const uint32_t (*quads)[4], uint32_t count,
                                   uint32_t end, double d, uint32_t *kept);
void ENG_KERNEL(measure)(enum pccd_kind kind, const struct eng_point *points,
                         const uint32_t (*quads)[4], const uint32_t *pairs,
                         uint32_t count, uint32_t end, double d,
                         struct eng_measured *out);
uint32_t ENG_KERNEL(reject_thick)(uint32_t points_a, const struct eng_point *points,
                                  const uint32_t (*quads)[4], uint32_t count,
                                  const double *reach, uint32_t *kept);
uint32_t ENG_KERNEL(sift_thick)(enum pccd_kind kind, struct eng_sieve *sieve, float reach,
                                uint32_t *a, uint32_t *b, uint32_t count);
void ENG_KERNEL(advance)(uint32_t kind, const struct eng_point *points,
                         const uint32_t (*quads)[4], const uint32_t *pairs,
                         uint32_t count, const struct eng_advance_limits *limits,
                         struct eng_advance *advance);
void ENG_KERNEL(describe)(uint32_t kind, const struct eng_point *points,
                          const uint32_t (*quads)[4], const uint32_t *pairs,
                          uint32_t count, struct eng_hit *hits);
void ENG_KERNEL(cross_faces)(const struct eng_point *points, const uint32_t (*pairs)[5],
                             uint32_t count, uint32_t end, struct eng_crossed *out);

#endif

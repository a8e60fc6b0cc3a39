/* distance_batch.h - the exact distances of many candidate pairs at once.
 *
 * Decide a chunk of pairs of one kind at one end of the step. What it says of a pair
 * equals what distance.h says, bit for bit, whatever the instruction set.
 *
 * Threads: one thread for one scratch.
 */
#ifndef ENG_DISTANCE_BATCH_H
#define ENG_DISTANCE_BATCH_H

#include "batch.h"
#include "distance.h"
#include "kernel.h"

struct eng_distance_question {
    enum pccd_kind kind;
    uint32_t end;    /* of the step: 0: the points' x0, 1: their x1 */
    double distance; /* 0 .. 1e18; exactly that is near enough */
    enum eng_distance_wanted wanted;
    bool is_sifted; /* most pairs that are certainly farther apart are gone already, so
                     * that looking for them once more is not worth it */
};

struct eng_distance_batch {
    /* Set by the owner, or NULL: never. Called after each pair that took integers, and
     * now and then among others that the kernels were not sure of; true: the rest of the
     * chunk is left out. */
    bool (*should_stop)(void *owner);
    void *owner;
    uint64_t exact;                /* counts: pairs that took integers */
    uint32_t index[ENG_CHUNK_MAX]; /* of the pairs that are near enough, in no order */
    struct eng_distance found[ENG_CHUNK_MAX]; /* likewise, what was wanted */
    uint32_t left[ENG_CHUNK_MAX];             /* scratch: pairs on their way through */
    uint32_t imprecise[ENG_CHUNK_MAX];
    uint32_t undecided[ENG_CHUNK_MAX];
};

/* Decide `count` pairs, at most ENG_CHUNK_MAX. quads: indices into `points`, as in
 * batch.h; word1 of the points, no two of a pair alike, is their rank where distances are
 * equal. Returns how many are within the distance. */
uint32_t eng_distance_batch_test(const struct eng_kernels *kernels,
                                 const struct eng_distance_question *question,
                                 const struct eng_point *points,
                                 const uint32_t (*quads)[4], uint32_t count,
                                 struct eng_distances *distances,
                                 struct eng_distance_batch *batch);

/* Which of `count` edges, at most ENG_CHUNK_MAX, pass through their faces at an end of
 * the step: eng_distance_crosses. fives: indices into `points`, the ends of the edge,
 * then the corners of the face. Returns how many: batch->index. */
uint32_t eng_distance_batch_cross(const struct eng_kernels *kernels, uint32_t end,
                                  const struct eng_point *points,
                                  const uint32_t (*fives)[5], uint32_t count,
                                  struct eng_distances *distances,
                                  struct eng_distance_batch *batch);

#endif

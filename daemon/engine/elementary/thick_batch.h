/* thick_batch.h - the elementary tests of many pairs of thick features at once.
 *
 * Threads: one thread for one scratch.
 */
#ifndef ENG_THICK_BATCH_H
#define ENG_THICK_BATCH_H

#include "batch.h"
#include "kernel.h"
#include "thick.h"

static_assert(ENG_CHUNK_MAX <= ENG_ADVANCE_MAX, "the kernel takes a chunk at a time");

struct eng_thick_question {
    uint32_t kind; /* PCCD_VF, PCCD_EE, PCCD_VE or PCCD_VV */
    double tolerance;
    double t_end; /* as for eng_thick_solve */
    double approach;
    bool is_sifted; /* to look whether they stay far apart is not worth it */
};

struct eng_thick_batch {
    /* Set by the owner, or NULL: never. Called after each pair that took integers, which
     * is 2 ms at most; true: the rest of the chunk is left out. */
    bool (*should_stop)(void *owner);
    void *owner;
    uint32_t survivors;            /* pairs that the kernels did not reject */
    uint64_t exact;                /* counts: pairs that took integers */
    uint32_t index[ENG_CHUNK_MAX]; /* of the pairs with a contact, in their order */
    struct eng_hit hits[ENG_CHUNK_MAX];
    uint32_t left[ENG_CHUNK_MAX]; /* scratch */
    double reach[ENG_CHUNK_MAX];
    struct eng_advance advance[ENG_CHUNK_MAX]; /* of those left */
};

/* Test `count` pairs, at most ENG_CHUNK_MAX. quads: indices into `points`, as in
 * batch.h; radius: of each pair, as in struct eng_thick_query; no pair is thin (thick.h).
 * Returns how many have a contact that begins before or at t_end. */
uint32_t eng_thick_batch_test(const struct eng_kernels *kernels,
                              const struct eng_thick_question *question,
                              const struct eng_point *points, const uint32_t (*quads)[4],
                              const double (*radius)[3], uint32_t count,
                              struct eng_thick *thick, struct eng_thick_batch *batch);

#endif

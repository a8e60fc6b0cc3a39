/* batch.h - does the elementary tests of many candidate pairs at once, with vector
 * instructions.
 *
 * Threads: one thread for one scratch.
 */
#ifndef ENG_BATCH_H
#define ENG_BATCH_H

#include "exact.h"
#include "kernel.h"

/* Pairs of one kind that are tested together: what they touch stays in the cache. */
#define ENG_CHUNK_MAX 1024u

/* Where the tests of a batch begin. */
enum eng_batch_from {
    ENG_FROM_AXES,   /* nothing is known of the pairs */
    ENG_FROM_FILTER, /* moving boxes do not separate them: no use to ask again */
    ENG_FROM_BRACKET /* nor would the filter reject many */
};

/* Answers to a chunk, and what the owner wants to be asked meanwhile. 64 KiB. */
struct eng_batch {
    /* Set by the owner; NULL: never. Called after each query that needed exact
     * arithmetic, and every 0.2 ms or so within one; true: the rest of the chunk is left
     * out, and the query at hand, too, if it has not been decided. */
    bool (*should_stop)(void *owner);
    void *owner;
    enum eng_batch_from from;      /* set by the owner */
    uint32_t survivors;            /* pairs that no filter rejected */
    uint32_t unsure_count;         /* of them: pairs that took a search one by one */
    uint32_t index[ENG_CHUNK_MAX]; /* of the pairs with a contact, in no order */
    struct eng_hit hits[ENG_CHUNK_MAX];
    uint32_t left[ENG_CHUNK_MAX]; /* scratch: pairs on their way through */
    uint32_t unsure[ENG_CHUNK_MAX];
};

/* Test `count` pairs, at most ENG_CHUNK_MAX. quads: indices into `points`, in the
 * order of struct eng_query. `tolerance` and `t_end` as for eng_solve. `exact`
 * NULL: pairs that take a search are left out, batch->unsure_count of them. Returns how
 * many pairs have a contact that begins before or at t_end: batch->index[i] is the pair,
 * batch->hits[i] its hit. */
uint32_t eng_batch_test(const struct eng_kernels *kernels, enum pccd_kind kind,
                        const struct eng_point *points, const uint32_t (*quads)[4],
                        uint32_t count, double tolerance, double t_end,
                        struct eng_exact *exact, struct eng_batch *batch);

#endif

/* wide_join.h - finds the pairs of features that may meet below two nodes.
 *
 * Threads: one thread for one join; the trees are only read.
 */
#ifndef ENG_WIDE_JOIN_H
#define ENG_WIDE_JOIN_H

#include "batch.h"
#include "question.h"
#include "wide.h"

struct eng_wide_owners; /* wide_owner.h */

/* Pairs of slots, one of either side's tree; of two in one tree in any order. */
struct eng_wide_chunk {
    uint32_t count;
    uint32_t a[ENG_CHUNK_MAX + ENG_SIEVE_SPARE];
    uint32_t b[ENG_CHUNK_MAX + ENG_SIEVE_SPARE];
};

struct eng_wide_join {
    const struct eng_kernels *kernels;
    const struct eng_wide_owners *owners; /* that are asked; NULL: anything may meet */
    const struct eng_wide *wide;
    uint32_t kinds; /* bit k: pairs of kind k are looked for; VF and EE */
    void *owner;
    /* Called when a chunk has no room for all that two blocks may add: takes the pairs
     * and sets the count to 0. */
    void (*flush)(void *owner, enum pccd_kind kind, struct eng_wide_chunk *chunk);
    /* Called now and then: may set stopped, or t_end by eng_wide_join_until. */
    void (*look)(void *owner);
    bool stopped;                      /* the join ends early */
    uint32_t looked;                   /* joins since the last look */
    uint64_t pairs;                    /* pairs of nodes refined */
    uint64_t below[COMMON_KIND_COUNT]; /* pairs of nodes that they led to */
    struct eng_join jobs[COMMON_KIND_COUNT][ENG_WIDE_LEVELS_MAX];
    struct eng_wide_list lists[ENG_WIDE_LEVELS_MAX];
    struct eng_join_round round;
    struct eng_wide_chunk chunks[COMMON_KIND_COUNT];
};

/* Get ready for the trees as they are; owner, flush and look are set by the caller, and
 * `owners` where pairs are to be left out. Boxes are ENG_JOIN_SWEPT if the refit made
 * them so, else ENG_JOIN_MOVING. */
void eng_wide_join_begin(struct eng_wide_join *join, const struct eng_wide *wide,
                         enum eng_join_boxes boxes);

/* Leave out pairs of which neither moves: what does is marked (wide.h). */
void eng_wide_join_prune(struct eng_wide_join *join, const struct eng_wide *wide);

/* Leave out, of the kinds that are asked for, what is certainly farther apart than the
 * distance, along an axis, at that end of the step. The join was begun with
 * ENG_JOIN_AT. */
void eng_wide_join_at(struct eng_wide_join *join, const struct eng_wide *wide,
                      const struct eng_question *question);

/* Leave out from now on what certainly does not meet before or at `t_end`, 0 .. 1, which
 * is never more than the last time. Once it is near, boxes around the way until then are
 * compared (ENG_JOIN_NEAR), and times of pairs are no longer looked at (in_time). */
void eng_wide_join_until(struct eng_wide_join *join, float t_end);

/* Find all pairs that nodes n and m of a level lead to: n is of the tree of the kind's
 * first side, m of that of the second. If both have one tree, n == m stands for all pairs
 * below one node. */
void eng_wide_join_nodes(struct eng_wide_join *join, enum pccd_kind kind, uint32_t level,
                         uint32_t n, uint32_t m);

/* Refine nodes n and m of a level >= 1 once: what it leads to is in join->lists[level -
 * 1], which must be empty before and after. */
void eng_wide_join_refine(struct eng_wide_join *join, enum pccd_kind kind, uint32_t level,
                          uint32_t n, uint32_t m);

/* Hand over what is left in the chunks. */
void eng_wide_join_flush(struct eng_wide_join *join);

/* Return how many of the pairs that nodes led to so far were left out for their times. */
uint64_t eng_wide_join_nodes_apart(const struct eng_wide_join *join, enum pccd_kind kind);

/* Return how many boxes were tested against a block so far. */
uint64_t eng_wide_join_test_count(const struct eng_wide_join *join);

/* Return how many pairs were left out so far as neither moves. */
uint64_t eng_wide_join_still_count(const struct eng_wide_join *join);

#endif

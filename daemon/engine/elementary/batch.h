/* batch.h - decides many candidate pairs at once: one driver over a table of rows.
 *
 *     reject, in lanes -> decide, in lanes -> ask one by one -> describe, in lanes
 *
 * A row says how that is done for one way to ask: do the features meet, do they meet at a
 * distance, how far apart are they, does the edge pass through the face. What it says of
 * a pair equals what solve.h, thick.h and distance.h say, bit for bit, whatever the
 * instruction set.
 *
 * Threads: one thread for one struct eng_batch.
 */
#ifndef ENG_BATCH_H
#define ENG_BATCH_H

#include "exact.h"
#include "kernel.h"
#include "question.h"

struct eng_distances;
struct eng_thick;

/* Pairs of one kind that are tested together: what they touch stays in the cache. */
#define ENG_CHUNK_MAX 1024u

static_assert(ENG_CHUNK_MAX <= ENG_ADVANCE_MAX, "the kernel takes a chunk at a time");

/* The knowledge about pairs, by which their tests begin later. */
enum eng_known {
    ENG_KNOWN_NOTHING,
    ENG_KNOWN_BOXES, /* their boxes do not separate them: no use to ask again */
    ENG_KNOWN_SIEVED /* nor would what is asked first reject many */
};

/* Candidates of one kind, and what is asked of them. */
struct eng_pairs {
    /* Its verb, mode, span or end, tolerance, approach; whether it is brief: then pairs
     * that have to be asked one by one are left out. */
    const struct eng_question *question;
    uint32_t kind; /* enum pccd_kind, or PCCD_EF, which is asked whether it crosses */
    enum eng_known known;
    uint32_t count; /* at most ENG_CHUNK_MAX */
    /* Of contacts at both ends of the span. Distances: the points of a pair differ in
     * word1, which decides between nearest features at equal distances. */
    const struct eng_point *points;
    const uint32_t (*quads)[4]; /* indices into `points`, in the order of query.h */
    const uint32_t (*fives)[5]; /* EF: the ends of the edge, the corners of the face */
    /* Of pairs that meet at a distance (query.h), none of them thin (thick.h); else
     * NULL. */
    const double (*radius)[3];
    double t_end; /* contacts that begin after that time of the step are not wanted */
    double reach; /* distances: 0 .. 1e18; exactly that is near enough */
};

/* Scratch of pairs that meet at a distance. */
struct eng_thick_lanes {
    double reach[ENG_CHUNK_MAX];
    struct eng_advance advance[ENG_CHUNK_MAX]; /* of those left */
};

/* Answers to a chunk, and what the owner wants to be asked meanwhile. */
struct eng_batch {
    /* Set by the owner. */
    const struct eng_kernels *kernels;
    /* Return whether to leave out the rest of the chunk. Called after each pair that took
     * integers, now and then among others that are asked one by one, and every 0.2 ms or
     * so within one that takes long. NULL: never. */
    bool (*should_stop)(void *owner);
    void *owner;
    struct eng_exact *contacts;      /* of pairs that meet at no distance */
    struct eng_thick *thick;         /* of those that do, .. */
    struct eng_thick_lanes *lanes;   /* .. in lanes */
    struct eng_distances *distances; /* of what is near, or crosses */

    uint64_t integers;  /* counts pairs that took integers, but for `contacts` */
    uint32_t survivors; /* pairs that the lanes did not reject */
    uint32_t found;     /* pairs that are what is asked for: these, in no order, .. */
    uint32_t index[ENG_CHUNK_MAX];
    union { /* .. and what is known of them */
        struct eng_hit hits[ENG_CHUNK_MAX];
        struct eng_distance near[ENG_CHUNK_MAX]; /* as much as the verb wants */
    };
    uint32_t unsure_count; /* pairs that are asked one by one */

    /* Scratch. */
    bool has_stopped;
    uint32_t near_count;          /* of the unsure: these first are within the reach */
    double t_end, tolerance;      /* in the time of the span */
    uint32_t left[ENG_CHUNK_MAX]; /* pairs on their way through */
    /* Pairs that lanes leave open; of thick features, their places in `left`. */
    uint32_t unsure[ENG_CHUNK_MAX];
    uint32_t undecided[ENG_CHUNK_MAX]; /* of these, in lanes once more */
};

/* Find which of the pairs are what is asked for, and keep them in batch->index and so on.
 * Return how many. Times are those of the step (struct eng_question, span). */
uint32_t eng_batch_test(struct eng_batch *batch, const struct eng_pairs *pairs);

#endif

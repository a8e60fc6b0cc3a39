/* tally.h - what became of requests.
 *
 * Room:     client/load. May include: the C library.
 * Does:     count by outcome, and latencies in a histogram of eight bins an octave.
 * Does not: lock: a tally has one writer; who reads it waits for the writer's end.
 * Threads:  one writer.
 */
#ifndef LOAD_TALLY_H
#define LOAD_TALLY_H

#include <stdint.h>

/* X(name, text). The first is the sum of the next five. */
#define LOAD_COUNTS(X)                                                                   \
    X(submitted, "requests that the library took")                                       \
    X(answered, "with an answer that was checked")                                       \
    X(refused, "with an error, as the request deserved")                                 \
    X(cancelled, "with an incomplete answer, as it was cancelled or due")                \
    X(failed, "with an error or an early end that nobody asked for")                     \
    X(lost, "never answered")                                                            \
    X(doubled, "answers to a request that was answered")                                 \
    X(crossed, "answers that belong to another request")                                 \
    X(wrong, "answers that belong to none")                                              \
    X(broken, "connections that failed")                                                 \
    X(opened, "connections made")                                                        \
    X(remade, "scenes, meshes or objects made anew on purpose")

#define LOAD_BINS 512u

struct load_times {
    uint64_t longest_ns;
    uint64_t bins[LOAD_BINS];
};

void load_times_add(struct load_times *times, uint64_t ns);

/* The upper end of the bin below which the share lies, nanoseconds; 0 without any. */
uint64_t load_times_quantile(const struct load_times *times, double share);

struct load_tally {
#define LOAD_COUNT_FIELD(name, text) uint64_t name;
    LOAD_COUNTS(LOAD_COUNT_FIELD)
#undef LOAD_COUNT_FIELD
    uint64_t records;          /* of the answers that were checked */
    struct load_times latency; /* from commit to answer, of those that were checked */
    struct load_times inside;  /* of these, from arrival at the daemon to the answer */
};

void load_tally_add(struct load_tally *sum, const struct load_tally *tally);

#endif

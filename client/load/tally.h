/* tally.h - counts what became of requests: answered, refused, lost, and how fast.
 *
 * Threads: one writer.
 */
#ifndef LOAD_TALLY_H
#define LOAD_TALLY_H

#include <stdint.h>

/* ---- A histogram of times, for percentiles. */

#define LOAD_HIST_SUB  128u /* bins of an octave; below so many ns, a bin each */
#define LOAD_HIST_BINS ((40u - 7u + 1u) * LOAD_HIST_SUB)

struct load_hist {
    uint64_t count;
    uint64_t longest_ns; /* exact */
    uint64_t bins[LOAD_HIST_BINS];
};

void load_hist_add(struct load_hist *hist, uint64_t ns);

/* Add *hist, which somebody may be writing to, to *sum; what is added to the count is the
 * sum of the bins. */
void load_hist_merge(struct load_hist *sum, const struct load_hist *hist);

/* Write what came after `earlier`, a former state of `now`. Its longest time is the end
 * of its last bin. */
void load_hist_since(const struct load_hist *now, const struct load_hist *earlier,
                     struct load_hist *since);

/* Return how many are in bins that begin after so long. */
uint64_t load_hist_above(const struct load_hist *hist, uint64_t ns);

/* Return the upper end of the bin that the share reaches, or the longest time where that
 * is less, nanoseconds; 0 without any. */
uint64_t load_hist_quantile(const struct load_hist *hist, double share);

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
    X(remade, "scenes, meshes or objects made anew on purpose")                          \
    X(nears, "answers that were checked, about what is near")                            \
    X(stalled, "times that a client stopped on purpose")                                 \
    X(measured, "answers whose latency counts: the warm-up's do not")                    \
    X(late, "of these, submitted a millisecond or more after they were due")             \
    X(missed, "of these, answered after the deadline")                                   \
    X(unsent, "due in the open loop, not asked until the deadline, and time was up")

struct load_tally {
#define LOAD_COUNT_FIELD(name, text) uint64_t name;
    LOAD_COUNTS(LOAD_COUNT_FIELD)
#undef LOAD_COUNT_FIELD
    uint64_t records;         /* of the answers that were checked */
    struct load_hist latency; /* of those that count, from when they were due (in the open
                                 loop) or committed (in the closed one) to the answer */
    struct load_hist inside;  /* of these, from arrival at the daemon to the answer */
};

void load_tally_add(struct load_tally *sum, const struct load_tally *tally);

#endif

/* tally.c - what became of requests.
 *
 * Room:     client/load.
 * Does:     see tally.h.
 * Threads:  tally.h.
 */
#include "tally.h"

/* Below 8 ns a bin each; above, eight bins between powers of two: 12 % wide. */
static unsigned bin_of(uint64_t ns)
{
    if (ns < 8) {
        return (unsigned)ns;
    }
    unsigned octave = 63u - (unsigned)__builtin_clzll(ns);
    return (octave - 2) * 8 + (unsigned)(ns >> (octave - 3) & 7);
}

static uint64_t end_of(unsigned bin)
{
    if (bin < 8) {
        return bin + 1;
    }
    unsigned octave = bin / 8 + 2;
    return (uint64_t)(9 + bin % 8) << (octave - 3);
}

void load_times_add(struct load_times *times, uint64_t ns)
{
    times->bins[bin_of(ns)]++;
    times->longest_ns = ns > times->longest_ns ? ns : times->longest_ns;
}

static void add_times(struct load_times *sum, const struct load_times *times)
{
    if (times->longest_ns > sum->longest_ns) {
        sum->longest_ns = times->longest_ns;
    }
    for (unsigned i = 0; i < LOAD_BINS; i++) {
        sum->bins[i] += times->bins[i];
    }
}

void load_tally_add(struct load_tally *sum, const struct load_tally *tally)
{
#define LOAD_COUNT_ADD(name, text) sum->name += tally->name;
    LOAD_COUNTS(LOAD_COUNT_ADD)
#undef LOAD_COUNT_ADD
    sum->records += tally->records;
    add_times(&sum->latency, &tally->latency);
    add_times(&sum->inside, &tally->inside);
}

uint64_t load_times_quantile(const struct load_times *times, double share)
{
    uint64_t all = 0;
    uint64_t below = 0;
    for (unsigned i = 0; i < LOAD_BINS; i++) {
        all += times->bins[i];
    }
    for (unsigned i = 0; i < LOAD_BINS; i++) {
        below += times->bins[i];
        if (all > 0 && (double)below >= share * (double)all) {
            return end_of(i) < times->longest_ns ? end_of(i) : times->longest_ns;
        }
    }
    return 0;
}

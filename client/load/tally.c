/* tally.c - what became of requests. */
#include "tally.h"

#include <math.h>
#include <string.h>

/* ---- How often which time was seen. */

#define SUB_BITS 7u

_Static_assert(LOAD_HIST_SUB == 1u << SUB_BITS, "bins of an octave");

static unsigned bin_of(uint64_t ns)
{
    if (ns < LOAD_HIST_SUB) {
        return (unsigned)ns;
    }
    unsigned octave = 63u - (unsigned)__builtin_clzll(ns);
    unsigned bin = (octave - SUB_BITS + 1) * LOAD_HIST_SUB +
                   (unsigned)(ns >> (octave - SUB_BITS) & (LOAD_HIST_SUB - 1));
    return bin < LOAD_HIST_BINS ? bin : LOAD_HIST_BINS - 1;
}

/* The largest time of a bin. */
static uint64_t end_of(unsigned bin)
{
    if (bin < LOAD_HIST_SUB) {
        return bin;
    }
    unsigned octave = bin / LOAD_HIST_SUB + SUB_BITS - 1;
    uint64_t step = 1ull << (octave - SUB_BITS);
    return (LOAD_HIST_SUB + bin % LOAD_HIST_SUB + 1) * step - 1;
}

static uint64_t read_word(const uint64_t *word)
{
    return __atomic_load_n(word, __ATOMIC_RELAXED); /* a count by itself: no order */
}

static void write_word(uint64_t *word, uint64_t value)
{
    __atomic_store_n(word, value, __ATOMIC_RELAXED);
}

void load_hist_add(struct load_hist *hist, uint64_t ns)
{
    uint64_t *bin = &hist->bins[bin_of(ns)];
    write_word(bin, *bin + 1);
    write_word(&hist->count, hist->count + 1);
    if (ns > hist->longest_ns) {
        write_word(&hist->longest_ns, ns);
    }
}

void load_hist_merge(struct load_hist *sum, const struct load_hist *hist)
{
    uint64_t longest_ns = read_word(&hist->longest_ns);
    sum->longest_ns = longest_ns > sum->longest_ns ? longest_ns : sum->longest_ns;
    for (unsigned i = 0; i < LOAD_HIST_BINS; i++) {
        uint64_t count = read_word(&hist->bins[i]);
        sum->bins[i] += count;
        sum->count += count;
    }
}

void load_hist_since(const struct load_hist *now, const struct load_hist *earlier,
                     struct load_hist *since)
{
    memset(since, 0, sizeof *since);
    for (unsigned i = 0; i < LOAD_HIST_BINS; i++) {
        since->bins[i] = now->bins[i] - earlier->bins[i];
        since->count += since->bins[i];
        if (since->bins[i] > 0) {
            since->longest_ns = end_of(i);
        }
    }
    if (since->longest_ns > now->longest_ns) {
        since->longest_ns = now->longest_ns;
    }
}

uint64_t load_hist_above(const struct load_hist *hist, uint64_t ns)
{
    uint64_t above = 0;
    for (unsigned i = bin_of(ns) + 1; i < LOAD_HIST_BINS; i++) {
        above += hist->bins[i];
    }
    return above;
}

uint64_t load_hist_quantile(const struct load_hist *hist, double share)
{
    double rank = fmax(ceil(share * (double)hist->count), 1);
    uint64_t below = 0;
    for (unsigned i = 0; i < LOAD_HIST_BINS; i++) {
        below += hist->bins[i];
        if (hist->count > 0 && (double)below >= rank) {
            return end_of(i) < hist->longest_ns ? end_of(i) : hist->longest_ns;
        }
    }
    return 0;
}

void load_tally_add(struct load_tally *sum, const struct load_tally *tally)
{
#define LOAD_COUNT_ADD(name, text) sum->name += tally->name;
    LOAD_COUNTS(LOAD_COUNT_ADD)
#undef LOAD_COUNT_ADD
    sum->records += tally->records;
    load_hist_merge(&sum->latency, &tally->latency);
    load_hist_merge(&sum->inside, &tally->inside);
}

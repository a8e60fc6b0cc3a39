/* tally.c - what became of requests. */
#include "tally.h"

void load_tally_add(struct load_tally *sum, const struct load_tally *tally)
{
#define LOAD_COUNT_ADD(name, text) sum->name += tally->name;
    LOAD_COUNTS(LOAD_COUNT_ADD)
#undef LOAD_COUNT_ADD
    sum->records += tally->records;
    load_hist_merge(&sum->latency, &tally->latency);
    load_hist_merge(&sum->inside, &tally->inside);
}

/* sorting.h - compares the engine's sort of records with plainer ways to sort them.
 *
 * Threads: one; it opens regions of two.
 */
#ifndef BENCH_SORTING_H
#define BENCH_SORTING_H

#include "gather.h"

/* `repeats` of each, the first not counted; the records as pairs and, of the first of
 * them, as contacts. */
void bench_sorting_measure(const struct bench_work *work, unsigned repeats);

#endif

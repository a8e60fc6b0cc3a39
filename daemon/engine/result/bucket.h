/* bucket.h - one bucket of the sort that brings an answer into order: gather, sort, copy,
 * hash.
 *
 * Threads: [team], after all lists are divided; a bucket is one thread's.
 */
#ifndef ENG_BUCKET_H
#define ENG_BUCKET_H

#include "merge_data.h"

/* Sort bucket `b`, put its records into the answer, and add what they are to *counts. */
void eng_bucket_finish(struct eng_merge *merge, uint32_t b, struct eng_counts *counts);

#endif

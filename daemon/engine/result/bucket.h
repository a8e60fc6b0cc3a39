/* daemon/engine/result/bucket.h - one bucket of the sort that brings an answer into
 * order: gather, sort, copy, hash.
 *
 * Room:     engine. May include: merge_data.h.
 * Does:     handle the records whose keys lie between two splitters: gather them, sort
 *           them, copy them to their places, count and hash them.
 * Threads:  [team], after all lists are divided; a bucket is one thread's.
 */
#ifndef ENG_BUCKET_H
#define ENG_BUCKET_H

#include "merge_data.h"

/* Sort bucket `b`, put its records into the answer, and add what they are to *counts. */
void eng_bucket_finish(struct eng_merge *merge, uint32_t b, struct eng_counts *counts);

#endif

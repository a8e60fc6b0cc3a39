/* daemon/engine/result/bucket.h - one bucket of an answer.
 *
 * Room:     engine. May include: merge.h.
 * Does:     the records whose keys lie between two splitters: bring them together, sort
 *           them, copy them to their places, hash what lies there.
 * Threads:  [team], after all lists are divided; a bucket is one thread's.
 */
#ifndef ENG_BUCKET_H
#define ENG_BUCKET_H

#include "merge.h"

/* Sort bucket `b` and put its records into the answer; counts are added to *counts. Fills
 * in merge->position and size. */
void eng_bucket_finish(struct eng_merge *merge, uint32_t b, struct eng_counts *counts);

/* The blocks of the answer (hash.h) blocks[0] .. blocks[1] - 1 that lie in bucket `b` as
 * a whole; none if the second is no larger. */
void eng_bucket_blocks(const struct eng_merge *merge, uint32_t b, uint64_t blocks[2]);

/* Fill in the sums of these blocks. */
void eng_bucket_hash(struct eng_merge *merge, uint32_t b);

#endif

/* daemon/engine/wide/wide_test.h - what a worker needs to find contacts in wide trees.
 *
 * Room:     engine. May include: wide_join.h, worker.h.
 * Does:     hand the chunks of a join to the elementary tests, keep what they find under
 *           the names of the caller; or keep the candidates themselves (mode pairs).
 * Threads:  [team].
 */
#ifndef ENG_WIDE_TEST_H
#define ENG_WIDE_TEST_H

#include "wide_join.h"
#include "worker.h"

/* When the join looks at times (boxes.h). */
struct eng_wide_times {
    uint64_t apart;          /* job.apart_in_time when the last chunk went */
    uint32_t chunks_without; /* chunks until it looks again */
};

/* Which filters see a chunk: each goes where it has rejected enough before. */
struct eng_wide_filters {
    uint32_t chunks_without_sieve;  /* until the sieve is tried again */
    uint32_t chunks_without_filter; /* until the filter behind it is */
};

struct eng_wide_work {
    struct eng_wide_join join;
    struct eng_wide_times times[ENG_KINDS];
    struct eng_wide_filters filters[ENG_KINDS];
    struct eng_sieve sieves[ENG_KINDS];
    uint32_t quads[ENG_CHUNK_MAX][4]; /* vertex slots of a chunk's pairs */
    struct eng_batch batch;
};

/* Memory for a worker, once. ENG_E_NOMEM. [compute] */
int eng_wide_work_reserve(struct eng_worker *worker);

/* Get ready for the traversal of a step. [team] */
void eng_wide_work_begin(struct eng_worker *worker);

/* Count what the join did. [team] */
void eng_wide_work_end(struct eng_worker *worker);

#endif

/* wide_test.h - tests the pairs that a join of the wide trees has found. */
#ifndef ENG_WIDE_TEST_H
#define ENG_WIDE_TEST_H

#include "deque.h"
#include "wide_join.h"
#include "worker.h"

/* When the join looks at times (boxes.h). */
struct eng_wide_times {
    uint64_t apart;          /* job.apart_in_time when the last chunk went */
    uint32_t chunks_without; /* chunks until it looks again */
};

struct eng_wide_work {
    struct eng_partition shares[ENG_WIDE_TREES]; /* chunks of the refit */
    struct eng_wide_join join;
    struct eng_wide_times times[COMMON_KIND_COUNT];
    struct eng_sieve sieves[COMMON_KIND_COUNT];
    uint32_t quads[ENG_CHUNK_MAX][4]; /* vertex slots of a chunk's pairs */
    uint32_t fives[ENG_CHUNK_MAX][5]; /* the same of edges and faces */
    bool has_leads;                   /* that this worker has not looked at */
};

static inline struct eng_wide_work *eng_wide_work_of(const struct eng_worker *worker)
{
    return worker->work[PCCD_METHOD_WIDE];
}

/* Pairs that a brief step (question->brief) tests, at most: each takes up to 0.3 us of a
 * vector kernel, as none is searched for. */
#define ENG_BRIEF_TESTS       64u
#define ENG_BRIEF_TESTS_ALONE 16384u /* question->alone, too */

/* Allocate memory for a worker, once. PCCD_E_NOMEM. [compute] */
int eng_wide_work_reserve(struct eng_worker *worker);
void eng_wide_work_free(struct eng_worker *worker);
uint64_t eng_wide_work_bytes(const struct eng_worker *worker);

/* Get ready for the traversal of a step. [team] */
void eng_wide_work_begin(struct eng_worker *worker);

/* Test, before the first task of a worker, the pairs that bounded vertices in the last
 * answer: workers share them out. [team] */
void eng_wide_work_leads(struct eng_worker *worker);

/* Count what the join did. [team] */
void eng_wide_work_end(struct eng_worker *worker);

#endif

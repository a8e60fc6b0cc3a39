/* daemon/engine/elementary/test.h - elementary tests of a chunk of candidates.
 *
 * Room:     engine. May include: solve.h, worker.h.
 * Does:     filter, solve, record; or record the candidates themselves (mode pairs).
 * Threads:  [team].
 */
#ifndef ENG_TEST_H
#define ENG_TEST_H

#include "solve.h"
#include "worker.h"

/* Test and empty one of the worker's chunks. */
void eng_test_chunk(struct eng_worker *worker, enum eng_kind kind);

/* Count candidates whose boxes overlap, tested or not. */
void eng_test_count(struct eng_worker *worker, enum eng_kind kind, uint32_t candidates);

/* The tests of a chunk, `tested` of them, that began at `begin_ns` end now. */
void eng_test_end(struct eng_worker *worker, enum eng_kind kind, uint32_t tested,
                  uint64_t begin_ns);

/* Keep what a test has found, as the mode of the step wants it. */
void eng_test_keep(struct eng_worker *worker, const struct eng_pair *name,
                   const struct eng_hit *hit);

/* The query of a candidate: global indices as in struct eng_chunk. */
void eng_query_load(const struct eng_scene *scene, enum eng_kind kind, uint32_t a,
                    uint32_t b, struct eng_query *query);

#endif

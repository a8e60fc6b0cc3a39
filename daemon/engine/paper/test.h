/* test.h - tests the pairs of features that a traversal has found. */
#ifndef ENG_TEST_H
#define ENG_TEST_H

#include "paper_work.h"
#include "solve.h"
#include "worker.h"

/* Test and empty one of the worker's chunks. */
void eng_test_chunk(struct eng_worker *worker, enum pccd_kind kind);

/* The query of a candidate: global indices as in struct eng_chunk. */
void eng_query_load(const struct eng_scene *scene, enum pccd_kind kind, uint32_t a,
                    uint32_t b, struct eng_query *query);

#endif

/* finding.h - what a thread does with a contact that it has found. */
#ifndef ENG_FINDING_H
#define ENG_FINDING_H

#include "query.h"
#include "worker.h"

/* The names of candidates index[count] of those that a method has at hand. */
typedef void (*eng_names_fn)(const struct eng_worker *worker, enum pccd_kind kind,
                             const uint32_t *index, uint32_t count,
                             struct pccd_pair *names);

/* Count candidates whose boxes overlap, tested or not. */
void eng_test_count(struct eng_worker *worker, enum pccd_kind kind, uint32_t candidates);

/* The tests of a chunk, `tested` of them, that began at `begin_ns` end now. */
void eng_test_end(struct eng_worker *worker, enum pccd_kind kind, uint32_t tested,
                  uint64_t begin_ns);

/* Keep what a test has found, as the mode of the step wants it. */
void eng_test_keep(struct eng_worker *worker, const struct pccd_pair *name,
                   const struct eng_hit *hit);

#endif

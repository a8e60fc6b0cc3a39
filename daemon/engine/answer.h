/* answer.h - turns what the threads of a step have found into the answer of the step.
 *
 * Threads: begin: [compute], when the workers are ready; by_team: [team], each thread
 * when it has searched; end: [compute], after the parallel region or without.
 */
#ifndef ENG_ANSWER_H
#define ENG_ANSWER_H

#include "step_memory.h"
#include "team.h"

/* Begin an answer, which will be in `out`. PCCD_E_NOMEM. */
int eng_answer_begin(struct eng_step_memory *memory, const struct eng_team *team,
                     struct eng_records *out);

/* Take what stands out of the last answer, for a team that prunes (team.h). In mode any
 * the step may be decided then: it is stopped. [compute] */
void eng_answer_keep(struct eng_step_memory *memory, const struct eng_team *team);

/* Do the calling thread's share: `worker` is its own. Fills in record.merge_ns; waits for
 * the others once, or twice if there is much to merge, and in mode first once more. */
void eng_answer_by_team(struct eng_step_memory *memory, const struct eng_team *team,
                        struct eng_worker *worker);

/* Fill in records, counts, verdict, hash and, where records were lost, `incomplete`;
 * result->mode, record_bytes, toi_first and incomplete are set already. Without memory to
 * sort the answer is empty and incomplete. */
void eng_answer_end(struct eng_step_memory *memory, const struct eng_team *team,
                    struct eng_step_result *result);

/* Put what the workers found in order into the list that begin was given, and count it.
 * Say why that is not all of it: question->contact_max, memory (PCCD_E_NOMEM, and the
 * list is empty), or as the stop does. */
int eng_answer_collect(struct eng_step_memory *memory, const struct eng_team *team,
                       enum pccd_incomplete *incomplete, struct eng_counts *counts);

/* Set the hash to that of an answer without records and without a verdict. [any] */
void eng_answer_nothing(struct eng_step_result *result);

#endif

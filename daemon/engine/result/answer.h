/* daemon/engine/result/answer.h - from what the workers found to the answer of a step.
 *
 * Room:     engine. May include: step_memory.h, team.h.
 * Does:     bring the workers' records into one canonical list, hash it, count it.
 * Threads:  [compute], after the parallel region.
 */
#ifndef ENG_ANSWER_H
#define ENG_ANSWER_H

#include "step_memory.h"
#include "team.h"

/* Fill in records, counts, verdict, hash and, where records were lost, `incomplete`;
 * result->mode, record_bytes, toi_first and incomplete are set already. */
void eng_answer(struct eng_step_memory *memory, const struct eng_team *team,
                struct eng_step_result *result);

#endif

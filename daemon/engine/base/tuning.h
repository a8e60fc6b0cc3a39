/* tuning.h - the text by which a client tunes how threads share a step, and whether it
 * uses what stands still: "scheduler=paper,refit=paper".
 */
#ifndef ENG_TUNING_H
#define ENG_TUNING_H

#include "question.h"
#include "step_result.h"

#define ENG_TUNING_WHY_BYTES 128

/* Set what `text` names, and leave the rest of `tuning` as it is; "" names nothing. Any
 * of the four may stand, in any order, once each. PCCD_E_INVAL: `tuning` is as before
 * and `why` says what is wrong, in printable ASCII whatever `text` holds. What is
 * accepted is shorter than PCCD_TUNING_BYTES. */
int eng_tuning_read(const char *text, struct eng_tuning *tuning,
                    char why[ENG_TUNING_WHY_BYTES]);

/* What a step has used, as eng_tuning_read takes it: "" where a thread was alone, and so
 * shared nothing. The method wide always steals, refits in one way, and has no
 * high-level nodes. */
void eng_tuning_used(const struct eng_question *question,
                     const struct eng_step_result *result, char text[PCCD_TUNING_BYTES]);

#endif

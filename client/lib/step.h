/* step.h - collects the answers of steps that were submitted.
 *
 * Room:     client/lib, private. May include: client.h.
 * Does:     take in what has arrived, and fetch pages of answers.
 * Threads:  [owner].
 */
#ifndef CLI_STEP_H
#define CLI_STEP_H

#include "client.h"

/* Take in what has arrived, without waiting. */
void cli_step_drain(struct pccd_client *client);

/* A page of an answer, by frame.fetch or near.fetch, into *answer. */
int cli_step_fetch(struct pccd_client *client, int method, const void *request,
                   struct pccd_answer *answer);

/* May it be filled in? E_INVAL: it is NULL, or of a length that no release has. */
int cli_answer_check(struct pccd_client *client, const struct pccd_answer *answer);

/* Wait for the answer to `step`; what times out is abandoned. */
int cli_step_finish(struct pccd_client *client, uint64_t step,
                    struct pccd_answer *answer);

#endif

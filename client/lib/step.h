/* step.h - collects the answers of steps that were submitted. */
#ifndef CLI_STEP_H
#define CLI_STEP_H

#include "client.h"

/* Take in what has arrived, without waiting. */
void cli_step_drain(struct pccd_client *client);

/* The oldest step whose answer has come and is not taken; or the oldest batch. NULL:
 * there is none. */
struct cli_call *cli_step_oldest_done(struct pccd_client *client, bool is_batch);

/* Wait until the answer to `step`, or to that batch, has come: 0 with *call DONE;
 * E_INVAL: it is not pending, or the other kind; E_AGAIN (timeout_ms 0), E_TIMEOUT. */
int cli_step_await(struct pccd_client *client, uint64_t step, bool is_batch,
                   int timeout_ms, struct cli_call **call);

/* A page of an answer, by frame.fetch or near.fetch, into *answer. */
int cli_step_fetch(struct pccd_client *client, int method, const void *request,
                   struct pccd_answer *answer);

/* May it be filled in? E_INVAL: it is NULL, or of a length that no release has. */
int cli_answer_check(struct pccd_client *client, const struct pccd_answer *answer);

/* Wait for the answer to `step`; what times out is abandoned. */
int cli_step_finish(struct pccd_client *client, uint64_t step,
                    struct pccd_answer *answer);

#endif

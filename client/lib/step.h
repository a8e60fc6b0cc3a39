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

/* A page of an answer, into *answer. */
int cli_step_fetch(struct pccd_client *client,
                   const struct proto_FRAME_FETCH_request *request,
                   struct pccd_answer *answer);

#endif

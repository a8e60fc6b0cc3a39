/* step.h - steps that were submitted.
 *
 * Room:     client/lib, private. May include: client.h.
 * Does:     what frame.c needs of step.c.
 * Threads:  [owner].
 */
#ifndef CLI_STEP_H
#define CLI_STEP_H

#include "client.h"

/* Whether another step can be submitted: 0, or PCCD_E_BUSY when CLI_STEPS answers wait to
 * be taken, or too many pages wait to be released; or PCCD_E_DISCONNECTED. */
int cli_step_check(struct pccd_client *client);

/* Send frame.submit. `slot` is published with `seq`, or CLI_SLOT_NONE with segments = 0;
 * it comes back with the answer, or at once on failure. */
int cli_step_send(struct pccd_client *client, uint32_t scene, uint32_t slot, uint64_t seq,
                  uint32_t segment_count, const struct pccd_step_settings *settings,
                  uint64_t *step);

/* Take in what has arrived, without waiting. */
void cli_step_drain(struct pccd_client *client);

/* A page of an answer, into *answer. */
int cli_step_fetch(struct pccd_client *client,
                   const struct proto_FRAME_FETCH_request *request,
                   struct pccd_answer *answer);

#endif

/* submit.h - submits a step whose positions are written. */
#ifndef CLI_SUBMIT_H
#define CLI_SUBMIT_H

#include "client.h"

/* Whether another step can be submitted: 0, or PCCD_E_BUSY when CLI_STEPS answers wait to
 * be taken, or too many pages wait to be released; or PCCD_E_DISCONNECTED. */
int cli_step_check(struct pccd_client *client);

/* Send frame.submit, which cli_step_check allows. A `slot` that is begun is published
 * with it, and comes back with the answer, or at once on failure; CLI_SLOT_NONE: nothing
 * moves. */
int cli_step_send(struct pccd_client *client, uint32_t scene, uint32_t slot,
                  const struct pccd_step_settings *settings, uint64_t *step);

/* Take over settings of a program that may know a later struct: what is added there has
 * to be 0. NULL: all defaults. 0, or E_INVAL or E_VERSION with a text. */
int cli_step_settings(struct pccd_client *client, const struct pccd_step_settings *asked,
                      struct pccd_step_settings *settings);

/* The same of any request that is numbered among the steps, with client->next_step, and
 * whose slot is published. */
int cli_step_call(struct pccd_client *client, int method, const void *request,
                  uint32_t slot, uint64_t *step);

#endif

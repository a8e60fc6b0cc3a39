/* arrival.h - passes on what has arrived from the daemon: answers and notifications. */
#ifndef CLI_ARRIVAL_H
#define CLI_ARRIVAL_H

#include "client.h"

/* See struct cli_upcalls. */
void cli_arrival_answered(struct pccd_client *client, struct cli_call *call);
void cli_arrival_notified(struct pccd_client *client,
                          const struct proto_envelope *envelope);

#endif

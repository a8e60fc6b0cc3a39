/* arrival.h - passes on what has arrived from the daemon: answers and notifications.
 *
 * Room:     client/lib, private. May include: client.h.
 * Does:     hand an answer to the registry and to the recording, and a notification to
 *           the part that waits for it.
 * Does not: read messages (receive.h).
 * Threads:  [owner].
 */
#ifndef CLI_ARRIVAL_H
#define CLI_ARRIVAL_H

#include "client.h"

/* See struct cli_upcalls. */
void cli_arrival_answered(struct pccd_client *client, struct cli_call *call);
void cli_arrival_notified(struct pccd_client *client,
                          const struct proto_envelope *envelope);

#endif

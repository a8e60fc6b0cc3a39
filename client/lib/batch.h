/* batch.h - the batches of a client that ends.
 *
 * Room:     client/lib, private. May include: client.h.
 * Does:     declare what pccd_close does about batches that are not destroyed (batch.c).
 * Threads:  [owner].
 */
#ifndef CLI_BATCH_H
#define CLI_BATCH_H

#include "client.h"

/* The client goes: from now on its batches can only be destroyed. */
void cli_batch_forget_all(struct pccd_client *client);

#endif

/* batch.h - the batches of a client that ends. */
#ifndef CLI_BATCH_H
#define CLI_BATCH_H

#include "client.h"

/* The client goes: from now on its batches can only be destroyed. */
void cli_batch_forget_all(struct pccd_client *client);

#endif

/* keep.h - notes what the client has registered, so that another daemon can be told
 * after a crash.
 */
#ifndef CLI_KEEP_H
#define CLI_KEEP_H

#include "client.h"

/* The mesh `handle` has been committed, or replaced, with what is in `copy`, which is
 * taken over. */
void cli_keep_mesh(struct pccd_client *client, uint32_t handle,
                   struct registry_mesh *copy);

/* A request has been answered with success: note what it has changed. */
void cli_keep_answer(struct pccd_client *client, struct cli_call *call);

#endif

/* direct.h - runs the service inside this process (the url direct:). */
#ifndef CLI_DIRECT_H
#define CLI_DIRECT_H

#include <stddef.h>

#include "client.h"

#define CLI_DIRECT_URL "direct:"

/* Load the library where it is not loaded yet, and be another client of it. Returns 0, or
 * PCCD_E_SYSTEM with the reason: it is not installed, or of another release. */
int cli_direct_open(struct pccd_client *client);
/* All that the client has there is freed; nothing when it is not open. */
void cli_direct_close(struct pccd_client *client);

/* Send a message; whatever it asks for is computed before this returns. 0 or
 * PCCD_E_DISCONNECTED. */
int cli_direct_send(struct pccd_client *client, const void *message, size_t bytes);
/* As proto_receive into client->message and client->fds. */
int cli_direct_receive(struct pccd_client *client, size_t *bytes, int *fd_count);
/* Readable while a message can be received; -1: there is none to be had. */
int cli_direct_descriptor(const struct pccd_client *client);

#endif

/* connection.h - the connection to a daemon, or to the service in this process, until it
 * is lost.
 */
#ifndef CLI_CONNECTION_H
#define CLI_CONNECTION_H

#include <stddef.h>

#include "client.h"

/* Note that the connection is lost. Calls without an answer are held for another one, or
 * fail where there is to be none (cli_die). Returns PCCD_E_DISCONNECTED. */
int cli_lose(struct pccd_client *client, const char *why);
/* Have the socket end, so that who watches it sees that there is something to do,
 * whatever the daemon does with its own end. Not by a forked copy, which shares it. */
void cli_hang_up(struct pccd_client *client);
/* Give the connection up for good: calls without an answer fail, and all later ones;
 * client->dead_text, which is set, says why. Returns PCCD_E_DISCONNECTED. */
int cli_die(struct pccd_client *client);

/* Close descriptors that came with an answer and were not taken. */
void cli_fds_close(struct pccd_client *client);

/* Return PCCD_E_DISCONNECTED, with its text, when the connection is lost for good, or
 * another process's, else 0. */
int cli_alive(struct pccd_client *client);

/* Send the encoded message: 0, PCCD_E_AGAIN, or why it cannot be. In the process,
 * whatever it asks for is computed before this returns. */
int cli_message_send(struct pccd_client *client);
/* Receive one message into client->message, as proto_receive does; `waits`: as
 * proto_await, and not in the process. */
int cli_message_receive(struct pccd_client *client, bool waits, size_t *bytes,
                        int *fd_count);

/* Close the socket and forget every call, so that another can be opened. */
void cli_connection_close(struct pccd_client *client);

/* ---- the service in this process --------------------------------------------------- */

#define CLI_DIRECT_URL "direct:"

/* Load the library where it is not loaded yet, and be another client of it. Returns 0, or
 * PCCD_E_SYSTEM with the reason: it is not installed, or of another release. */
int cli_direct_open(struct pccd_client *client);
/* Free all that the client has there; does nothing when it is not open. */
void cli_direct_close(struct pccd_client *client);

/* Send a message; whatever it asks for is computed before this returns. 0 or
 * PCCD_E_DISCONNECTED. */
int cli_direct_send(struct pccd_client *client, const void *message, size_t bytes);
/* Receive into client->message and client->fds, as proto_receive does. */
int cli_direct_receive(struct pccd_client *client, size_t *bytes, int *fd_count);
/* Return a descriptor that is readable while a message can be received; -1: there is none
 * to be had. */
int cli_direct_descriptor(const struct pccd_client *client);

#endif

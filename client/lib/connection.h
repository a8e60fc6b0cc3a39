/* connection.h - whether the connection to the daemon works, and what happens when it
 * is lost.
 */
#ifndef CLI_CONNECTION_H
#define CLI_CONNECTION_H

#include "client.h"

/* The connection is lost. Calls without an answer are held for another one, or fail where
 * there is to be none. Returns PCCD_E_DISCONNECTED. */
int cli_lose(struct pccd_client *client, const char *why);
/* Have the socket end, so that who watches it sees that there is something to do,
 * whatever the daemon does with its own end. Not by a forked copy, which shares it. */
void cli_hang_up(struct pccd_client *client);
/* For good: client->dead_text says why. Returns PCCD_E_DISCONNECTED. */
int cli_die(struct pccd_client *client);

/* Close descriptors that came with an answer and were not taken. */
void cli_fds_close(struct pccd_client *client);

/* PCCD_E_DISCONNECTED with its text when the connection is lost for good, or another
 * process's, else 0. */
int cli_alive(struct pccd_client *client);

/* Close the socket and forget every call, so that another can be opened. */
void cli_connection_close(struct pccd_client *client);

#endif

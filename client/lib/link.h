/* link.h - finds or starts a daemon, and connects to it. */
#ifndef CLI_LINK_H
#define CLI_LINK_H

#include "client.h"

#define CLI_RETRY_NS     1000000u
#define CLI_RETRY_NS_MAX 50000000u

/* The first connection. link->way and what it needs are set. */
int cli_link_first(struct pccd_client *client, uint64_t deadline_ns);

/* Another connection, under the number of the socket's descriptor; with a new daemon
 * where this client starts daemons and nobody listens. with_held: calls that are held are
 * sent behind hello, before its answer. *resumed: the session goes on, else it is a new
 * one. */
int cli_link_again(struct pccd_client *client, bool with_held, uint64_t deadline_ns,
                   bool *resumed);

/* Say that nobody comes back. */
void cli_link_bye(struct pccd_client *client);
/* The same, and that the next connection begins another session. */
void cli_link_forget(struct pccd_client *client);

void cli_sleep_ns(uint64_t ns);

#endif

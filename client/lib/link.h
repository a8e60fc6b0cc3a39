/* link.h - connects to a daemon, that is found or started, and again when it is lost. */
#ifndef CLI_LINK_H
#define CLI_LINK_H

#include "client.h"

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

/* ---- another connection ------------------------------------------------------------ */

/* The connection is lost: wait for another one. Returns 0, PCCD_E_TIMEOUT (the deadline;
 * later calls go on trying), or PCCD_E_DISCONNECTED when the patience is at its end: the
 * client is dead then. A try that has begun is not given up at the deadline: a daemon
 * that answers is told everything. */
int cli_recover(struct pccd_client *client, uint64_t deadline_ns);

/* Try once if it is time to, without waiting for the time. */
void cli_recover_poll(struct pccd_client *client);

/* In a new session, with nothing in flight but what is held. On failure the client is as
 * before, and all can be tried again in another session. */
int cli_restore(struct pccd_client *client);

#endif

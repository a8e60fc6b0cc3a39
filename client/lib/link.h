/* link.h - connects to a daemon, that is found or started, and again when it is lost. */
#ifndef CLI_LINK_H
#define CLI_LINK_H

#include "client.h"

/* Make the first connection, by link->way, which is set, as is what it needs. */
int cli_link_first(struct pccd_client *client, uint64_t deadline_ns);

/* Make another connection, under the number of the socket's descriptor; with a new daemon
 * where this client starts daemons and nobody listens. with_held: calls that are held are
 * sent behind hello, before its answer. *resumed: the session goes on, else it is a new
 * one. */
int cli_link_again(struct pccd_client *client, bool with_held, uint64_t deadline_ns,
                   bool *resumed);

/* Say that nobody comes back. */
void cli_link_bye(struct pccd_client *client);
/* Say so, and have the next connection begin another session. */
void cli_link_forget(struct pccd_client *client);

void cli_sleep_ns(uint64_t ns);

/* ---- another connection ------------------------------------------------------------ */

/* Wait for another connection in place of one that is lost. Returns 0, PCCD_E_TIMEOUT
 * (the deadline; later calls go on trying), or PCCD_E_DISCONNECTED when the patience is
 * at its end: the client is dead then. A try that has begun is not given up at the
 * deadline: a daemon that answers is told everything. */
int cli_recover(struct pccd_client *client, uint64_t deadline_ns);

/* Try once if the connection is lost and it is time to; before that only pause for a
 * moment, so that who watches the descriptor does not spin. */
void cli_recover_poll(struct pccd_client *client);

/* Register all that the client has in a new session, with nothing in flight but what is
 * held. On failure the client is as before, and all can be tried again in another
 * session. */
int cli_restore(struct pccd_client *client);

#endif

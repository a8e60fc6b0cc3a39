/* recover.h - reconnects when the connection to the daemon is lost. */
#ifndef CLI_RECOVER_H
#define CLI_RECOVER_H

#include "client.h"

/* The longest pause; the first is CLI_PAUSE_NS, each next one twice as long. */
#define CLI_PAUSE_NS_MAX 1000000000u

/* The connection is lost: wait for another one. Returns 0, PCCD_E_TIMEOUT (the deadline;
 * later calls go on trying), or PCCD_E_DISCONNECTED when the patience is at its end: the
 * client is dead then. A try that has begun is not given up at the deadline: a daemon
 * that answers is told everything. */
int cli_recover(struct pccd_client *client, uint64_t deadline_ns);

/* Try once if it is time to, without waiting for the time. */
void cli_recover_poll(struct pccd_client *client);

#endif

/* receive.h - reads a message from the daemon and finds the call that it answers. */
#ifndef CLI_RECEIVE_H
#define CLI_RECEIVE_H

#include "client.h"

/* Handle one message if one is there: 0, PCCD_E_AGAIN (also when the connection has just
 * been lost and can be made again: link.is_down then) or PCCD_E_DISCONNECTED. */
int cli_receive(struct pccd_client *client);

/* The same, but waits for CLI_AWAIT_NS where no message is there. Not in the process
 * (CLI_WAY_DIRECT). */
int cli_await(struct pccd_client *client);

#endif

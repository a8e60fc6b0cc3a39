/* outlet.h - lets a thread that computes send an answer itself, while the event loop may
 * be closing the socket.
 *
 * Threads: functions say; host.h declares those that the service calls.
 */
#ifndef SRV_OUTLET_H
#define SRV_OUTLET_H

#include "host.h"

/* Of the socket `fd`, with one reference, the caller's. NULL: no memory. [loop] */
struct srv_outlet *srv_outlet_new(int fd);

/* The socket is about to be closed: nothing is sent from here on. Waits for one message
 * that is just being sent. Gives up the caller's reference. [loop] */
void srv_outlet_close(struct srv_outlet *outlet);

/* Whether the loop has messages that wait for the socket: what comes from here must not
 * overtake them. [loop] */
void srv_outlet_block(struct srv_outlet *outlet, bool is_blocked);

/* One more reference. [loop] */
struct srv_outlet *srv_outlet_hold(struct srv_outlet *outlet);

#endif

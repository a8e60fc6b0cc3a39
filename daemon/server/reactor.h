/* reactor.h - the event loop, and what the daemon has besides the service.
 *
 * Room:     server. May include: libuv, the service's headers, every header of the room.
 * Does:     own uv_loop_t, the socket that listens, the connections; run until told to
 *           stop, then stop in order.
 * Does not: know sockets (listener.h, conn.h) or messages (dispatch.h).
 * Threads:  [loop]
 */
#ifndef SRV_REACTOR_H
#define SRV_REACTOR_H

#include <stdbool.h>
#include <stdint.h>
#include <uv.h>

#include "bell.h"
#include "listener.h"
#include "loop.h"
#include "outbox.h"
#include "pulse.h"
#include "refused.h"

struct srv_closer;
struct srv_lockfile;

struct srv_reactor {
    struct srv_loop loop; /* first: the reactor is the service's host */
    uv_loop_t uv;
    struct srv_listener listener;
    struct srv_closer *closer;  /* of descriptors that have to do with clients */
    uint8_t *buffer;            /* PROTO_MESSAGE_BYTES_MAX: the message being read */
    struct srv_conn *conns;     /* newest first */
    uint32_t closed_since_trim; /* connections */
    uint32_t conn_count;        /* all of them */
    struct srv_refused refused; /* of these, those of clients that are refused */
    uint32_t reply_count;   /* queued, of all connections */
    uint32_t put_off_count; /* messages that wait for room, of all connections */
    bool grace_over;        /* requests in flight have been cancelled */
    bool has_let_go;        /* of the socket's path: go with the last client */
    struct srv_lockfile *lockfile; /* of the path; NULL: who gave us the socket has it */
    struct srv_bell bell;   /* rung when a thread has finished jobs */
    uv_signal_t sigterm;
    uv_signal_t sigint;
    uv_timer_t idle;  /* until we go because nobody is here */
    uv_timer_t grace; /* until requests in flight are cancelled, then until we give up */
    struct srv_pulse pulse; /* of which the service manager is told */
    uv_timer_t report; /* until what the log has left out is said */
    uv_prepare_t stopper; /* looks, before each wait, whether the next phase can begin */
    uv_prepare_t sender;  /* lets, before each wait, what is kept of answers go */
    struct srv_outbox outbox;
};

/* Serve until a signal, the last client or the idle time ends it. `lockfile`, which the
 * caller holds, is that of the socket's path, NULL where the options have a socket.
 * Returns the exit status of the program. */
int srv_reactor_run(const struct srv_options *options, struct srv_lockfile *lockfile);

/* The path of the socket is not ours any more: let another daemon have it, serve the
 * clients that are here until they leave, and end. */
void srv_reactor_let_go(struct srv_reactor *reactor, const char *why);

/* Begin to stop: no new connections or requests. Further calls do nothing. */
void srv_reactor_shutdown(struct srv_reactor *reactor, const char *why);

/* A connection is gone, open or not. */
void srv_reactor_conn_closed(struct srv_reactor *reactor);

#endif

/* host.h - what the service needs from the program around it: sending to a client, and
 * timers.
 */
#ifndef SRV_HOST_H
#define SRV_HOST_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <sys/types.h>

#include "codec.h"

struct srv_conn; /* the way to a client; the host's */
struct srv_service;
struct srv_outlet; /* a way to a client for the thread that computes; the host's */
struct srv_quota_user;
struct srv_session;

/* ---- clients ----------------------------------------------------------------------- */

/* Send a message, now or when the client reads. Takes over fds[fd_count] in any case.
 * What cannot be sent any more is dropped; the connection then closes soon, never
 * inside. */
void srv_conn_send(struct srv_conn *conn, const struct proto_encoder *message,
                   const int *fds, int fd_count);
/* Return whether nothing waits to be sent, so that a message would go now. */
bool srv_conn_is_free(const struct srv_conn *conn);
/* Return a way to send from another thread what would go now, to be dropped; it outlives
 * the connection, and takes nothing any more then. NULL: there is none, or messages
 * wait. */
struct srv_outlet *srv_conn_outlet(struct srv_conn *conn);
/* Send a message, if it goes now. Returns 0, or a negative status: nothing was sent, or
 * others wait to be. [compute] */
int srv_outlet_send(struct srv_outlet *outlet, const struct proto_encoder *message);
void srv_outlet_drop(struct srv_outlet *outlet);
/* Send the same message to all of them. */
void srv_conn_send_all(struct srv_service *service, const struct proto_encoder *message);

/* Let no more messages through either way: send what is queued, let the peer read it,
 * close. */
void srv_conn_finish(struct srv_conn *conn);

/* Return the group of the client's process, (gid_t)-1: not known. */
gid_t srv_conn_group(const struct srv_conn *conn);
/* Return whether that or a further one of its groups is `gid`. */
bool srv_conn_has_group(const struct srv_conn *conn, gid_t gid);

/* Let the client be silent from now on, as it has said hello. */
void srv_conn_established(struct srv_conn *conn);

/* Keep the message that is being handled, to come back to it when a session of the user
 * has left. Nothing else is read before it. Returns 0, PCCD_E_LIMIT or PCCD_E_NOMEM. */
int srv_conn_put_off(struct srv_conn *conn, const void *message, size_t bytes);
/* Come back to what was put off, soon, never inside, as a session of the user has
 * left. */
void srv_conn_room(struct srv_service *service, const struct srv_quota_user *user);

/* Close a connection soon whose session goes on over another one; also from inside the
 * handler of another connection's message. */
void srv_conn_orphan(struct srv_conn *conn);
/* Let it be the connection of `session` from now on. */
void srv_conn_adopt(struct srv_conn *conn, struct srv_session *session);

/* Note that a session was opened. */
void srv_host_client_joined(struct srv_service *service);
/* Note that a session that was opened is over. */
void srv_host_client_left(struct srv_service *service);
/* Start one more runner of the queue of what is computed, with a team as the first has.
 * Returns 0 or a negative status: there are no threads for it. */
int srv_host_start_runner(struct srv_service *service);
/* Return whether all connections that may be served (options.h) are. */
bool srv_host_is_full(const struct srv_service *service);

/* ---- timers ------------------------------------------------------------------------ */

struct srv_timer; /* the host's */

/* Make a timer that calls fire(context). NULL: no memory. */
struct srv_timer *srv_timer_new(struct srv_service *service, void (*fire)(void *context),
                                void *context);
/* Let it fire in after_ms from now, and then, unless that is 0, every every_ms. */
void srv_timer_start(struct srv_timer *timer, uint64_t after_ms, uint64_t every_ms);
void srv_timer_stop(struct srv_timer *timer);
void srv_timer_free(struct srv_timer *timer); /* NULL is allowed */

#endif

/* dispatch.h - takes a message from a client, checks it and calls the handler of its
 * method.
 */
#ifndef SRV_DISPATCH_H
#define SRV_DISPATCH_H

#include <stddef.h>

#include "codec.h"

struct srv_service;
struct srv_session;

/* Handle one message from the client of an open connection. [loop] */
void srv_dispatch(struct srv_session *session, const void *message, size_t bytes);

/* Tell a client that broke the rules of the stream why, with message id 0, and close. */
void srv_dispatch_violation(struct srv_session *session, int code, const char *text);

/* Refuse a client beyond its user's quota: sets *error, fatal, and returns its code. */
int srv_dispatch_refuse_quota(struct srv_session *session, struct proto_error *error);

/* Tell a refused client why, with message id 0: it has said nothing, and its connection
 * is about to be closed. */
void srv_dispatch_refuse_silent(struct srv_session *session);

/* Tell every client that the daemon is about to go. */
void srv_dispatch_goaway(struct srv_service *service, int code, const char *text);

/* End a session. What is below calls this function and the next through srv_service, as
 * it knows neither requests nor scenes. A session that is CLOSED stops its requests and
 * drops its scenes, meshes and ring; it stays until the caller lets it go. [loop] */
void srv_let_go(struct srv_session *session);
/* End a session that may not go on, and tell its client, if it has one. [loop] */
void srv_refuse(struct srv_session *session, const struct proto_error *error);

#endif

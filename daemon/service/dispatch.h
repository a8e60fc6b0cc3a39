/* dispatch.h - from a message to an answer.
 *
 * Room:     service. May include: call.h, request.h.
 * Does:     decode, refuse in a fixed order, call the handler, encode and send what it
 *           says.
 * Does not: know a method: the table comes from the manifest.
 * Threads:  [loop]
 */
#ifndef SRV_DISPATCH_H
#define SRV_DISPATCH_H

#include <stddef.h>

#include "request.h"

struct srv_loop;

/* One message from the client of an open connection. */
void srv_dispatch(struct srv_session *session, const void *message, size_t bytes);

/* Send the answer of a request that has run; with nobody there any more, only close its
 * descriptors. */
void srv_dispatch_answer(struct srv_session *session, struct srv_request *request);

/* Answer with `result` a request that goes on nevertheless. [loop] */
void srv_dispatch_answer_early(struct srv_session *session,
                               const struct srv_request *request, const void *result);

/* The client broke the rules of the stream: tell it why, with message id 0, and close. */
void srv_dispatch_violation(struct srv_session *session, int code, const char *text);

/* Refuse a client beyond its user's quota: sets *error, fatal, and returns its code. */
int srv_dispatch_refuse_quota(struct srv_session *session, struct proto_error *error);

/* The connection of a refused client that has said nothing is about to be closed: tell it
 * why, with message id 0. */
void srv_dispatch_refuse_silent(struct srv_session *session);

/* Tell every client that the daemon is about to go. */
void srv_dispatch_goaway(struct srv_loop *loop, int code, const char *text);

#endif

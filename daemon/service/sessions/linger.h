/* linger.h - keeps a session after its connection is lost, so that the client can come
 * back (resume).
 *
 * A waiting session keeps all it has, and stays charged for it. Requests in flight are
 * computed, and their answers are kept (replies.h). The session ends after
 * options->linger_s; as soon as the client's process is seen to be gone; at shutdown; or
 * when its user needs its place, or what it holds, for another client.
 */
#ifndef SRV_LINGER_H
#define SRV_LINGER_H

#include <stdbool.h>
#include <stdint.h>

#include "messages.h"

struct srv_service;
struct srv_quota_user;
struct srv_session;

/* Make the timer only. Returns 0 or PCCD_E_NOMEM. */
int srv_linger_init(struct srv_service *service);
void srv_linger_deinit(struct srv_service *service);

/* Give a session that is being opened a secret, as its client wants to be able to come
 * back; none where the system or the memory has none for it, or the options let nobody
 * come back. */
void srv_linger_enable(struct srv_session *session);

/* Let a session whose connection is gone wait, or end it. */
void srv_linger_lost(struct srv_session *session);

/* Return the session that `request` may go on with, whoever has its connection now; NULL:
 * no such session, another secret, another user, or it cannot be resumed any more. */
struct srv_session *srv_linger_find(struct srv_service *service,
                                    const struct proto_HELLO_request *request,
                                    const struct srv_quota_user *user);
/* Give a session the connection of `fresh`, which ends, as does the one it still had. */
void srv_linger_resume(struct srv_session *session, struct srv_session *fresh);

/* End the one of the user's sessions that has waited longest. False: none waits. */
bool srv_linger_evict(struct srv_service *service, const struct srv_quota_user *user);
/* Return, after a refusal for what the user has, whether there may be more room soon,
 * because a session of the user is over and not freed yet, or because one waited and is
 * ended now. A request that no user may have is no reason to end one. */
bool srv_linger_make_room(const struct srv_session *session);
/* End a session that waits; the log says why. */
void srv_linger_end(struct srv_session *session, const char *why);
/* End them all. */
void srv_linger_end_all(struct srv_service *service);

#endif

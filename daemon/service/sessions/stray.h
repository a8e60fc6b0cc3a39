/* stray.h - finds memory that clients take without having been given it.
 *
 * Room:     service. May include: the headers of base, queue and memory.
 * Does:     look at what the rings of all sessions hold (ringio.h), a second after a
 *           client has asked for something, and every half a minute otherwise; end a
 *           session that goes on to take what its user's quota does not bear. Decide what
 *           becomes of a ring when its session does not use it any more: it is emptied,
 *           so that who keeps it mapped has nothing that the daemon has made; or it
 *           stays, charged, while an honest client needs what is in it.
 * Does not: do any of it before srv_stray_init, nor look while there are no rings.
 * Threads:  [loop]
 */
#ifndef SRV_STRAY_H
#define SRV_STRAY_H

#include <stdbool.h>

#include "codec.h"

struct srv_quota_user;
struct srv_ring;
struct srv_service;
struct srv_session;

/* Returns 0 or PCCD_E_NOMEM. Only for a host whose timers fire by themselves. */
int srv_stray_init(struct srv_service *service);
void srv_stray_deinit(struct srv_service *service);
bool srv_stray_looks(const struct srv_service *service);

/* A client with a ring has been answered. */
void srv_stray_use(struct srv_service *service);

/* Whether the session may get another ring: PCCD_E_BUSY with *error set while too many
 * earlier ones have pages that are not released. Nothing of it is in flight. */
int srv_stray_may_replace(struct srv_session *session, struct proto_error *error);
/* Give the session another ring. Nothing of it is in flight. */
void srv_stray_replace(struct srv_session *session, struct srv_ring *ring);

/* The session is CLOSED: it lets go of its rings, or keeps them if its client may need
 * them. */
void srv_stray_let_go(struct srv_session *session);
/* Nothing of a CLOSED session is there any more but rings: it is LEFT while its client
 * needs them, or they go. */
void srv_stray_leave(struct srv_session *session);
/* End the session that has been LEFT longest, of a user or (NULL) of all. False: there is
 * none. */
bool srv_stray_evict(struct srv_service *service, const struct srv_quota_user *user);

#endif

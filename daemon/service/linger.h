/* linger.h - sessions that wait for their client to come back.
 *
 * Room:     service. May include: session.h.
 * Does:     let a session outlive its connection for a while, find it again by its
 *           secret, give it another connection, end it when nobody comes.
 * Does not: keep a session whose client said bye, broke the rules, or never asked for it.
 * Threads:  [loop]
 *
 * A waiting session keeps all it has, and stays charged for it; what it had in flight is
 * computed, and the answers are kept (replies.h). It ends after options->linger_s, as
 * soon as the process at the other end is seen to be gone, at shutdown, or when its user
 * needs the place for a new client, or what it holds for another one.
 */
#ifndef SRV_LINGER_H
#define SRV_LINGER_H

#include <stdbool.h>
#include <stdint.h>

#include "messages.h"

struct srv_conn;
struct srv_loop;
struct srv_quota_user;
struct srv_session;
struct srv_timer;

struct srv_linger {
    struct srv_timer *timer; /* runs while a session waits */
    uint32_t count;          /* of these */
};

/* The timer only. Returns 0 or PCCD_E_NOMEM. */
int srv_linger_init(struct srv_loop *loop);
void srv_linger_deinit(struct srv_loop *loop);

/* The client of a session that is being opened wants to be able to come back: give it a
 * secret, if there is one to be had. */
void srv_linger_enable(struct srv_session *session);

/* The connection of a session is gone: wait, or end it. */
void srv_linger_lost(struct srv_session *session);

/* The session that `request` may go on with, whoever has its connection now; NULL: no
 * such session, another secret, or another user. */
struct srv_session *srv_linger_find(struct srv_loop *loop,
                                    const struct proto_HELLO_request *request,
                                    const struct srv_quota_user *user);
/* Give a session the connection of `fresh`, which ends, as does the one it still had. */
void srv_linger_resume(struct srv_session *session, struct srv_session *fresh);

/* End the one of the user's sessions that has waited longest. False: none waits. */
bool srv_linger_evict(struct srv_loop *loop, const struct srv_quota_user *user);
/* After a refusal for what the user has: whether there may be more room soon, because a
 * session of the user is over and not freed yet, or because one waited and is ended now.
 * A request that no user may have is no reason to end one. */
bool srv_linger_make_room(const struct srv_session *session);
/* Whether a mesh or object of so many triangles would hardly fit into what the engine may
 * hold for the user, while sessions that wait, or are not freed yet, hold some of it. */
bool srv_linger_is_tight(const struct srv_session *session, uint64_t triangles);
/* End them all. */
void srv_linger_end_all(struct srv_loop *loop);

#endif

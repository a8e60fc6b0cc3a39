/* shared.h - shared scenes: scenes with a name, in which several clients put their
 * objects.
 *
 * Threads: [loop], but for functions marked otherwise.
 *
 * A shared scene belongs to no client. A session without a connection, its keeper, holds
 * it, so that it outlives the client that created it; it ends when its last member has
 * left. Its memory is charged to the user who created it, the triangles of an object to
 * the user who added it. An object has one writer, the session that added it.
 */
#ifndef SRV_SHARED_H
#define SRV_SHARED_H

#include <stdatomic.h>
#include <stdbool.h>
#include <stdint.h>
#include <sys/types.h>

#include "codec.h"
#include "member.h"
#include "messages.h"
#include "srv_scene.h"

#define SRV_RIGHTS_DEFAULT 0600u
#define SRV_RIGHTS_ALL     0666u

struct srv_session;

struct srv_shared {
    struct srv_shared *next; /* of service->shared, while anybody takes part */
    struct srv_session *keeper;
    struct srv_scene *scene;
    struct srv_member *members;
    /* Those that leave with nothing in flight, until their objects meet nothing: pushed
     * by [loop], taken by [compute] */
    _Atomic(struct srv_member *) hiding;
    uint32_t member_count; /* those that are leaving, too */
    uid_t uid;             /* who made it */
    gid_t gid;
    uint32_t rights;                      /* as a file's: 4 take part, 2 write */
    bool is_restored;                     /* it was there before the daemon was */
    struct proto_SCENE_STEP_request last; /* number 0: no step yet */
    char name[];
};

/* Handle a scene.create with a name, which is one of the session's user or, where it says
 * so, of another. Returns 0 with *result set, or PCCD_E_INVAL, PCCD_E_STATE (there is
 * one), PCCD_E_AGAIN (there is none yet), PCCD_E_ACCESS, PCCD_E_LIMIT, PCCD_E_BUSY or
 * PCCD_E_NOMEM with *error set. */
int srv_shared_open(struct srv_session *session,
                    const struct proto_SCENE_CREATE_request *request,
                    const struct eng_scene_settings *settings,
                    struct proto_SCENE_CREATE_result *result, struct proto_error *error);

/* Let a session, which has given back its handle of a shared scene, leave it. */
void srv_shared_leave(struct srv_session *session, struct srv_scene *scene);

/* Let the objects of those who have left meet nothing any more. Before a step of the
 * scene, shared or not: they have heard that they have left, and it may be another's turn
 * before their objects are taken out. [compute] */
void srv_shared_hide(struct srv_scene *scene);

/* Return the member of a session that has a handle for the scene; NULL: it is the
 * session's own. One that leaves and comes back has another. */
struct srv_member *srv_shared_member(const struct srv_scene *scene,
                                     const struct srv_session *session);

/* Refuse a session that only reads the scene, which may be any. Returns 0, or
 * PCCD_E_ACCESS with *error set. */
int srv_shared_refuse_reader(const struct srv_session *session,
                             const struct srv_scene *scene, struct proto_error *error);

/* Return a handle for an object of which any will do, that nobody who has not come back
 * yet is likely to want. Another try gives another one. 0: nobody will come, or all such
 * handles were given. */
uint32_t srv_shared_aside(struct srv_member *member);

/* Tell list.scene of `session`, which takes part, of a shared scene, not of others. */
void srv_shared_tell(const struct srv_scene *scene, const struct srv_session *session,
                     struct proto_LIST_SCENE_result *result);

/* Charge the session for a journal of so many bytes. Returns 0, PCCD_E_STATE (it keeps
 * one) or PCCD_E_QUOTA with *error set. */
int srv_shared_charge_journal(struct srv_member *member, uint64_t bytes,
                              struct proto_error *error);
/* Refund it. */
void srv_shared_refund_journal(struct srv_member *member);

/* Tell the others that a session has stepped the scene. */
void srv_shared_stepped(struct srv_scene *scene, const struct srv_session *by,
                        const struct proto_answer *answer);
/* Tell the session that its frame waits for the scene's next step. */
void srv_shared_waits(struct srv_member *member, uint64_t step);
/* Have srv_shared_catch_up tell a session again which frames of it wait: it goes on over
 * another connection, and may not have heard. */
void srv_shared_resumed(struct srv_session *session);
/* Tell a session what could not be told before, if it can be now. */
void srv_shared_catch_up(struct srv_session *session);

#endif

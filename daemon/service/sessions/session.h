/* session.h - a session: everything that the daemon keeps for one client. */
#ifndef SRV_SESSION_H
#define SRV_SESSION_H

#include <stdatomic.h>
#include <stdbool.h>
#include <stdint.h>
#include <sys/types.h>

#include "compute.h"
#include "handles.h"
#include "messages.h"
#include "proto_limits.h"
#include "resource.h"

#define SRV_REQUESTS_MAX 32u /* of one session in flight, steps among them */
#define SRV_OVERDUE_MAX  8u  /* of one session, answered before their turn, besides */

enum srv_session_state {
    SRV_SESSION_NEW = 0,     /* connected, no hello yet */
    SRV_SESSION_REFUSED = 1, /* connected beyond the quota: hears so and goes */
    SRV_SESSION_OPEN = 2,    /* hello was answered */
    SRV_SESSION_WAITING = 3, /* the connection is gone; the client may come back */
    SRV_SESSION_CLOSED = 4,  /* over; waits for the compute thread */
    SRV_SESSION_KEEPER = 5   /* nobody's: holds a shared scene (shared.h) */
};

/* Process at the other end of a socket. */
struct srv_peer {
    uid_t uid;
    pid_t pid;
    bool is_stranger;    /* may not be a client (allow.h) */
    bool came_when_full; /* all connections were taken (srv_host_is_full) */
};

struct srv_watcher;
struct srv_replies;

struct srv_session {
    struct srv_owner owner; /* first; what its resources know of it */
    struct srv_session *prev;
    struct srv_session *next;
    struct srv_service *service;
    struct srv_conn *conn; /* NULL: closed, or waiting */
    uint32_t connection;   /* counts them: changes when one is lost */
    uint64_t id;
    pid_t pid; /* of the client's process; 0: not known */
    enum srv_session_state state;
    bool is_stranger;               /* REFUSED for who it is, not for want of a place */
    bool came_when_full;            /* REFUSED for want of a connection */
    bool is_ending;                 /* must not wait for its client (linger.h) */
    uint64_t token[2];              /* secret of a resumable session */
    struct srv_replies *replies;    /* NULL: the session cannot be resumed */
    uint64_t lost_ns;               /* WAITING: since when */
    bool counted;                   /* charged as a client of its user */
    bool is_observer;               /* takes no place of a client, and makes nothing */
    bool is_keeper;                 /* it was made to hold a shared scene */
    bool attaching;                 /* a ring is being created */
    bool is_behind;                 /* has not been told of a shared scene's last step */
    uint32_t version;               /* of the protocol, after hello */
    struct srv_handles scenes;      /* of struct srv_scene */
    struct srv_handles meshes;      /* of struct srv_mesh */
    struct srv_ring *ring;          /* NULL: none attached */
    struct srv_laststep *last_step; /* NULL: none yet */
    struct srv_watcher *watcher;    /* NULL: it does not watch */
    uint64_t open_ns;               /* when hello was answered */
    struct proto_LIST_SESSION_result stats; /* what is counted of it, and its name */
    struct srv_request *requests;           /* in flight, newest first */
    struct srv_request *spare_requests;     /* their memory, for the next ones */
    uint32_t spare_count;
    uint32_t request_count;
    uint32_t overdue_count; /* of these, steps that were answered before their turn */
    uint32_t submit_count;  /* other steps */
    uint32_t shared_count;  /* scenes that it shares with others */
    uint32_t scene_count;   /* scenes in memory, those being freed too */
    atomic_uint owed_count; /* [compute] has run them, [loop] is to answer them */
};

static inline struct srv_session *srv_session_of(struct srv_owner *owner)
{
    return (struct srv_session *)(void *)owner;
}

/* Make a session for a new connection of `peer`. It is REFUSED when the user's quota of
 * clients is full, when all connections are taken, or when it may not be a client. NULL:
 * no memory. */
struct srv_session *srv_session_new(struct srv_service *service, struct srv_conn *conn,
                                    const struct srv_peer *peer);
/* Make a session that nobody is behind, to hold a scene. NULL: no memory. */
struct srv_session *srv_session_new_keeper(struct srv_service *service, uid_t uid);
/* Ask again for the place of a refused session. Returns 0 with state NEW, or PCCD_E_QUOTA
 * with *error set. */
int srv_session_admit(struct srv_session *session, struct proto_error *error);

#define SRV_OBSERVERS_MAX 8u /* of a user; further ones are clients like others */

/* Note that its client says that it will only observe: it takes no place of a client, if
 * it had one or was refused one. False: its user has SRV_OBSERVERS_MAX of these; it may
 * not be a client; or it came when all connections were taken, and may not change that.
 * Before it opens. */
bool srv_session_observe(struct srv_session *session);

/* End a session: stop its requests, drop everything it has. The session frees itself as
 * soon as the compute thread has let go of it. */
void srv_session_detach(struct srv_session *session);

/* Open a session, whose hello was answered. */
void srv_session_open(struct srv_session *session, uint32_t version);

/* Give *handle a handle for `item`, a `what` ("scene"), in a table that the session's
 * user pays for: the one that it says, or any when that is 0. Returns 0, or with *error
 * set PCCD_E_HANDLE (its place is taken, or it is none of ours), PCCD_E_LIMIT,
 * PCCD_E_QUOTA or PCCD_E_NOMEM. */
int srv_session_handle(struct srv_session *session, struct srv_handles *handles,
                       const char *what, void *item, uint32_t *handle,
                       struct proto_error *error);
/* Free such a table, in which nothing is left. */
void srv_session_drop_handles(struct srv_session *session, struct srv_handles *handles);

/* Free a closed session that nothing refers to any more; otherwise nothing. */
void srv_session_settle(struct srv_session *session);

/* Refuse a session that is not of the daemon's own user or root. Returns 0, or
 * PCCD_E_ACCESS with *error set. */
int srv_session_refuse_stranger(const struct srv_session *session,
                                struct proto_error *error);

/* Return whether the session may know what the other one has and does: one of the same
 * user, and anybody's to the daemon's own user or root. */
bool srv_session_may_see(const struct srv_session *session,
                         const struct srv_session *other);
/* Return whether clients are told of it: it is open, or waits for its client. */
bool srv_session_is_listed(const struct srv_session *session);
/* Find the listed session of that number that the asking one may see, 0: itself. Returns
 * 0, or PCCD_E_HANDLE with *error set: there is none. */
int srv_session_find(struct srv_session *session, uint64_t id, struct srv_session **found,
                     struct proto_error *error);

#endif

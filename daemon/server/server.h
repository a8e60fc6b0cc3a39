/* server.h - what the listening socket, the connections and the event loop of the
 * daemon share.
 */
#ifndef SRV_SERVER_H
#define SRV_SERVER_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <uv.h>

#include "service.h"

/* ---- The connections of clients that were refused, until each has read why. */

struct srv_conn;

/* The part of a connection. Zeroed: not in the list. */
struct srv_refused_link {
    struct srv_conn *conn; /* that it is part of; NULL: it is not in the list */
    struct srv_refused_link *older;
    struct srv_refused_link *newer;
};

/* Zeroed: empty. */
struct srv_refused {
    struct srv_refused_link *first; /* the oldest */
    struct srv_refused_link *last;
    uint32_t count;
};

void srv_refused_add(struct srv_refused *refused, struct srv_refused_link *link,
                     struct srv_conn *conn);
/* Remove it, as it is closed, or a client now; nothing if it is not in the list. */
void srv_refused_remove(struct srv_refused *refused, struct srv_refused_link *link);

/* ---- Collects small answers, so that a client is woken once for several of them.
 *
 * Keep small messages until the loop has handled everything that had come, or until there
 * are as many as there are entries. Sending a message may wake its client, and a client
 * that wakes too early has to be woken again. For example, of fifty clients in one
 * process, one wakes once for sixteen answers instead of once for every few. */

#define SRV_OUTBOX_ENTRIES 16u  /* and messages handled while the first waits */
#define SRV_OUTBOX_BYTES   120u /* of a message; an answer to a step is longer */

struct srv_conn;

struct srv_outbox {
    uint32_t count;
    uint32_t handled; /* messages since the first came */
    struct {
        struct srv_conn *conn;
        size_t bytes;
        uint8_t data[SRV_OUTBOX_BYTES];
    } entries[SRV_OUTBOX_ENTRIES];
};

/* Keep a message. False: it is too long, or there is no place; nothing has changed. */
bool srv_outbox_add(struct srv_outbox *outbox, struct srv_conn *conn, const void *message,
                    size_t bytes);

/* Note that the loop has handled one more message. Returns whether what is kept is to
 * go. */
bool srv_outbox_is_due(struct srv_outbox *outbox);

/* Empty it, as what was kept has gone. */
void srv_outbox_clear(struct srv_outbox *outbox);

struct srv_closer;
struct srv_conn;
struct srv_lockfile;

struct srv_server {
    struct srv_service service; /* first: whoever has the service has its host */
    uv_loop_t uv;
    struct srv_closer *closer;     /* of descriptors that have to do with clients */
    uint8_t *buffer;               /* PROTO_MESSAGE_BYTES_MAX: the message being read */
    struct srv_conn *conns;        /* newest first */
    uint32_t conn_count;           /* all of them */
    struct srv_refused refused;    /* of these, those of clients that are refused */
    uint32_t reply_count;          /* queued, of all connections */
    uint32_t put_off_count;        /* messages that wait for room, of all connections */
    struct srv_outbox outbox;      /* answers that go out together */
    struct srv_lockfile *lockfile; /* of the path; NULL: who gave us the socket has it */
    /* A connection is gone, open or not. Constant */
    void (*conn_closed)(struct srv_server *server);
    /* The path of the socket is not ours any more: serve the clients that are here until
     * they leave, and end. Constant */
    void (*path_lost)(struct srv_server *server, const char *why);
};

static inline struct srv_server *srv_server_of(struct srv_service *service)
{
    return (struct srv_server *)(void *)service;
}

#endif

/* server.h - what the listening socket, the connections and the event loop of the
 * daemon share.
 */
#ifndef SRV_SERVER_H
#define SRV_SERVER_H

#include <stdint.h>
#include <uv.h>

#include "outbox.h"
#include "refused.h"
#include "service.h"

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

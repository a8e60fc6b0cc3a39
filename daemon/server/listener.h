/* listener.h - the socket that clients connect to.
 *
 * Listen and accept; keep within the limit of connections, and survive a lack of
 * descriptors without spinning; listen again, or give up, when the file of the socket is
 * gone.
 */
#ifndef SRV_LISTENER_H
#define SRV_LISTENER_H

#include <stdbool.h>
#include <uv.h>

#include "socketfile.h"

struct srv_server;
struct srv_options;

struct srv_listener {
    struct srv_server *server;
    int fd;         /* -1: closed */
    int reserve_fd; /* given up to accept and turn away a client when there is no other */
    bool watching;
    uint32_t fd_count; /* descriptors below it can be watched */
    uv_poll_t poll;
    uv_poll_t spare;  /* closed at once: see watch.h */
    uv_timer_t retry; /* after the system refused an accept */
    struct srv_socketfile file;
    bool is_following; /* the two below are libuv's */
    uv_poll_t news;    /* of the file, or from the supervisor that has made it */
    uv_timer_t look;   /* at the file, soon after news of it */
};

/* Tell whoever started us that clients can connect: the byte 1 to `fd`, which is closed;
 * nothing when it is negative. Or, the byte 0, that another daemon holds the path, and
 * may not listen yet. */
void srv_listener_tell_ready(int fd);
void srv_listener_tell_held(int fd);

/* Make room for the descriptors of all connections. [main] before there is a thread. */
void srv_listener_make_room(const struct srv_options *options);

/* Listen on the options' listen_fd, or else on a new socket at socket_path; nobody is
 * accepted before srv_listener_room. Returns 0 or a status; what was wrong is logged. */
int srv_listener_open(struct srv_listener *listener, struct srv_server *server);

/* Begin to notice when the file of the socket is gone. Where it is our own, and its lock
 * too, listen anew at that path; else accept nobody any more, and say so to the server.
 * Returns 0 or PCCD_E_SYSTEM. */
int srv_listener_follow(struct srv_listener *listener);

/* Stop listening and remove the socket, if it is our own. */
void srv_listener_close(struct srv_listener *listener);

/* Accept from here on; unless the system has just refused to. */
void srv_listener_room(struct srv_listener *listener);

#endif

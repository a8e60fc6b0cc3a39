/* notify.h - what the service manager (systemd) hands over, and what it is told.
 *
 * Threads: [main], then [loop].
 */
#ifndef SRV_NOTIFY_H
#define SRV_NOTIFY_H

#include <stdbool.h>
#include <stdint.h>
#include <uv.h>

#include "compute.h"
#include "options.h"

/* ---- Takes over a listening socket that systemd, or the supervisor, has opened
 * for the daemon (socket activation). */

#define SRV_ACTIVATE_FD 3

/* Return the number in a variable of the environment; -1: absent or not a number. */
long srv_number_of(const char *name);

/* Descriptors that are given by a number are beyond those that have fixed ones. */
#define SRV_GIVEN_FD_FLOOR 10

/* Make a copy of `fd` that stays open across exec, its number in a variable of the
 * environment; negative: nothing. In a child, before exec. Returns 0 or a status, errno
 * set. */
int srv_number_give(const char *name, int fd);

/* Set, if this process was given a socket, options->listen_fd and, from its address,
 * options->socket_path. Returns 0, also when there is none, or PCCD_E_INVAL: what is
 * wrong with it is logged. */
int srv_activate(struct srv_options *options);

/* Hand over a listening socket. In a child, before exec. Returns 0 or a status, errno
 * set. */
int srv_activate_give(int fd);

/* Tell the program to stand by until a byte can be read from `fd`; negative: not at all.
 * In a child, before exec. Returns 0 or a status, errno set. */
int srv_standby_give(int fd);
/* Stand by, if this process was told to. False: nobody needs it any more. */
bool srv_standby(void);

/* Make the socket, if there is somebody to tell: before the sandbox, in which none can be
 * made. What is wrong is logged; nobody is told then, and all else goes on. Not for a
 * private daemon, which has inherited the variables of the client that started it: what
 * the manager would hear is meant for the client's service. */
void srv_notify_open(void);

/* Return whether there is somebody to tell. */
bool srv_notify_is_open(void);

/* Send the manager lines of VARIABLE=VALUE, to be read now or never: one that it has no
 * room for is dropped. */
void srv_notify_say(const char *lines);
/* Send them, waiting a second at most for room: for what is said once. */
void srv_notify_announce(const char *lines);

/* Announce READY=1 and which process to watch: who started us may be a script that has
 * ended. Not for a worker, whose supervisor stays when it crashes. */
void srv_notify_ready(void);

/* Return how long the manager lets us be silent before it takes us for dead, in
 * microseconds; 0: for ever, or it does not mean this process. */
uint64_t srv_notify_watchdog_us(void);

/* Hand over what the manager wants of this process: it wants it of the child from then
 * on. In a child, before exec. Returns 0 or a status, errno set. */
int srv_notify_give(void);

/* ---- Tells the service manager (systemd) regularly that the daemon is
 * alive. */

struct srv_service;

struct srv_heartbeat {
    struct srv_service *service;
    uv_timer_t timer; /* to the next beat, or to the next word about clients */
    bool beats;       /* the manager has a watchdog: the timer never stops */
    bool is_stuck;    /* a thread that computes; said once */
    uint32_t reported_clients;
    uint64_t reported_steps;
};

/* Prepare it, before anything else of it; the timer is closed with the reactor's. */
void srv_heartbeat_init(struct srv_heartbeat *heartbeat, uv_loop_t *uv,
                        struct srv_service *service);

/* Announce READY=1, as clients are served from now on, and begin the beats, if the
 * manager wants any. */
void srv_heartbeat_ready(struct srv_heartbeat *heartbeat);

/* Tell, a second later, that a client has come or gone, with what else has happened;
 * where there are beats, the next one tells. */
void srv_heartbeat_change(struct srv_heartbeat *heartbeat);

#endif

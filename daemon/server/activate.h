/* activate.h - takes over a listening socket that systemd, or the supervisor, has opened
 * for the daemon (socket activation).
 *
 * Threads: [loop], before any other thread is started.
 */
#ifndef SRV_ACTIVATE_H
#define SRV_ACTIVATE_H

#include "options.h"

#define SRV_ACTIVATE_FD 3

/* The number in a variable of the environment; -1: absent or not a number. */
long srv_number_of(const char *name);

/* Descriptors that are given by a number are beyond those that have fixed ones. */
#define SRV_GIVEN_FD_FLOOR 10

/* In a child, before exec: a copy of `fd` that stays open, its number in a variable of
 * the environment; negative: nothing. Returns 0 or a status, errno set. */
int srv_number_give(const char *name, int fd);

/* If this process was given a socket, set options->listen_fd and, from its address,
 * options->socket_path. Returns 0, also when there is none, or PCCD_E_INVAL: what is
 * wrong with it is logged. */
int srv_activate(struct srv_options *options);

/* In a child, before exec: hand over a listening socket. Returns 0 or a status, errno
 * set. */
int srv_activate_give(int fd);

/* In a child, before exec: let it stand by until a byte can be read from `fd`; negative:
 * not at all. Returns 0 or a status, errno set. */
int srv_standby_give(int fd);
/* Stand by, if this process was told to. False: nobody needs it any more. */
bool srv_standby(void);

#endif

/* notify.h - sends state messages to the service manager (systemd) that started the
 * daemon.
 *
 * Threads: [main], then [loop].
 */
#ifndef SRV_NOTIFY_H
#define SRV_NOTIFY_H

#include <stdbool.h>
#include <stdint.h>

/* Make the socket, if there is somebody to tell: before the sandbox, in which none can be
 * made. What is wrong is logged; nobody is told then, and all else goes on. Not for a
 * private daemon, which has inherited the variables of the client that started it: what
 * the manager would hear is meant for the client's service. */
void srv_notify_open(void);

/* Whether there is somebody to tell. */
bool srv_notify_is_open(void);

/* Lines of VARIABLE=VALUE, to be read now or never: one that the manager has no room for
 * is dropped. */
void srv_notify_say(const char *lines);
/* The same, waiting a second at most for room: for what is said once. */
void srv_notify_announce(const char *lines);

/* READY=1 and which process to watch: who started us may be a script that has ended. Not
 * for a worker, whose supervisor stays when it crashes. */
void srv_notify_ready(void);

/* How long the manager lets us be silent before it takes us for dead, in microseconds; 0:
 * for ever, or it does not mean this process. */
uint64_t srv_notify_watchdog_us(void);

/* In a child, before exec: what the manager wants of this process it wants of the child
 * from then on. Returns 0 or a status, errno set. */
int srv_notify_give(void);

#endif

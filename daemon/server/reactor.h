/* reactor.h - runs the daemon: its event loop, listening socket and connections. */
#ifndef SRV_REACTOR_H
#define SRV_REACTOR_H

struct srv_lockfile;
struct srv_options;

/* Serve until a signal, the last client or the idle time ends it. `lockfile`, which the
 * caller holds, is that of the socket's path, NULL where the options have a socket.
 * Returns the exit status of the program. */
int srv_reactor_run(const struct srv_options *options, struct srv_lockfile *lockfile);

#endif

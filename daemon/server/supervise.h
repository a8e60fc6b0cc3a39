/* supervise.h - a small parent process that starts the daemon again when it crashes.
 *
 * Hold the lock and the listening socket, so that clients queue, and are not refused,
 * while a worker starts; pass signals on; give up when the worker crashes again and
 * again; listen again, or let go, when the socket's file is gone.
 *
 * Threads: one.
 */
#ifndef SRV_SUPERVISE_H
#define SRV_SUPERVISE_H

#include "lockfile.h"
#include "options.h"

/* Crashes within that time after which it gives up: as a rule, and at most. */
#define SRV_CRASHES_MAX       5u
#define SRV_CRASHES_LIMIT     1024u
#define SRV_CRASHES_WINDOW_MS 10000u

/* Run workers, each this program with the same `argv`, until one ends by itself. Returns
 * the exit status of the program. The caller holds the lock of the socket path. */
int srv_supervise(const struct srv_options *options, char **argv,
                  struct srv_lockfile *lockfile);

#endif

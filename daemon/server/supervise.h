/* supervise.h - a small parent that starts the daemon again when it crashes.
 *
 * Hold the lock and the listening socket, so that clients queue, and are not refused,
 * while a worker starts; pass signals on; give up when the worker crashes again and
 * again; listen again, or let go, when the socket's file is gone.
 *
 * Threads: one.
 */
#ifndef SRV_SUPERVISE_H
#define SRV_SUPERVISE_H

#include <stdbool.h>
#include <stdint.h>

#include "options.h"
#include "socketfile.h"

/* Crashes within that time after which it gives up: as a rule, and at most. */
#define SRV_CRASHES_MAX       5u
#define SRV_CRASHES_LIMIT     1024u
#define SRV_CRASHES_WINDOW_MS 10000u

/* Run workers, each this program with the same `argv`, until one ends by itself. Returns
 * the exit status of the program. The caller holds the lock of the socket path. */
int srv_supervise(const struct srv_options *options, char **argv,
                  struct srv_lockfile *lockfile);

/* ---- Settings that were changed while the daemon ran outlive a crash of the worker. */

struct srv_config_kept;

/* Make, in a supervisor, the memory that keeps them, and the configuration file (NULL:
 * there is none). Returns its descriptor, closed on exec; -1: none is to be had, and a
 * crash loses the changes. */
int srv_kept_make(const struct srv_settings_file *file);

/* Share the memory of `fd` with the program; negative: none. In a child, before exec.
 * Returns 0 or a status, errno set. */
int srv_kept_give(int fd);

/* Read the configuration file that a supervisor keeps for this process. False: there is
 * no supervisor. */
bool srv_kept_file(struct srv_settings_file *file);

/* Take what this process was given, for as long as it runs; NULL: nothing. Once. */
struct srv_config_kept *srv_kept_take(void);

#endif

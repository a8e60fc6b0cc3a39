/* sandbox.h - gives up every right that a daemon does not need.
 *
 * Take no new privileges, and allow only a list of system calls: no files opened but its
 * own memory files again, no programs or processes started, no executable memory, no
 * sockets but of the kind that listens. Landlock takes away the rest of the file system
 * (landlock.c).
 *
 * Threads: [loop]; holds for all threads, those to come too, but for the first step.
 */
#ifndef SRV_SANDBOX_H
#define SRV_SANDBOX_H

#include "options.h"

/* Take the first step, before there is a second thread or an event loop: from here on no
 * io_uring is made; and, where the kernel has Landlock, no file but the socket and its
 * lock is made, written or removed, and none is read. Unless options->sandbox says
 * otherwise. */
void srv_sandbox_begin(const struct srv_options *options);

/* Return its parts, for the log: "" or words that begin with a comma. */
const char *srv_sandbox_text(void);

/* Enter it as options->sandbox says, when everything is open. Returns 0, or
 * PCCD_E_SYSTEM where it is wanted and cannot be had: why is logged. */
int srv_sandbox_enter(const struct srv_options *options);

/* Return whether this build has one, and it is entered unless options say otherwise. */
bool srv_sandbox_is_default(void);

/* ---- Takes away the daemon's right to read and change files (Landlock).
 *
 * Ask the kernel to let this process create, write and remove nothing but the socket and
 * its lock in their folder, and read no file at all. Its own memory files, which have no
 * path, do not count as files here. */

/* Enter it. Returns the version of the kernel's Landlock, from 1, or 0: it has none, or
 * lets nobody use it, and nothing has changed. */
int srv_landlock_enter(const struct srv_options *options);

#endif

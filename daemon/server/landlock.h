/* landlock.h - takes away the daemon's right to read and change files (Landlock).
 *
 * Ask the kernel to let this process create, write and remove nothing but the socket and
 * its lock in their folder, and read no file at all. Its own memory files, which have no
 * path, do not count as files here.
 *
 * Threads: [main], before there is a second thread: it holds for those that are made
 * afterwards.
 */
#ifndef SRV_LANDLOCK_H
#define SRV_LANDLOCK_H

#include "options.h"

/* Returns the version of the kernel's Landlock, from 1, or 0: it has none, or lets nobody
 * use it, and nothing has changed. */
int srv_landlock_enter(const struct srv_options *options);

#endif

/* lockfile.h - makes sure that only one daemon serves a socket path. */
#ifndef SRV_LOCKFILE_H
#define SRV_LOCKFILE_H

#include <stdbool.h>
#include <sys/types.h>

#define SRV_LOCKFILE_BYTES 128u

struct srv_lockfile {
    int fd; /* -1: not held */
    char path[SRV_LOCKFILE_BYTES];
};

/* Take the lock of `socket_path` (at most 107 bytes) and write our process id into it.
 * Returns 0, PCCD_E_BUSY (*holder is the process that has it, 0: unknown) or
 * PCCD_E_SYSTEM (errno is set). */
int srv_lockfile_acquire(struct srv_lockfile *lockfile, const char *socket_path,
                         pid_t *holder);

/* Whether the lock that we hold is still that of the path: not when the file was removed,
 * or its folder renamed. */
bool srv_lockfile_is_held(const struct srv_lockfile *lockfile);

/* Remove the file, if it is the one that we hold, and drop the lock; nothing when it is
 * not held. */
void srv_lockfile_release(struct srv_lockfile *lockfile);

#endif

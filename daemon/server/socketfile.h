/* socketfile.h - the file by which clients find the socket, and its lock.
 *
 * Threads: [loop], or a supervisor's only one.
 */
#ifndef SRV_SOCKETFILE_H
#define SRV_SOCKETFILE_H

#include <stdbool.h>
#include <sys/types.h>

#include "options.h"

/* After a change, before a look: who removes a whole folder shall be at the end first. */
#define SRV_SOCKETFILE_SETTLE_MS 100u

enum srv_socketfile_state {
    SRV_SOCKETFILE_OURS = 0,  /* clients find our socket */
    SRV_SOCKETFILE_GONE = 1,  /* nothing is there */
    SRV_SOCKETFILE_TAKEN = 2, /* something that is not ours is */
};

struct srv_socketfile {
    const char *path;
    int notify_fd; /* readable after a change; -1: nobody tells */
    dev_t device;
    ino_t inode; /* 0: we know of no file */
};

/* Make the folder of the socket when it is missing: for us alone, or with a list of who
 * may be a client for others to pass. Returns 0 or a status; what was wrong is logged.
 * Before the lock is taken. */
int srv_socketfile_prepare_folder(const struct srv_options *options);

/* Open a listening socket at the options' path in *fd, for us alone, or with a list of
 * who may be a client for everybody to connect to and be judged; a socket that is there
 * is a dead daemon's, because the caller holds the lock. The file is watched from then
 * on, but for that of a private daemon: its client is connected and needs the file no
 * more, and to stop watching takes the kernel 8 ms, for which the client's end would
 * wait. May be called a second time where the first one's file is gone. Returns 0 or a
 * status, errno set. */
int srv_socketfile_bind(struct srv_socketfile *file, const struct srv_options *options,
                        int *fd);

/* Watch the file of a socket that somebody else has bound. */
void srv_socketfile_adopt(struct srv_socketfile *file, const char *path);

/* Return how things are, after a change or at any time; what was to read is read. */
enum srv_socketfile_state srv_socketfile_look(struct srv_socketfile *file);

/* Remove the file if it is ours, and watch no more. */
void srv_socketfile_remove(struct srv_socketfile *file);
/* Watch no more, and leave the file there. */
void srv_socketfile_leave(struct srv_socketfile *file);

/* ---- Makes sure that only one daemon serves a socket path. */

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

/* Return whether the lock that we hold is still that of the path: not when the file was
 * removed, or its folder renamed. */
bool srv_lockfile_is_held(const struct srv_lockfile *lockfile);

/* Remove the file, if it is the one that we hold, and drop the lock; nothing when it is
 * not held. */
void srv_lockfile_release(struct srv_lockfile *lockfile);

#endif

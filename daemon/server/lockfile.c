/* lockfile.c - one daemon per socket path. */
#include "socketfile.h"

#include <errno.h>
#include <fcntl.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include "pccd_types.h"

#define ATTEMPTS_MAX 16 /* a holder that leaves removes the file once */

static pid_t read_pid(int fd)
{
    char text[32] = {0};
    ssize_t bytes = pread(fd, text, sizeof text - 1, 0);
    return bytes > 0 ? (pid_t)strtol(text, NULL, 10) : 0;
}

static int write_pid(int fd)
{
    char text[32];
    int bytes = snprintf(text, sizeof text, "%ld\n", (long)getpid());
    if (ftruncate(fd, 0) != 0 || pwrite(fd, text, (size_t)bytes, 0) != bytes) {
        return PCCD_E_SYSTEM;
    }
    return 0;
}

/* Return whether `path` still leads to the file that `fd` has open. */
static bool is_same_file(int fd, const char *path)
{
    struct stat opened;
    struct stat named;
    return fstat(fd, &opened) == 0 && stat(path, &named) == 0 &&
           opened.st_dev == named.st_dev && opened.st_ino == named.st_ino;
}

int srv_lockfile_acquire(struct srv_lockfile *lockfile, const char *socket_path,
                         pid_t *holder)
{
    lockfile->fd = -1;
    snprintf(lockfile->path, sizeof lockfile->path, "%s.lock", socket_path);
    for (int attempt = 0; attempt < ATTEMPTS_MAX; attempt++) {
        int fd = open(lockfile->path, O_RDWR | O_CREAT | O_CLOEXEC | O_NOFOLLOW, 0600);
        if (fd < 0) {
            return PCCD_E_SYSTEM;
        }
        int status = 0;
        if (flock(fd, LOCK_EX | LOCK_NB) != 0) {
            status = errno == EWOULDBLOCK ? PCCD_E_BUSY : PCCD_E_SYSTEM;
            *holder = read_pid(fd);
        } else if (is_same_file(fd, lockfile->path)) {
            status = write_pid(fd);
            lockfile->fd = status == 0 ? fd : -1;
        } else {
            close(fd); /* removed by its last holder between our open and our lock */
            continue;
        }
        if (status != 0) {
            int saved = errno;
            close(fd);
            errno = saved;
        }
        return status;
    }
    errno = EAGAIN;
    return PCCD_E_SYSTEM;
}

bool srv_lockfile_is_held(const struct srv_lockfile *lockfile)
{
    return lockfile->fd >= 0 && is_same_file(lockfile->fd, lockfile->path);
}

void srv_lockfile_release(struct srv_lockfile *lockfile)
{
    if (lockfile->fd >= 0) {
        if (is_same_file(lockfile->fd, lockfile->path)) {
            unlink(lockfile->path);
        }
        close(lockfile->fd);
        lockfile->fd = -1;
    }
}

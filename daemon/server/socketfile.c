/* socketfile.c - the file by which clients find the socket. */
#include "socketfile.h"

#include <errno.h>
#include <limits.h>
#include <stdio.h>
#include <string.h>
#include <sys/inotify.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <unistd.h>

#include "allow.h"
#include "invariant.h"
#include "log.h"
#include "pccd_types.h"

#define BACKLOG   4096 /* clients that all come back after a crash */
#define READS_MAX 1000 /* of what there is to read at a time */

/* ---- making it --------------------------------------------------------------------- */

int srv_socketfile_prepare_folder(const struct srv_options *options)
{
    const char *socket_path = options->socket_path;
    mode_t mode = srv_allow_has_list(&options->allow) ? 0711 : 0700;
    char folder[SRV_SOCKET_PATH_BYTES];
    const char *slash = strrchr(socket_path, '/');
    if (slash == NULL || slash == socket_path) {
        return 0; /* the current folder, or the root */
    }
    snprintf(folder, sizeof folder, "%.*s", (int)(slash - socket_path), socket_path);
    mode_t before = umask(0); /* no other thread creates files */
    int failed = mkdir(folder, mode);
    umask(before);
    if (failed != 0 && errno != EEXIST) {
        srv_log(SRV_LOG_ERROR, 0, "%s: %s", folder, strerror(errno));
        return PCCD_E_SYSTEM;
    }
    struct stat info;
    if (lstat(folder, &info) != 0) {
        srv_log(SRV_LOG_ERROR, 0, "%s: %s", folder, strerror(errno));
        return PCCD_E_SYSTEM;
    }
    /* In a folder where others may rename, they could put their socket in place of ours.
     * A link is judged by what it leads to, unless somebody else made it. */
    bool ours = info.st_uid == geteuid() || info.st_uid == 0;
    if (ours && S_ISLNK(info.st_mode)) {
        ours = stat(folder, &info) == 0 && (info.st_uid == geteuid() || info.st_uid == 0);
    }
    bool open_to_all =
        (info.st_mode & (S_IWGRP | S_IWOTH)) != 0 && (info.st_mode & S_ISVTX) == 0;
    if (!ours || !S_ISDIR(info.st_mode) || open_to_all) {
        srv_log(
            SRV_LOG_ERROR, 0,
            "%s must be a folder of this user or of root that nobody else can write to",
            folder);
        return PCCD_E_SYSTEM;
    }
    return 0;
}

/* Remove what a dead daemon left; anything but a socket stays. */
static int remove_stale(const char *path)
{
    struct stat info;
    if (lstat(path, &info) != 0) {
        return errno == ENOENT ? 0 : PCCD_E_SYSTEM;
    }
    if (!S_ISSOCK(info.st_mode)) {
        errno = EEXIST;
        return PCCD_E_SYSTEM;
    }
    return unlink(path) == 0 ? 0 : PCCD_E_SYSTEM;
}

static int listen_at(const struct srv_options *options, int socket)
{
    struct sockaddr_un address = {.sun_family = AF_UNIX};
    /* Checked with the options. */
    PCCD_ASSERT(strlen(options->socket_path) < sizeof address.sun_path);
    strcpy(address.sun_path, options->socket_path);
    if (remove_stale(options->socket_path) != 0) {
        return PCCD_E_SYSTEM;
    }
    mode_t before = umask(srv_allow_has_list(&options->allow) ? 0111 : 0177);
    int failed = bind(socket, (const struct sockaddr *)&address, sizeof address);
    umask(before); /* no other thread creates files */
    return failed == 0 && listen(socket, BACKLOG) == 0 ? 0 : PCCD_E_SYSTEM;
}

/* ---- watching it ------------------------------------------------------------------- */

/* Watch the folder of the socket; what cannot be watched, for want of a right to read it,
 * is not. */
static void watch(struct srv_socketfile *file)
{
    const uint32_t moves = IN_MOVE_SELF | IN_DELETE_SELF;
    char folder[SRV_SOCKET_PATH_BYTES];
    size_t length = strlen(file->path);
    if (file->notify_fd < 0) {
        return;
    }
    if (inotify_add_watch(file->notify_fd, file->path,
                          moves | IN_ATTRIB | IN_DONT_FOLLOW) < 0) {
        srv_log(SRV_LOG_WARN, 0, "%s cannot be watched: %s", file->path, strerror(errno));
    }
    for (size_t i = 1; i < length; i++) {
        if (file->path[i] == '/') { /* where a folder's name is a link's, of both */
            snprintf(folder, sizeof folder, "%.*s", (int)i, file->path);
            (void)inotify_add_watch(file->notify_fd, folder, moves);
            (void)inotify_add_watch(file->notify_fd, folder, moves | IN_DONT_FOLLOW);
        }
    }
}

/* From now on what is at the path is ours. */
static void remember(struct srv_socketfile *file)
{
    struct stat info;
    bool there = lstat(file->path, &info) == 0 && S_ISSOCK(info.st_mode);
    file->device = there ? info.st_dev : 0;
    file->inode = there ? info.st_ino : 0;
    watch(file);
}

static void begin(struct srv_socketfile *file, const char *path, bool is_watched)
{
    *file = (struct srv_socketfile){.path = path, .notify_fd = -1};
    if (!is_watched) {
        return;
    }
    file->notify_fd = inotify_init1(IN_CLOEXEC | IN_NONBLOCK);
    if (file->notify_fd < 0) {
        srv_log(SRV_LOG_WARN, 0, "%s may be removed unnoticed, without inotify: %s", path,
                strerror(errno));
    }
}

int srv_socketfile_bind(struct srv_socketfile *file, const struct srv_options *options,
                        int *fd)
{
    int made = socket(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
    if (made < 0) {
        return PCCD_E_SYSTEM;
    }
    int status = listen_at(options, made);
    if (status != 0) {
        int saved = errno;
        close(made);
        errno = saved;
        return status;
    }
    if (file->path == NULL) {
        begin(file, options->socket_path, !options->private_daemon);
    }
    remember(file);
    *fd = made;
    return 0;
}

void srv_socketfile_adopt(struct srv_socketfile *file, const char *path)
{
    begin(file, path, true);
    remember(file);
}

static void read_all(int fd)
{
    char events[sizeof(struct inotify_event) + NAME_MAX + 1];
    for (int i = 0; i < READS_MAX && read(fd, events, sizeof events) > 0; i++) {
    }
}

enum srv_socketfile_state srv_socketfile_look(struct srv_socketfile *file)
{
    struct stat info;
    if (file->notify_fd >= 0) {
        read_all(file->notify_fd);
    }
    if (lstat(file->path, &info) != 0) {
        return errno == ENOENT || errno == ENOTDIR ? SRV_SOCKETFILE_GONE
                                                   : SRV_SOCKETFILE_OURS;
    }
    return info.st_dev == file->device && info.st_ino == file->inode
               ? SRV_SOCKETFILE_OURS
               : SRV_SOCKETFILE_TAKEN;
}

void srv_socketfile_leave(struct srv_socketfile *file)
{
    if (file->path != NULL && file->notify_fd >= 0) {
        close(file->notify_fd);
    }
    *file = (struct srv_socketfile){.notify_fd = -1};
}

void srv_socketfile_remove(struct srv_socketfile *file)
{
    if (file->path != NULL && srv_socketfile_look(file) == SRV_SOCKETFILE_OURS) {
        unlink(file->path);
    }
    srv_socketfile_leave(file);
}

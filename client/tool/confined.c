/* confined.c - what is opened beneath one folder. */
#include "confined.h"

#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <linux/openat2.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <unistd.h>

static int confined_to = -1;
static char *folder_name; /* absolute, without links */

/* The kernel walks the path, so nobody can change it between a look and the opening. */
static int open_beneath(const char *path, int flags)
{
    const struct open_how how = {.flags = (unsigned)flags | O_CLOEXEC,
                                 .resolve = RESOLVE_BENEATH | RESOLVE_NO_MAGICLINKS};
    return (int)syscall(SYS_openat2, confined_to, tool_from_folder(path), &how,
                        sizeof how);
}

int tool_confine(const char *folder)
{
    char *name = realpath(folder, NULL);
    int fd = name != NULL ? open(name, O_PATH | O_DIRECTORY | O_CLOEXEC) : -1;
    int error = fd < 0 || fchdir(fd) != 0 ? errno : 0;
    if (error == 0) {
        confined_to = fd;
        folder_name = name;
        int probe = open_beneath(".", O_PATH); /* older kernels have no such call */
        error = probe < 0 ? errno : 0;
        (void)close(probe);
    }
    if (error != 0) {
        confined_to = -1;
        folder_name = NULL;
        free(name);
        (void)close(fd);
    }
    return error;
}

const char *tool_from_folder(const char *path)
{
    size_t length = folder_name != NULL ? strlen(folder_name) : 0;
    if (length == 0 || strncmp(path, folder_name, length) != 0 || path[length] != '/') {
        return path;
    }
    path += length;
    path += strspn(path, "/");
    return path[0] != '\0' ? path : ".";
}

int tool_open(const char *path)
{
    struct stat info;
    if (confined_to < 0) {
        return open(path, O_RDONLY | O_CLOEXEC);
    }
    /* A pipe without a writer would not open; it is refused below. */
    int fd = open_beneath(path, O_RDONLY | O_NONBLOCK | O_NOCTTY);
    if (fd < 0 || (fstat(fd, &info) == 0 &&
                   (S_ISREG(info.st_mode) || S_ISDIR(info.st_mode)))) {
        return fd;
    }
    (void)close(fd);
    errno = ENXIO; /* as open() says of a socket */
    return -1;
}

/* The folder that a path names a file of: all before its last slash. */
static int look_at_folder(const char *path)
{
    char folder[PATH_MAX];
    const char *slash = strrchr(path, '/');
    size_t length = slash == NULL ? 0 : slash == path ? 1 : (size_t)(slash - path);
    if (length >= sizeof folder) {
        return -ENAMETOOLONG;
    }
    memcpy(folder, length > 0 ? path : ".", length > 0 ? length : 1);
    folder[length > 0 ? length : 1] = '\0';
    int fd = open_beneath(folder, O_PATH | O_DIRECTORY);
    return fd >= 0 ? fd : -errno;
}

int tool_is_outside(const char *path, bool is_new)
{
    path = tool_from_folder(path);
    if (confined_to < 0) {
        return 0;
    }
    int fd = open_beneath(path, O_PATH);
    int error = fd >= 0 ? 0 : errno;
    if (fd >= 0) {
        (void)close(fd);
        return is_new ? EEXIST : 0;
    }
    if (error != ENOENT) {
        return error;
    }
    int folder = look_at_folder(path);
    if (folder < 0) {
        return -folder;
    }
    /* A link that leads to nothing yet is no free name. */
    const char *slash = strrchr(path, '/');
    struct stat info;
    bool is_link = fstatat(folder, slash != NULL ? slash + 1 : path, &info,
                           AT_SYMLINK_NOFOLLOW) == 0;
    (void)close(folder);
    return is_link ? EXDEV : 0;
}

const char *tool_why(int error)
{
    return error == EXDEV    ? "it is outside of the folder that may be read"
           : error == ENXIO  ? "it is no file: a pipe, a socket or a device"
           : error == ENOSYS ? "this kernel has no openat2 (Linux 5.6)"
                             : strerror(error);
}

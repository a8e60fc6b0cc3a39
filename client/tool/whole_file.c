/* whole_file.c - files that appear whole or not at all; what a name tells. */
#include "whole_file.h"

#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#define NAMES_TRIED  100u
#define BUFFER_BYTES 65536u

/* ---- writing ----------------------------------------------------------------------- */

/* stdio forgets why a write failed; who writes shall be told. */
static ssize_t write_some(void *cookie, const char *from, size_t bytes)
{
    struct whole_file *file = cookie;
    size_t written = 0;
    while (written < bytes) {
        ssize_t more = write(file->fd, from + written, bytes - written);
        if (more < 0 && errno == EINTR) {
            continue;
        }
        if (more < 0) {
            file->error = file->error != 0 ? file->error : errno;
            break;
        }
        written += (size_t)more;
    }
    file->bytes += written;
    return written > 0 ? (ssize_t)written : 0; /* fewer than `bytes`: an error */
}

/* ---- names ------------------------------------------------------------------------- */

/* Return whether `path` names a descriptor of ours, whatever stands behind it. */
static bool is_descriptor(const char *path)
{
    return strncmp(path, "/dev/fd/", 8) == 0 || strncmp(path, "/dev/std", 8) == 0 ||
           strncmp(path, "/proc/", 6) == 0;
}

/* "FOLDER/" of a path, in memory of its own. */
static char *folder_of(const char *path)
{
    const char *slash = strrchr(path, '/');
    return slash != NULL ? strndup(path, (size_t)(slash - path) + 1) : strdup("./");
}

/* A name beside the file's that nothing has, opened or linked by `take`. */
static int take_name(struct whole_file *file, int (*take)(struct whole_file *, mode_t),
                     mode_t mode)
{
    size_t room = strlen(file->path) + 32;
    int error = EEXIST;
    file->temporary = malloc(room);
    if (file->temporary == NULL) {
        return ENOMEM;
    }
    for (unsigned i = 0; i < NAMES_TRIED && error == EEXIST; i++) {
        snprintf(file->temporary, room, "%s.%ld-%u.part", file->path, (long)getpid(), i);
        error = take(file, mode) == 0 ? 0 : errno;
    }
    if (error != 0) {
        free(file->temporary);
        file->temporary = NULL;
    }
    return error;
}

static int create_named(struct whole_file *file, mode_t mode)
{
    file->fd = open(file->temporary, O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, mode);
    return file->fd >= 0 ? 0 : -1;
}

static int link_named(struct whole_file *file, mode_t mode)
{
    char nameless[64];
    (void)mode;
    snprintf(nameless, sizeof nameless, "/proc/self/fd/%d", file->fd);
    return linkat(AT_FDCWD, nameless, AT_FDCWD, file->temporary, AT_SYMLINK_FOLLOW);
}

/* A file beside `file->path`, without a name where there can be one. */
static int create(struct whole_file *file)
{
    char *folder = folder_of(file->path);
    if (folder == NULL) {
        return ENOMEM;
    }
    int error = EOPNOTSUPP;
    if (access("/proc/self/fd", X_OK) == 0) { /* without it nothing gets a name later */
        file->fd = open(folder, O_TMPFILE | O_WRONLY | O_CLOEXEC, 0666);
        error = file->fd >= 0 ? 0 : errno;
    }
    free(folder);
    if (error == EOPNOTSUPP || error == EISDIR || error == EINVAL) {
        error = take_name(file, create_named, 0666);
    }
    return error;
}

/* Rights and owner of what it takes the place of, as far as we may give them. */
static void take_after(const struct whole_file *file, const struct stat *old)
{
    if (fchown(file->fd, old->st_uid, old->st_gid) != 0 &&
        fchown(file->fd, (uid_t)-1, old->st_gid) != 0) {
        errno = 0; /* it is ours then */
    }
    (void)fchmod(file->fd, old->st_mode & 0777);
}

static int open_beside(struct whole_file *file, const char *path)
{
    struct stat old;
    bool is_there = stat(path, &old) == 0;
    if (is_there && access(path, W_OK) != 0) {
        return errno;
    }
    file->path = is_there ? realpath(path, NULL) : strdup(path);
    int error = file->path != NULL ? create(file) : is_there ? errno : ENOMEM;
    if (error == 0 && is_there) {
        take_after(file, &old);
    }
    return error;
}

static int open_direct(struct whole_file *file, const char *path)
{
    bool is_stdout = strcmp(path, "/dev/stdout") == 0;
    file->is_direct = true;
    file->fd = is_stdout ? fcntl(STDOUT_FILENO, F_DUPFD_CLOEXEC, 3)
                         : open(path, O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
    return file->fd >= 0 ? 0 : errno;
}

/* ---- opening and closing ----------------------------------------------------------- */

int whole_file_open(struct whole_file *file, const char *path)
{
    const cookie_io_functions_t functions = {.write = write_some};
    struct stat info;
    *file = (struct whole_file){.fd = -1};
    bool is_direct = is_descriptor(path) || path[0] == '\0' ||
                     (stat(path, &info) == 0 && !S_ISREG(info.st_mode));
    int error = is_direct ? open_direct(file, path) : open_beside(file, path);
    if (error == 0) {
        file->to = fopencookie(file, "w", functions);
        error = file->to != NULL ? 0 : ENOMEM;
    }
    if (error == 0) {
        setvbuf(file->to, NULL, _IOFBF, BUFFER_BYTES);
    }
    if (error != 0) {
        whole_file_discard(file);
        return error;
    }
    signal(SIGXFSZ, SIG_IGN);
    return 0;
}

/* Name it beside the file, where it has no name yet, and put it into that one's place. */
static int give_name(struct whole_file *file)
{
    int error = fsync(file->fd) == 0 ? 0 : errno;
    if (error == EINVAL || error == EROFS) { /* there is nothing to wait for */
        error = 0;
    }
    if (error == 0 && file->temporary == NULL) {
        error = take_name(file, link_named, 0);
    }
    if (error == 0) {
        error = close(file->fd) == 0 ? 0 : errno;
        file->fd = -1;
    }
    if (error == 0 && rename(file->temporary, file->path) != 0) {
        error = errno;
    }
    if (error == 0) {
        free(file->temporary);
        file->temporary = NULL;
    }
    return error;
}

int whole_file_finish(struct whole_file *file)
{
    bool is_whole = fflush(file->to) == 0 && ferror(file->to) == 0;
    int error = file->error != 0 ? file->error : is_whole ? 0 : EIO;
    if (error == 0 && !file->is_direct) {
        error = give_name(file);
    }
    whole_file_discard(file);
    return error;
}

void whole_file_discard(struct whole_file *file)
{
    if (file->to != NULL) {
        fclose(file->to);
    }
    bool is_open = file->path != NULL || file->is_direct;
    if (is_open && file->fd >= 0) {
        close(file->fd);
    }
    if (file->temporary != NULL) {
        unlink(file->temporary);
    }
    free(file->temporary);
    free(file->path);
    *file = (struct whole_file){.fd = -1};
}

/* ---- What the name of a file tells. */

bool tool_ends_with(const char *path, const char *ending)
{
    size_t length = strlen(path), tail = strlen(ending);
    return length > tail && strcmp(path + length - tail, ending) == 0;
}

const char *tool_base_name(const char *path)
{
    const char *slash = strrchr(path, '/');
    return slash != NULL && slash[1] != '\0' ? slash + 1 : path;
}

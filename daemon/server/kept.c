/* kept.c - memory that a supervisor and its workers share. */
#include "supervise.h"

#include <limits.h>
#include <stddef.h>
#include <stdlib.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include "config.h"
#include "notify.h"

#define NAME    "PCCD_SETTINGS"
#define FILE_AT ((off_t)offsetof(struct srv_config_kept, file))

int srv_kept_make(const struct srv_settings_file *file)
{
    int fd = memfd_create("pccdd settings", MFD_CLOEXEC);
    if (fd >= 0 && (ftruncate(fd, (off_t)sizeof(struct srv_config_kept)) != 0 ||
                    (file != NULL && pwrite(fd, file, sizeof *file, FILE_AT) !=
                                         (ssize_t)sizeof *file))) {
        close(fd);
        fd = -1;
    }
    return fd;
}

int srv_kept_give(int fd)
{
    return srv_number_give(NAME, fd);
}

/* The descriptor that was given; -1: none. */
static int given(void)
{
    long fd = srv_number_of(NAME);
    return fd < SRV_GIVEN_FD_FLOOR || fd > INT_MAX ? -1 : (int)fd;
}

bool srv_kept_file(struct srv_settings_file *file)
{
    int fd = given();
    return fd >= 0 && pread(fd, file, sizeof *file, FILE_AT) == (ssize_t)sizeof *file &&
           file->count <= SRV_SETTINGS_LINES_MAX;
}

struct srv_config_kept *srv_kept_take(void)
{
    int fd = given();
    struct srv_config_kept *kept = NULL;
    struct stat info;
    unsetenv(NAME);
    if (fd < 0) {
        return NULL;
    }
    if (fstat(fd, &info) == 0 && info.st_size == (off_t)sizeof *kept) {
        kept = mmap(NULL, sizeof *kept, PROT_READ | PROT_WRITE, MAP_SHARED, fd, 0);
    }
    close(fd);
    return kept != MAP_FAILED ? kept : NULL;
}

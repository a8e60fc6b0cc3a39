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

#define NAME "PCCD_SETTINGS"

int srv_kept_make(void)
{
    int fd = memfd_create("pccdd settings", MFD_CLOEXEC);
    if (fd >= 0 && ftruncate(fd, (off_t)sizeof(struct srv_config_kept)) != 0) {
        close(fd);
        fd = -1;
    }
    return fd;
}

int srv_kept_give(int fd)
{
    return srv_number_give(NAME, fd);
}

struct srv_config_kept *srv_kept_take(void)
{
    long fd = srv_number_of(NAME);
    struct srv_config_kept *kept = NULL;
    struct stat info;
    unsetenv(NAME);
    if (fd < SRV_GIVEN_FD_FLOOR || fd > INT_MAX) {
        return NULL;
    }
    if (fstat((int)fd, &info) == 0 && info.st_size == (off_t)sizeof *kept) {
        kept = mmap(NULL, sizeof *kept, PROT_READ | PROT_WRITE, MAP_SHARED, (int)fd, 0);
    }
    close((int)fd);
    return kept != MAP_FAILED ? kept : NULL;
}

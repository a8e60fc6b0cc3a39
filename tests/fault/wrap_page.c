/* wrap_page.c - which call fails. */
#include <errno.h>
#include <fcntl.h>
#include <stdlib.h>
#include <sys/mman.h>

#include "fault.h"

int __real_open(const char *path, int flags, ...);
void *__real_mmap(void *at, size_t bytes, int protection, int flags, int fd, off_t from);
int __real_close(int fd);

static struct fault_page own_page;
struct fault_page *fault_page = &own_page;

/* Before main, so that faults at the start can be ordered, too. */
__attribute__((constructor)) static void take_shared_page(void)
{
    const char *path = getenv("PCCD_FAULT_PAGE");
    int fd = path != NULL ? __real_open(path, O_RDWR | O_CLOEXEC) : -1;
    if (fd < 0) {
        return;
    }
    void *page =
        __real_mmap(NULL, sizeof own_page, PROT_READ | PROT_WRITE, MAP_SHARED, fd, 0);
    if (page == MAP_FAILED) {
        abort();
    }
    __real_close(fd);
    fault_page = page;
}

bool fault_strikes(enum fault_call call)
{
    struct fault_page *page = fault_page;
    atomic_fetch_add(&page->counts[call], 1);
    if (atomic_load(&page->call) != call) {
        return false;
    }
    uint64_t at = atomic_fetch_add(&page->seen, 1) + 1;
    uint64_t first = atomic_load(&page->first);
    if (at < first || at - first >= atomic_load(&page->length)) {
        return false;
    }
    atomic_fetch_add(&page->hits, 1);
    errno = atomic_load(&page->error);
    return true;
}

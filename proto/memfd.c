/* memfd.c - sealed anonymous memory.
 *
 * Room:     proto. May include: memfd.h, pccd_types.h, the C library.
 * Does:     the system calls behind memfd.h.
 * Does not: write into the memory.
 * Threads:  [any].
 * Source:   seals do not prove the size (fstat does) and do not stop hole punching, so
 *           the daemon copies before it checks.
 */
#include <assert.h>
#include <errno.h>
#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

#include "memfd.h"
#include "pccd_types.h"
#include "shm.h"

#ifndef MADV_POPULATE_READ /* Linux 5.14 */
#define MADV_POPULATE_READ  22
#define MADV_POPULATE_WRITE 23
#endif

/* Pages are mapped and unmapped in pieces of this size: the kernel holds a lock on the
 * address space meanwhile, and other threads of the daemon, of higher priority, wait for
 * it when they map or unmap memory: milliseconds, for rings of 8 MiB. */
#define PIECE ((size_t)256 << 10)

/* Whoever makes memory pauses after so many bytes (0.2 ms). Without it others wait for a
 * tick (4 ms): those who are as entitled to its processor, but were not when they woke,
 * and writers of the address space's lock, which it takes again before they have run. */
#define TURN     ((size_t)512 << 10)
#define PAUSE_NS 50000

#define SEALS (F_SEAL_SHRINK | F_SEAL_GROW | F_SEAL_SEAL)

static int status_of_errno(int cause)
{
    return cause == ENOMEM || cause == ENOSPC ? PCCD_E_NOMEM : PCCD_E_SYSTEM;
}

static void give_way(void)
{
    (void)nanosleep(&(struct timespec){0, PAUSE_NS}, NULL);
}

/* Give the kernel an advice on the whole memory, piece by piece. It is no loss where the
 * kernel does not know it. */
static void advise(const struct proto_memory *memory, int advice, bool by_turns)
{
    for (size_t at = 0; at < memory->bytes; at += PIECE) {
        if (by_turns && at > 0 && at % TURN == 0) {
            give_way();
        }
        size_t bytes = memory->bytes - at < PIECE ? memory->bytes - at : PIECE;
        if (madvise((uint8_t *)memory->base + at, bytes, advice) != 0) {
            return;
        }
    }
}

/* All pages now: a page fault costs more than a copy of the page. */
static int map_pages(struct proto_memory *memory, int protection, bool by_turns)
{
    void *base = mmap(NULL, memory->bytes, protection, MAP_SHARED, memory->fd, 0);
    if (base == MAP_FAILED) {
        return status_of_errno(errno);
    }
    memory->base = base;
    advise(memory,
           (protection & PROT_WRITE) != 0 ? MADV_POPULATE_WRITE : MADV_POPULATE_READ,
           by_turns);
    return 0;
}

static int allocate(int fd, size_t bytes)
{
    int cause = 0;
    for (size_t at = 0; at < bytes && cause == 0; at += TURN) {
        size_t part = bytes - at < TURN ? bytes - at : TURN;
        do {
            cause = posix_fallocate(fd, (off_t)at, (off_t)part);
        } while (cause == EINTR);
        if (cause == 0 && at + TURN < bytes) {
            give_way();
        }
    }
    return cause == 0 ? 0 : status_of_errno(cause);
}

int proto_memory_create(struct proto_memory *memory, const char *name, size_t bytes,
                        bool client_read_only)
{
    struct proto_memory made = PROTO_MEMORY_NONE;
    int seals = SEALS | (client_read_only ? F_SEAL_FUTURE_WRITE : 0);
    int rc;

    assert(bytes > 0 && bytes % PROTO_SHM_PAGE == 0);
    made.bytes = bytes;
    made.fd = memfd_create(name, MFD_CLOEXEC | MFD_ALLOW_SEALING);
    if (made.fd < 0) {
        return status_of_errno(errno);
    }
    rc = allocate(made.fd, bytes);
    if (rc != 0) {
        goto fail;
    }
    rc = map_pages(&made, PROT_READ | PROT_WRITE, true);
    if (rc != 0) {
        goto fail;
    }
    if (fcntl(made.fd, F_ADD_SEALS, seals) != 0) {
        rc = status_of_errno(errno);
        goto fail;
    }
    *memory = made;
    return 0;

fail:
    proto_memory_deinit(&made);
    return rc;
}

int proto_memory_map(struct proto_memory *memory, int fd, size_t bytes, bool read_only)
{
    struct proto_memory made = {fd, NULL, bytes};
    struct stat info;
    int rc = PCCD_E_BADMSG;

    /* Without SHRINK an access could end in SIGBUS. FUTURE_WRITE belongs to the memory
     * that only the daemon writes, and to no other. */
    int wanted = SEALS | (read_only ? F_SEAL_FUTURE_WRITE : 0);
    int seals = fcntl(fd, F_GET_SEALS);
    if (seals < 0 || (seals & (SEALS | F_SEAL_FUTURE_WRITE)) != wanted) {
        goto fail;
    }
    if (fstat(fd, &info) != 0 || bytes == 0 || info.st_size != (off_t)bytes) {
        goto fail;
    }
    rc = map_pages(&made, read_only ? PROT_READ : PROT_READ | PROT_WRITE, false);
    if (rc != 0) {
        goto fail;
    }
    *memory = made;
    return 0;

fail:
    proto_memory_deinit(&made);
    return rc;
}

void proto_memory_deinit(struct proto_memory *memory)
{
    if (memory->base != NULL) {
        advise(memory, MADV_DONTNEED, false); /* the pages stay in the file */
        munmap(memory->base, memory->bytes);
    }
    if (memory->fd >= 0) {
        close(memory->fd);
    }
    *memory = (struct proto_memory)PROTO_MEMORY_NONE;
}

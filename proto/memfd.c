/* memfd.c - sealed anonymous memory. */
#include <assert.h>
#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

#include "memfd.h"
#include "pccd_types.h"
#include "shm.h"

#ifndef MADV_POPULATE_READ /* Linux 5.14 */
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

/* Give the kernel an advice on [from, to) of the memory, piece by piece. Returns 0 or the
 * cause why it stopped. */
static int advise(const struct proto_memory *memory, size_t from, size_t to, int advice,
                  bool by_turns)
{
    for (size_t at = from; at < to; at += PIECE) {
        if (by_turns && at > from && (at - from) % TURN == 0) {
            give_way();
        }
        size_t bytes = to - at < PIECE ? to - at : PIECE;
        if (madvise((uint8_t *)memory->base + at, bytes, advice) != 0) {
            return errno;
        }
    }
    return 0;
}

static int map_pages(struct proto_memory *memory, int protection)
{
    void *base = mmap(NULL, memory->bytes, protection, MAP_SHARED, memory->fd, 0);
    if (base == MAP_FAILED) {
        return status_of_errno(errno);
    }
    memory->base = base;
    return 0;
}

/* Where the kernel does not know the advice (Linux before 5.14), pages come as they are
 * touched. */
static int populate(struct proto_memory *memory, size_t from, size_t to, bool by_turns)
{
    proto_memory_touch(memory, to);
    int cause = advise(memory, from, to, MADV_POPULATE_WRITE, by_turns);
    return cause == 0 || cause == EINVAL ? 0 : PCCD_E_NOMEM;
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

/* Return whether the kernel takes pages of a mapping and says when it cannot: Linux
 * before 5.14 would kill who writes to them. */
static bool can_take(const struct proto_memory *memory)
{
    return advise(memory, 0, PROTO_SHM_PAGE, MADV_POPULATE_WRITE, false) != EINVAL;
}

/* Another descriptor of the same memory, which can only be read from. -1: not here. */
static int open_read_only(int fd)
{
    char path[32];

    (void)snprintf(path, sizeof path, "/proc/self/fd/%d", fd);
    /* Else anybody who has a descriptor opens another one, to write. */
    return fchmod(fd, S_IRUSR) == 0 ? open(path, O_RDONLY | O_CLOEXEC) : -1;
}

int proto_memory_create(struct proto_memory *memory, const char *name, size_t bytes,
                        size_t taken, bool client_read_only)
{
    struct proto_memory made = PROTO_MEMORY_NONE;
    int seals = SEALS;
    int reader = -1;
    int status;

    assert(bytes > 0 && bytes % PROTO_SHM_PAGE == 0);
    assert(taken > 0 && taken <= bytes && taken % PROTO_SHM_PAGE == 0);
    made.bytes = bytes;
    made.fd = memfd_create(name, MFD_CLOEXEC | MFD_ALLOW_SEALING);
    if (made.fd < 0) {
        return status_of_errno(errno);
    }
    status = allocate(made.fd, taken);
    if (status != 0) {
        goto fail;
    }
    if (taken < bytes && ftruncate(made.fd, (off_t)bytes) != 0) {
        status = status_of_errno(errno);
        goto fail;
    }
    status = map_pages(&made, PROT_READ | PROT_WRITE);
    if (status == 0) {
        (void)populate(&made, 0, taken, true); /* it has memory: only page faults */
    }
    if (status == 0 && taken < bytes && !can_take(&made)) {
        status = allocate(made.fd, bytes);
    }
    if (status != 0) {
        goto fail;
    }
    if (client_read_only) {
        reader = open_read_only(made.fd);
        seals |= reader < 0 ? F_SEAL_FUTURE_WRITE : 0;
    }
    if (fcntl(made.fd, F_ADD_SEALS, seals) != 0) {
        status = status_of_errno(errno);
        goto fail;
    }
    if (reader >= 0) {
        (void)close(made.fd);
        made.fd = reader;
    }
    *memory = made;
    return 0;

fail:
    if (reader >= 0) {
        (void)close(reader);
    }
    proto_memory_deinit(&made);
    return status;
}

int proto_memory_take(struct proto_memory *memory, size_t from, size_t to)
{
    assert(from % PROTO_SHM_PAGE == 0 && from < to && to <= memory->bytes);
    return populate(memory, from, to, true);
}

int proto_memory_populate(struct proto_memory *memory, size_t from, size_t to)
{
    assert(from % PROTO_SHM_PAGE == 0 && from < to && to <= memory->bytes);
    return populate(memory, from, to, false);
}

int proto_memory_give_back(struct proto_memory *memory, size_t from, size_t to)
{
    assert(from % PROTO_SHM_PAGE == 0 && from < to && to <= memory->bytes);
    if (!can_take(memory)) {
        return PCCD_E_SYSTEM; /* it could not be taken again */
    }
    return advise(memory, from, to, MADV_REMOVE, false) == 0 ? 0 : PCCD_E_SYSTEM;
}

int proto_memory_share(const struct proto_memory *memory)
{
    return fcntl(memory->fd, F_DUPFD_CLOEXEC, 0);
}

size_t proto_memory_held(const struct proto_memory *memory)
{
    struct stat info;
    return memory->fd >= 0 && fstat(memory->fd, &info) == 0
               ? (size_t)info.st_blocks * 512 /* whatever st_blksize is: POSIX */
               : 0;
}

/* Return whether a descriptor is of the memory that only the daemon writes, or of the
 * other. */
static bool is_of_kind(int fd, int seals, bool read_only)
{
    int mode = fcntl(fd, F_GETFL);
    bool is_sealed = (seals & F_SEAL_FUTURE_WRITE) != 0;

    return mode >= 0 && ((mode & O_ACCMODE) == O_RDONLY || is_sealed) == read_only;
}

int proto_memory_map(struct proto_memory *memory, int fd, size_t bytes, bool read_only)
{
    struct proto_memory made = {fd, NULL, bytes, 0, NULL};
    struct stat info;
    int status = PCCD_E_BADMSG;

    /* Without SHRINK an access could end in SIGBUS. */
    int seals = fcntl(fd, F_GET_SEALS);
    if (seals < 0 || (seals & SEALS) != SEALS || !is_of_kind(fd, seals, read_only)) {
        goto fail;
    }
    if (fstat(fd, &info) != 0 || bytes == 0 || info.st_size != (off_t)bytes) {
        goto fail;
    }
    /* To touch a hole is to fill it, so nothing is populated. */
    status = map_pages(&made, read_only ? PROT_READ : PROT_READ | PROT_WRITE);
    if (status != 0) {
        goto fail;
    }
    *memory = made;
    return 0;

fail:
    proto_memory_deinit(&made);
    return status;
}

void proto_memory_touch(struct proto_memory *memory, size_t end)
{
    memory->reach = end > memory->reach ? end : memory->reach;
}

void proto_memory_deinit(struct proto_memory *memory)
{
    if (memory->base != NULL && memory->unmap != NULL) {
        memory->unmap->call(memory->unmap->context, memory->base, memory->bytes);
    } else if (memory->base != NULL) {
        /* The pages stay in the file. */
        (void)advise(memory, 0, memory->reach, MADV_DONTNEED, false);
        munmap(memory->base, memory->bytes);
    }
    if (memory->fd >= 0) {
        close(memory->fd);
    }
    *memory = (struct proto_memory)PROTO_MEMORY_NONE;
}

/* memfd.h - creates and maps the memory that the daemon and a client share. */
#ifndef PROTO_MEMFD_H
#define PROTO_MEMFD_H

#include <stdbool.h>
#include <stddef.h>

/* Call that unmaps a memory in the place of proto_memory_deinit. */
struct proto_unmap {
    void (*call)(void *context, void *base, size_t bytes);
    void *context;
};

/* A mapped memory. */
struct proto_memory {
    int fd;     /* -1: none */
    void *base; /* NULL: none */
    size_t bytes;
    size_t reach; /* from the start: pages that may have been touched lie before it */
    const struct proto_unmap *unmap; /* NULL: munmap */
};

#define PROTO_MEMORY_NONE                                                                \
    {                                                                                    \
        -1, NULL, 0, 0, NULL                                                             \
    }

/* Create `bytes` (a multiple of the page size) of memory: memfd, close-on-exec, mapped
 * shared, sealed SHRINK, GROW and SEAL. With `client_read_only` the descriptor that is
 * left, which the client gets, can only be read from, and nobody but this process's own
 * user can open it anew; where /proc is missing it is sealed FUTURE_WRITE instead, after
 * our own mapping, and no memory can be given back. The first `taken` bytes (whole pages)
 * are posix_fallocate'd and populated; the rest is a hole, which takes no memory until
 * proto_memory_take.
 * Returns 0, PCCD_E_NOMEM or PCCD_E_SYSTEM; nothing is left behind on failure. */
int proto_memory_create(struct proto_memory *memory, const char *name, size_t bytes,
                        size_t taken, bool client_read_only);

/* Give [from, to), multiples of the page size, memory before it is written, so that a
 * lack of it is an error and no signal. Returns 0 or PCCD_E_NOMEM: part of it may have
 * been taken. */
int proto_memory_take(struct proto_memory *memory, size_t from, size_t to);

/* Give the memory of [from, to), multiples of the page size, back to the system; whoever
 * reads there then reads zeros. To be taken again before it is written. Returns 0, or
 * PCCD_E_SYSTEM where that cannot be done: then nothing has changed. */
int proto_memory_give_back(struct proto_memory *memory, size_t from, size_t to);

/* Return another descriptor of the memory, close-on-exec. -1: none is to be had. */
int proto_memory_share(const struct proto_memory *memory);

/* Return how many bytes the memory takes, whoever has touched them; 0 without a
 * descriptor. */
size_t proto_memory_held(const struct proto_memory *memory);

/* Map a received descriptor of exactly `bytes` after checking size (fstat), seals and
 * whether it can be written to. Nothing is populated.
 * Takes the descriptor over, also on failure. Returns 0, PCCD_E_BADMSG (another size,
 * other seals, or the other one of the two memories), PCCD_E_NOMEM or PCCD_E_SYSTEM. */
int proto_memory_map(struct proto_memory *memory, int fd, size_t bytes, bool read_only);

/* Populate [from, to), multiples of the page size, of a mapping that can be written to:
 * a page fault costs more than a copy of the page. Memory that is not there is taken.
 * Returns 0 or PCCD_E_NOMEM. */
int proto_memory_populate(struct proto_memory *memory, size_t from, size_t to);

/* Note that somebody reads or writes up to `end`: proto_memory_deinit unmaps pages before
 * it a few at a time. */
void proto_memory_touch(struct proto_memory *memory, size_t end);

/* Unmap and close; a memory with fd = -1 and base = NULL is left alone. */
void proto_memory_deinit(struct proto_memory *memory);

#endif

/* memfd.h - sealed anonymous memory.
 *
 * Room:     proto. May include: shm.h, the C library.
 * Does:     create (daemon) and map (both sides) the two memories of shm.h.
 * Threads:  [any].
 */
#ifndef PROTO_MEMFD_H
#define PROTO_MEMFD_H

#include <stdbool.h>
#include <stddef.h>

/* A mapped memory. */
struct proto_memory {
    int fd;     /* -1: none */
    void *base; /* NULL: none */
    size_t bytes;
};

#define PROTO_MEMORY_NONE {-1, NULL, 0}

/* Create `bytes` (a multiple of the page size) of memory: memfd, close-on-exec, mapped
 * shared, then sealed SHRINK, GROW and SEAL; with `client_read_only` also FUTURE_WRITE,
 * after our own mapping. The first `taken` bytes (likewise) are posix_fallocate'd and
 * populated; the rest is a hole, which takes no memory until proto_memory_take.
 * Returns 0, PCCD_E_NOMEM or PCCD_E_SYSTEM; nothing is left behind on failure. */
int proto_memory_create(struct proto_memory *memory, const char *name, size_t bytes,
                        size_t taken, bool client_read_only);

/* Give [from, to), multiples of the page size, memory before it is written, so that a
 * lack of it is an error and no signal. Returns 0 or PCCD_E_NOMEM: part of it may have
 * been taken. */
int proto_memory_take(struct proto_memory *memory, size_t from, size_t to);

/* Map a received descriptor of exactly `bytes` after checking size (fstat) and seals.
 * What is `read_only` is not populated.
 * Takes the descriptor over, also on failure. Returns 0, PCCD_E_BADMSG (wrong size or
 * seals), PCCD_E_NOMEM or PCCD_E_SYSTEM. */
int proto_memory_map(struct proto_memory *memory, int fd, size_t bytes, bool read_only);

/* Unmap and close; a memory with fd = -1 and base = NULL is left alone. */
void proto_memory_deinit(struct proto_memory *memory);

#endif

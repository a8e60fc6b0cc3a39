/* proto_direct.h - the functions of libpccd-direct, by which the client library runs the
 * service in its own process.
 *
 * Declare a way to send messages of the protocol and to receive them, as over a socket.
 * The two libraries may be of different releases: hello agrees on a version, as with a
 * daemon.
 */
#ifndef PROTO_DIRECT_H
#define PROTO_DIRECT_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "pccd_types.h"
#include "seqpacket.h"

/* Changes when a member of struct proto_direct does. */
#define PROTO_DIRECT_VERSION 9u

/* The file, and what it exports: a proto_direct_fn. */
#define PROTO_DIRECT_LIBRARY "libpccd-direct.so.0"
#define PROTO_DIRECT_SYMBOL  "pccd_direct_host"

#define PROTO_DIRECT_TEXT_BYTES 256u

struct proto_direct_inbox; /* of one client */

/* The uses of positions that are written to where the engine has them. */
enum proto_direct_lend {
    PROTO_DIRECT_LEND,     /* say where */
    PROTO_DIRECT_HAS_X1,   /* those at the end are there */
    PROTO_DIRECT_HAS_X0X1, /* both are */
    PROTO_DIRECT_FORGET    /* they will not be */
};

struct proto_direct {
    /* Another client of this process. Returns 0, PCCD_E_NOMEM, PCCD_E_QUOTA or
     * PCCD_E_STATE (a forked process), with the reason in text. [any] */
    int (*open)(struct proto_direct_inbox **line, char text[PROTO_DIRECT_TEXT_BYTES]);

    /* Handle one message. What it asks for is computed before this returns, by the
     * calling thread and its OpenMP team, and its answer can be received. While another
     * client's message is handled by another thread, this waits. Returns 0 or
     * PCCD_E_DISCONNECTED. [owner] */
    int (*send)(struct proto_direct_inbox *line, const void *message, size_t bytes);

    /* As proto_receive: 0, PCCD_E_AGAIN, PCCD_E_BADMSG or PCCD_E_DISCONNECTED. [owner] */
    int (*receive)(struct proto_direct_inbox *line, void *buffer, size_t capacity,
                   size_t *bytes, int fds[PROTO_FDS_MAX], int *fd_count);

    /* A descriptor, the line's, that is readable while a message can be received, or
     * something else is due, which `receive` does first; -1: there is none to be had.
     * [owner] */
    int (*descriptor)(struct proto_direct_inbox *line);

    /* Of a mesh of the client's, committed and in no step yet, once: which features are
     * its own and which are foreign, as in the engine's mesh.h; for libpccd-mpi. Returns
     * 0, PCCD_E_HANDLE, PCCD_E_STATE, PCCD_E_NOMEM or PCCD_E_DISCONNECTED. [owner] */
    int (*own)(struct proto_direct_inbox *line, uint32_t mesh, const uint64_t *vertices,
               const uint64_t *edges);

    /* For libpccd-mpi, too: while a message of the client's is handled, is_stopped(asked)
     * is asked every few microseconds by the thread that brought it; true ends what is
     * computed, as a cancel does. NULL: nobody is asked. [owner] */
    void (*watch)(struct proto_direct_inbox *line, bool (*is_stopped)(void *asked),
                  void *asked);

    /* In the same way contacts and pairs come to a page of an answer to a step by
     * write(writer, to, from, count), which is to write as many there, in the place of a
     * copy, by the thread that brought the message. `to` may be written to, by way of
     * this address, until the page is released. The answer has no hash then. NULL: they
     * are copied. [owner] */
    void (*write)(struct proto_direct_inbox *line,
                  void (*write)(void *writer, void *to, const void *from, uint64_t count),
                  void *writer);

    /* From now on steps tell weigh(weigher, pairs, count) of the pairs that they have to
     * decide one by one, and have no records. NULL: they have. [owner] */
    void (*weigh)(struct proto_direct_inbox *line,
                  void (*weigh)(void *weigher, const struct pccd_pair *pairs,
                                uint32_t count),
                  void *weigher);

    /* For libpccd-mpi, too. Of all vertices of an object of the client's scene, which it
     * does not share: where their positions at the end of the next step go, and, unless
     * x0 is NULL, those at its start; then, before any other use of the scene, that they
     * are there, for its next frame.submit, which has no others of the object, or that
     * they will not be. Returns 0, PCCD_E_HANDLE, PCCD_E_NOMEM or PCCD_E_DISCONNECTED.
     * [owner] */
    int (*lend)(struct proto_direct_inbox *line, uint32_t scene, uint32_t object,
                enum proto_direct_lend what, double (**x0)[3], double (**x1)[3]);

    /* For libpccd-mpi, too: while a message of the client's is handled, threads_max is at
     * most `threads`; 0: as it is. [owner] */
    void (*limit)(struct proto_direct_inbox *line, uint32_t threads);

    /* For libpccd-mpi, too: cli_mpi_expect. [owner] */
    void (*expect)(struct proto_direct_inbox *line, uint32_t scene, uint64_t records);

    /* All that the client has is freed, with the last client everything. [owner] */
    void (*close)(struct proto_direct_inbox *line);
};

/* NULL: this library does not have that version of struct proto_direct. */
typedef const struct proto_direct *(*proto_direct_fn)(uint32_t version);

#endif

/* client.h - what the library knows about one connection.
 *
 * Room:     client/lib, private. May include: pccd.h, proto.
 * Does:     struct pccd_client and the small helpers that every file of the room uses.
 * Threads:  [owner]: one thread at a time, the same as for the public functions.
 *
 * Life of a call (one request and its reply), kept in a table of CLI_CALLS:
 *
 *     FREE --send--> SENT --reply, or the end of all patience--> DONE --taken--> FREE
 *                     |
 *                     +--caller gave up--> LOST --reply (its page is released)--> FREE
 *
 * While the connection is lost, those that are SENT or LOST are held: they have no answer
 * and are sent again over the next one (recover.h).
 */
#ifndef CLI_CLIENT_H
#define CLI_CLIENT_H

#include <stdbool.h>
#include <stdint.h>

#include "codec.h"
#include "direct.h"
#include "memfd.h"
#include "messages.h"
#include "pccd.h"
#include "proto_limits.h"
#include "seqpacket.h"
#include "shm.h"

#define CLI_CALLS      64u  /* requests in flight, or with answers that are not taken */
#define CLI_STEPS      32u  /* of these, steps */
#define CLI_PAGES      256u /* pages of records that are not released */
#define CLI_TEXT_BYTES 512u
/* Daemons that may end over one request. Fewer than `pccdd --supervise` bears within ten
 * seconds: a request that ends every daemon must not take it from the other clients. */
#define CLI_DAEMONS_MAX  4u
#define CLI_SLOT_NONE    UINT32_MAX
#define CLI_SOCKET_BYTES 108u /* of sockaddr_un.sun_path */
#define CLI_NAME_BYTES   64u  /* of the client, for the daemon's log */

#define CLI_MEMBER(ID, name, since, flags, text) struct proto_##ID##_request ID;
union cli_params {
    PROTO_METHODS(CLI_MEMBER)
};
#undef CLI_MEMBER

enum cli_call_state { CLI_CALL_FREE = 0, CLI_CALL_SENT, CLI_CALL_DONE, CLI_CALL_LOST };

struct cli_call {
    enum cli_call_state state;
    int method;      /* enum proto_method */
    bool held;       /* SENT, LOST: over a connection that is lost */
    bool waits;      /* for another client's step (scene.held) */
    bool recovery;   /* sent by recover.c itself, which starts over when it fails */
    uint32_t id;     /* of the message */
    uint32_t slot;   /* that comes back with the reply, or CLI_SLOT_NONE */
    uint64_t serial; /* in the order of their sending */
    uint32_t daemons_ended; /* that had it first of all */
    uint64_t step;          /* 0: not a step */
    union cli_params params;
    void *result;  /* where the reply is decoded to; NULL: `answer`, or nowhere */
    int status;    /* DONE: 0 or why it failed, then `text` says more */
    uint64_t page; /* DONE: serial of the page of records, 0: none */
    struct proto_FRAME_SUBMIT_result answer;   /* of frame.submit and frame.fetch */
    struct proto_SCENE_JOURNAL_result journal; /* of scene.journal */
    char text[CLI_TEXT_BYTES];
};

/* KEPT: answered, and the only place where the last positions of an object are. */
enum cli_slot_state { CLI_SLOT_FREE = 0, CLI_SLOT_BEGUN, CLI_SLOT_SENT, CLI_SLOT_KEPT };

struct cli_slot {
    enum cli_slot_state state;
    uint64_t seq;                   /* last value stored in the slot's descriptor */
    uint32_t scene;                 /* BEGUN: of the frame being written */
    uint32_t segment_max;           /* announced */
    uint32_t segment_count;         /* written */
    uint64_t used_bytes;            /* segment table included */
    uint64_t limit_bytes;           /* announced */
    uint64_t step;                  /* KEPT: that brought it */
    struct proto_segment *segments; /* a copy of the table */
    uint32_t segment_room;          /* of the copy */
};

/* One page of the result region. Pages go back to the daemon in the order they came. */
struct cli_page {
    uint64_t release;    /* result_head that gives it back */
    const uint8_t *base; /* of the region that it lies in */
    bool released;
};

/* The result region of a daemon that is gone, in which the user still reads. */
struct cli_retired {
    struct cli_retired *next;
    struct proto_memory result;
    uint64_t page_end; /* goes when all pages before this serial are released */
};

struct cli_ring {
    struct proto_memory upload; /* base NULL: not attached */
    struct proto_memory result;
    uint32_t slot_count;
    uint64_t slot_stride;
    uint32_t inflight_max;
    uint64_t page_first; /* serial of its first page */
    struct cli_slot slots[PROTO_SLOTS_MAX];
};

/* A daemon of our own. */
struct cli_child {
    pid_t pid;                        /* 0: none */
    char directory[CLI_SOCKET_BYTES]; /* of its socket, removed at close; "": none */
};

enum cli_way { CLI_WAY_URL = 0, CLI_WAY_USER, CLI_WAY_PRIVATE, CLI_WAY_DIRECT };

/* How the daemon is reached, and reached again. */
struct cli_link {
    enum cli_way way;
    bool no_autostart;
    char path[CLI_SOCKET_BYTES]; /* of its socket */
    char name[CLI_NAME_BYTES];
    char *daemon;           /* program; NULL: the default */
    uint64_t patience_ns;   /* from the loss; 0: the loss is an error at once */
    uint32_t daemons_max;   /* that may end over one request */
    uint64_t told_anew;     /* daemons that have been told of all that is kept */
    uint32_t uploads_ended; /* daemons, over the mesh that is being registered */
    bool can_restore;       /* another daemon may be told what is kept */
    bool is_established;    /* pccd_connect has succeeded */
    bool is_down;           /* the connection is lost and not made again yet */
    bool is_recovering;     /* recover.c is at work */
    uint64_t lost_ns;
    uint64_t retry_ns; /* not before */
    uint64_t pause_ns; /* after the next failure */
    uint32_t tries;    /* since the loss */
    uint64_t features; /* of the daemon */
    uint64_t epoch;
    uint64_t session;
    uint64_t token[2];
    struct pccd_link_info info;
};

struct pccd_client {
    int socket;
    struct cli_link link;
    bool keeps;    /* what it registers, for another daemon (keep.h) */
    bool has_made; /* a scene or a mesh, kept or not */
    struct cli_kept_scene *kept_scenes;
    struct cli_kept_mesh *kept_meshes;
    struct cli_recorder *recorder; /* NULL: nothing is recorded (recorder.h) */
    uint32_t want;                 /* handle of what is made next; 0: any */
    struct cli_retired *retired;   /* oldest first */
    struct cli_shared *shared;     /* by scene; NULL: nothing was heard (shared.h) */
    pid_t owner; /* process that connected; a forked copy must not stop the daemon */
    uint32_t pid, forks; /* of the daemon; of this process, by then (rpc.h) */
    char cpu[PROTO_STR_MAX + 1];
    char daemon[PROTO_STR_MAX + 1]; /* its name and release */
    uint32_t version, threads_max;  /* of the protocol; of a step */
    uint64_t session;               /* number */
    struct cli_watch *watch;        /* NULL: it does not watch (watch.c) */
    bool slots_chosen;              /* the user set slot_count: never take fewer */
    bool dead;
    int goaway; /* status of the daemon's last words, 0: none */
    int timeout_ms;
    uint32_t spin_us;
    uint32_t slot_count;   /* wanted */
    uint64_t slot_bytes;   /* wanted at least; 0: grown to what is needed */
    uint64_t result_bytes; /* wanted */
    uint32_t next_id;
    uint64_t next_serial, next_step;
    bool is_attaching;      /* the answer that is waited for brings descriptors */
    bool has_sent;          /* and not looked for answers since */
    int fds[PROTO_FDS_MAX]; /* that came with the answer to shm.attach; -1: none */
    struct cli_child child;
    struct cli_ring ring;
    struct cli_call calls[CLI_CALLS];
    uint32_t calls_end; /* of those that have ever been used; others are not looked at */
    struct cli_page pages[CLI_PAGES]; /* a ring: serial modulo CLI_PAGES */
    uint64_t page_first, page_end; /* serials of the oldest unreleased page, the next */
    struct cli_direct direct;      /* in the place of the socket */
    char url[CLI_SOCKET_BYTES + 8];
    char dead_text[CLI_TEXT_BYTES];
    char error[CLI_TEXT_BYTES];
    struct proto_decoder *decoder;
    struct proto_encoder encoder;
    uint8_t message[PROTO_MESSAGE_BYTES_MAX];
};

/* Set the text of pccd_error_text (of NULL: the thread's) and return `status`. */
int cli_fail(struct pccd_client *client, int status, const char *format, ...)
    __attribute__((format(printf, 3, 4)));

/* CLOCK_MONOTONIC, nanoseconds. [any] */
uint64_t cli_now_ns(void);

/* When a wait of timeout_ms (< 0: the client's default) that begins now ends. */
uint64_t cli_deadline(const struct pccd_client *client, int timeout_ms);

#endif

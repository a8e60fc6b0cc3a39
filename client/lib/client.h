/* client.h - struct pccd_client: everything that the library knows about one connection.
 *
 * Threads: [owner]: one thread at a time, the same as for the public functions.
 */
#ifndef CLI_CLIENT_H
#define CLI_CLIENT_H

#include <pthread.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "clock.h"
#include "codec.h"
#include "messages.h"
#include "pccd.h"
#include "registry.h"
#include "ring.h"
#include "seqpacket.h"

/* Daemons that may end over one request. Fewer than `pccdd --supervise` bears within ten
 * seconds: a request that ends every daemon must not take it from the other clients. */
#define CLI_DAEMONS_MAX  4u
#define CLI_AWAIT_NS     1000000000u /* whole seconds; a nearer deadline is polled for */
#define CLI_PAUSE_NS     1000000u    /* from a loss to the second try */
#define CLI_SOCKET_BYTES 108u        /* of sockaddr_un.sun_path */
#define CLI_NAME_BYTES   64u         /* of the client, for the daemon's log */

/* ---- calls ------------------------------------------------------------------------- */

/* Life of a call (one request and its reply), kept in a table of CLI_CALLS:
 *
 *     FREE --send--> SENT --reply, or the end of all patience--> DONE --taken--> FREE
 *                     |
 *                     +--caller gave up--> LOST --reply (its page is released)--> FREE
 *
 * While the connection is lost, those that are SENT or LOST are held: they have no answer
 * and are sent again over the next one (recover.c).
 */
#define CLI_CALLS      64u /* requests in flight, or with answers that are not taken */
#define CLI_STEPS      32u /* of these, steps */
#define CLI_TEXT_BYTES 512u

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
    uint64_t step;          /* 0: neither a step nor scene.near; a batch: its first */
    union cli_params params;
    void *result;  /* where the reply is decoded to; NULL: `answer`, or nowhere */
    int status;    /* DONE: 0 or why it failed, then `text` says more */
    uint64_t page; /* DONE: serial of the page of records, 0: none */
    union {
        struct proto_answer answer; /* of a step, scene.near and both fetches */
        struct proto_BATCH_SUBMIT_result batch;
    };
    struct proto_SCENE_JOURNAL_result journal; /* of scene.journal */
    char text[CLI_TEXT_BYTES];
};

/* Return whether its answer has not come. */
static inline bool cli_call_is_sent(const struct cli_call *call)
{
    return call->state == CLI_CALL_SENT || call->state == CLI_CALL_LOST;
}

/* ---- the client -------------------------------------------------------------------- */

/* A daemon of our own. */
struct cli_child {
    pid_t pid;                        /* 0: none */
    char directory[CLI_SOCKET_BYTES]; /* of its socket, removed at close; "": none */
};

struct pccd_batch;
struct proto_direct;
struct proto_direct_inbox;

enum cli_way { CLI_WAY_URL = 0, CLI_WAY_USER, CLI_WAY_PRIVATE, CLI_WAY_DIRECT };

/* The way to the daemon, at first and again. */
struct cli_link {
    enum cli_way way;
    bool no_autostart;
    char path[CLI_SOCKET_BYTES]; /* of its socket */
    char name[CLI_NAME_BYTES];
    char *daemon;           /* program; NULL: the default */
    uint64_t patience_ns;   /* from the loss; 0: the loss is an error at once */
    uint32_t daemons_max;   /* that may end over one request */
    bool observes;          /* hello says so */
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

/* In the place of a socket: the service in this process (connection.h). */
struct cli_direct {
    const struct proto_direct *host;
    struct proto_direct_inbox *line; /* NULL: not open */
};

/* Functions of the top of the library that its bottom calls; nothing below includes the
 * top. */
struct cli_callbacks {
    /* The connection is lost: as cli_recover (link.h). */
    int (*recover)(struct pccd_client *client, uint64_t deadline_ns);
    /* A call is answered, or has failed; nobody has taken the answer yet. */
    void (*answered)(struct pccd_client *client, struct cli_call *call);
    /* The daemon tells something that nobody has asked for. */
    void (*notified)(struct pccd_client *client, const struct proto_envelope *envelope);
};

struct pccd_client {
    const struct cli_callbacks *callbacks;
    pthread_mutex_t turn;       /* recursive; of the thread that is in a call */
    uint32_t depth;             /* of its calls, each in the one before */
    struct pccd_batch *batches; /* that are not destroyed (batch.c) */
    int socket;
    struct cli_link link;
    bool keeps;                    /* what it registers, for another daemon (replica.h) */
    bool has_made;                 /* a scene or a mesh, kept or not */
    struct registry registry;      /* of what it has told the daemon */
    struct cli_recorder *recorder; /* NULL: nothing is recorded (recorder.h) */
    uint32_t want;                 /* handle of what is made next; 0: any */
    struct cli_retired *retired;   /* oldest first */
    struct cli_shared *shared;     /* by scene; NULL: nothing was heard (events.h) */
    uint32_t shared_room;          /* entries of it */
    struct registry_map nears;     /* replica.h */
    struct cli_user_data *user_data; /* user_data.c; NULL: none was given */
    pid_t owner; /* process that connected; a forked copy must not stop the daemon */
    uint32_t pid, forks; /* of the daemon; of this process, by then (rpc.h) */
    char cpu[PROTO_STR_MAX + 1];
    char daemon[PROTO_STR_MAX + 1]; /* its name and release */
    uint32_t version, threads_max;  /* of the protocol; of a step */
    uint64_t session;               /* number */
    struct cli_watch *watch;        /* NULL: it does not watch (events.c) */
    bool slots_chosen;              /* the user set slot_count: never take fewer */
    bool dead;
    int goaway; /* status of the daemon's last words, 0: none */
    int timeout_ms;
    uint32_t spin_us;
    uint32_t spins_in_vain;   /* the last ones, in a row */
    uint32_t waits_unspun;    /* that are still to go without */
    uint32_t slot_count;      /* wanted */
    uint64_t slot_bytes;      /* wanted at least; 0: grown to what is needed */
    uint64_t result_bytes;    /* wanted */
    struct proto_unmap unmap; /* of the user; call NULL: the library unmaps */
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

/* Note the number of an object, 0: none any more; forget those of a scene; or all
 * (user_data.c). PCCD_E_NOMEM, and says so. */
int cli_user_data_note(struct pccd_client *client, uint32_t scene, uint32_t object,
                       uint64_t user_data);
void cli_user_data_forget(struct pccd_client *client, uint32_t scene);
void cli_user_data_deinit(struct pccd_client *client);

/* Set the text of pccd_error_text (of NULL: the thread's) and return `status`. */
int cli_fail(struct pccd_client *client, int status, const char *format, ...)
    __attribute__((format(printf, 3, 4)));

/* ---- whose turn it is -------------------------------------------------------------- */

/* A call of the thread that makes it, until cli_leave. */
struct cli_turn {
    struct pccd_client *client; /* NULL: there is nothing to leave */
    int status;
};
/* Enter a call: PCCD_E_INVAL without a client; PCCD_E_BUSY while another thread is in a
 * call with it. A thread that is in a call may enter another one. [any] */
struct cli_turn cli_enter(struct pccd_client *client);
/* Enter a call that has no status: wait until the other thread is out. */
struct cli_turn cli_enter_late(struct pccd_client *client);
void cli_leave(struct cli_turn *turn);

/* Begins every public function with a client; it is left by itself at the end. */
#define CLI_TURN __attribute__((cleanup(cli_leave), unused)) struct cli_turn
#define CLI_ENTER_OR_RETURN(client)                                                      \
    CLI_TURN cli_turn = cli_enter(client);                                               \
    if (cli_turn.status != 0) {                                                          \
        return cli_turn.status;                                                          \
    }

/* Make the lock of cli_enter. Returns 0 or PCCD_E_NOMEM. */
int cli_turn_init(struct pccd_client *client);
void cli_turn_deinit(struct pccd_client *client);

/* ---- helpers ----------------------------------------------------------------------- */

/* Return when a wait of timeout_ms (< 0: the client's default) that begins now ends. */
uint64_t cli_deadline(const struct pccd_client *client, int timeout_ms);

/* Return how often this process is a copy of a copy, from the first call on. [any] */
uint32_t cli_forks(void);
/* Return whether it was forked since the client connected: the socket and the ring are
 * those of the process that did, and must not be touched. Costs no system call. */
bool cli_is_copy(const struct pccd_client *client);

/* Take the handle that pccd_request_handle has asked for, once. */
uint32_t cli_take_handle(struct pccd_client *client);

/* ---- structs of other releases ----------------------------------------------------- */

struct pccd_client;

/* Copy `asked` to `known`, which has known_bytes. Members that only a later release has
 * must be 0. E_INVAL with a text that begins with `name`. */
int cli_struct_read(struct pccd_client *client, const char *name, const void *asked,
                    void *known, size_t known_bytes);

/* Check that a struct of a program may be filled in, as its struct_bytes says. E_INVAL if
 * not. */
int cli_struct_check(struct pccd_client *client, const char *name, const void *to,
                     size_t known_bytes);

/* Copy `known` to `to`, whose struct_bytes was checked and stays; what it has beyond
 * known_bytes becomes 0. */
void cli_struct_fill(void *to, const void *known, size_t known_bytes);

#endif

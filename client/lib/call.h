/* call.h - a request that was sent, until its answer is taken.
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
#ifndef CLI_CALL_H
#define CLI_CALL_H

#include <stdbool.h>
#include <stdint.h>

#include "messages.h"
#include "pccd.h"

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

#endif

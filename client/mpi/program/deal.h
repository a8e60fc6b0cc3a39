/* deal.h - deals the items of a long work out to the ranks, on demand.
 *
 * Threads: work->take runs in the main thread of the root, which alone calls MPI;
 * work->compute in its second thread, in the only one elsewhere. work->is_done runs in
 * both of the root, never while it or work->take runs in the other.
 *
 * An item is whatever one rank does by itself and has a number, such as a step of a
 * recording. Each rank gets some numbers, all higher than those before, and asks for more
 * before it has done them: of 100 items for two ranks 12 each, then fewer and fewer, in
 * the end one. So nobody waits for long, whatever an item takes.
 */
#ifndef PROGRAM_DEAL_H
#define PROGRAM_DEAL_H

#include <mpi.h>
#include <pthread.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "error.h"

#define DEAL_NONE         UINT64_MAX
#define DEAL_RESULT_BYTES 1024u /* of a result, at most */

struct deal;

struct deal_work {
    uint64_t count;      /* of items, from 0; the same on every rank */
    size_t result_bytes; /* of a result, which has no pointers */
    void *context;
    /* Root: whether an item need not be dealt: it is done already, or not wanted. */
    bool (*is_done)(void *context, uint64_t item);
    /* Root: a result has come. With *is_last no item above it is dealt any more. Errors
     * end the work. */
    int (*take)(void *context, uint64_t item, const void *result, bool *is_last,
                struct ctl_error *error);
    /* Every rank: deal_next and deal_put until DEAL_NONE. Errors end the work. */
    void *compute_context;
    int (*compute)(void *context, struct deal *deal, struct ctl_error *error);
    /* Root: SIGINT or SIGTERM has come, as when another rank has died; say how far the
     * work was. The program ends then, with all ranks. */
    void (*interrupted)(void *context);
};

/* Collective. Do all of `work`. Returns the same on every rank: PCCD_OK, or the error of
 * the lowest rank that had one, whose text begins with "rank N: ". */
int deal(const struct deal_work *work, struct ctl_error *error);

/* Return the next item to do, or DEAL_NONE, in `compute`. */
uint64_t deal_next(struct deal *deal);
/* Tell the result of an item, of result_bytes, in `compute`. */
void deal_put(struct deal *deal, uint64_t item, const void *result);

/* ---- What the root and the other ranks have in common when items are dealt. */

#define DEAL_HAND 64u /* items that a rank gets at once, at most */

enum deal_tag { DEAL_TAG_TELL = 1, DEAL_TAG_HAND };

enum deal_word {
    DEAL_ASK,    /* give me items */
    DEAL_RESULT, /* here is the result of one */
    DEAL_END     /* I shall not ask again: done, or an error */
};

/* A rank tells the root. */
struct deal_tell {
    uint32_t word; /* enum deal_word */
    int32_t status;
    uint64_t item;
    union {
        unsigned char result[DEAL_RESULT_BYTES];
        struct ctl_error error;
    } with;
};

/* The root answers who asks. */
struct deal_hand {
    uint64_t count; /* 0: nothing is left */
    uint64_t items[DEAL_HAND];
};

#define DEAL_SENT (DEAL_HAND + 2u) /* all that a rank tells while it does what it has */

/* Message that a rank has sent, until MPI has it. */
struct deal_sent {
    struct deal_tell tell;
    MPI_Request request; /* MPI_REQUEST_NULL: it has */
};

/* Message of the second thread of the root, until the first one takes it. */
struct deal_note {
    struct deal_note *next;
    struct deal_tell tell;
};

struct dealer; /* what is left to deal, deal_root.c */

struct deal {
    const struct deal_work *work;
    struct deal_hand hand; /* items that this rank has not begun, from `used` on */
    uint64_t used;
    bool is_over; /* there are no more */
    /* Others than the root: the items that come next, and what has gone. */
    bool is_asked; /* they are on their way */
    struct deal_hand coming;
    MPI_Request request;
    struct deal_sent sent[DEAL_SENT];
    uint32_t next_sent; /* the place that was used longest ago */
    /* The root: between its two threads. */
    pthread_mutex_t lock;
    pthread_cond_t told;
    struct deal_note *first, **last;
    struct dealer *dealer;
};

/* Tell the root, from any rank, without waiting until it looks. Out of memory in the
 * root's thread ends the program. */
void deal_tell(struct deal *deal, const struct deal_tell *tell);

/* Deal, on the root, until all ranks have ended, while `compute` runs in a thread. */
int deal_root(struct deal *deal, struct ctl_error *error);
/* Tell the first thread of the root, from the one that computes. */
void deal_root_tell(struct deal *deal, const struct deal_tell *tell);
/* Take the next items, from the same, at once. */
void deal_root_take(struct deal *deal, struct deal_hand *hand);

#endif

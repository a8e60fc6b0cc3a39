/* deal_inside.h - what the root and the other ranks have in common when items are dealt.
 *
 * Threads: as deal.h says.
 */
#ifndef PROGRAM_DEAL_INSIDE_H
#define PROGRAM_DEAL_INSIDE_H

#include <mpi.h>
#include <pthread.h>

#include "deal.h"

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

/* What a rank has told, until MPI has it. */
struct deal_sent {
    struct deal_tell tell;
    MPI_Request request; /* MPI_REQUEST_NULL: it has */
};

/* What the second thread of the root has told, until the first one takes it. */
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

/* The root: deal until all ranks have ended, while `compute` runs in a thread. */
int deal_root(struct deal *deal, struct ctl_error *error);
/* Called by that thread: tell the first one; take the next items, at once. */
void deal_root_tell(struct deal *deal, const struct deal_tell *tell);
void deal_root_take(struct deal *deal, struct deal_hand *hand);

#endif

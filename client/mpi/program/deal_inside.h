/* deal_inside.h - what the root and the other ranks have in common when items are dealt.
 *
 * Room:     client/mpi/program. May include: deal.h.
 * Does:     define the messages; the root's side is deal_root.c, the others'
 *           deal_rank.c.
 * Threads:  as deal.h says.
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

/* What the second thread of the root has told, until the first one takes it. */
struct deal_note {
    struct deal_note *next;
    struct deal_tell tell;
};

struct deal {
    const struct deal_work *work;
    struct deal_hand hand; /* items that this rank has not begun, from `used` on */
    uint64_t used;
    bool is_asked, is_over; /* more items are on their way; there are none */
    /* Others than the root: where these come. */
    struct deal_hand coming;
    MPI_Request request;
    /* The root: between its two threads. */
    pthread_mutex_t lock;
    pthread_cond_t told, dealt;
    struct deal_note *first, **last;
    bool has_dealt; /* `coming` has an answer */
};

/* Tell the root, from any rank. Out of memory in the root's thread ends the program. */
void deal_tell(struct deal *deal, const struct deal_tell *tell);

/* The root: deal until all ranks have ended, while `compute` runs in a thread. */
int deal_root(struct deal *deal, struct ctl_error *error);
/* Called by that thread. */
void deal_root_tell(struct deal *deal, const struct deal_tell *tell);
void deal_root_wait(struct deal *deal);

#endif

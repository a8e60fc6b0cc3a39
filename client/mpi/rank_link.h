/* rank_link.h - what ranks say to each other, with a bound on the time.
 *
 * Nothing here blocks in MPI: whoever waits looks at the clock and lets others run, so
 * that ranks may outnumber processors. After the timeout, or an error of MPI, the link is
 * broken for good: messages may still be under way into memory that nobody frees then.
 */
#ifndef RANKS_RANK_LINK_H
#define RANKS_RANK_LINK_H

#include <mpi.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "pccd_types.h"

#define RANKS_TEXT_BYTES 512

struct ranks_link {
    MPI_Comm comm;
    int rank, size;
    int timeout_ms;
    int broken; /* 0, or the status of every later call */
    uint64_t sent_bytes;
    uint64_t calls; /* collective ones so far */
    /* Called again and again while this rank waits for others; must not wait. NULL: there
     * is nothing else to do. */
    void (*meanwhile)(void *context);
    void *context;
    char text[RANKS_TEXT_BYTES];
};

/* Set the sentence about what went wrong in this rank. Returns `status`. */
int ranks_fail(struct ranks_link *link, int status, const char *format, ...)
    __attribute__((format(printf, 3, 4)));
/* Fail with PCCD_E_INVAL, which is returned: an argument of this rank, `what`, that must
 * be given is NULL. */
int ranks_missing(struct ranks_link *link, const char *what);

/* Set the error to "out of memory". Returns PCCD_E_NOMEM. */
int ranks_link_no_memory(struct ranks_link *link);

/* Calls, each done in the whole by all ranks; their names are for the message of one that
 * is out of order. */
enum ranks_call {
    RANKS_OPEN,
    RANKS_MESH_PUT,
    RANKS_MESH_DESTROY,
    RANKS_ADD,
    RANKS_REMOVE,
    RANKS_OBJECT_SET,
    RANKS_PAIR_IGNORE,
    RANKS_STEP,
    RANKS_NEAR,
    RANKS_GATHER,
    RANKS_GET_SHARE,
    RANKS_INSIDE /* a point within a call */
};

/* Agree on how all ranks stand; `arguments` is a hash of what must be the same. Returns
 * on every rank the status of the lowest rank that has one, with its text; E_STATE if
 * ranks called different things, E_INVAL if their arguments differ. */
int ranks_agree(struct ranks_link *link, enum ranks_call call, uint64_t arguments,
                int status);
/* Agree on `status` in the middle of a call, as ranks_agree does. */
int ranks_agree_on(struct ranks_link *link, int status);

/* Tell one number of each rank to all: all[r] is that of rank r. */
int ranks_tell_all(struct ranks_link *link, uint64_t mine, uint64_t *all);
/* Replace count numbers by their sums, or the largest or least ones, over all ranks. */
int ranks_sum(struct ranks_link *link, uint64_t *numbers, int count);
int ranks_max_bytes(struct ranks_link *link, uint8_t *bytes, int count);
int ranks_min_doubles(struct ranks_link *link, double *numbers, int count);
int ranks_max_doubles(struct ranks_link *link, double *numbers, int count);

/* Send out[first_out[r]] to out[first_out[r + 1] - 1] to rank r, items of item_bytes, and
 * get what the others have for this rank, one rank after the other. The sizes are known
 * on both sides; own items are copied. */
int ranks_swap(struct ranks_link *link, size_t item_bytes, const void *out,
               const uint64_t *first_out, void *in, const uint64_t *first_in);
/* Send as ranks_swap does, but what comes from rank r goes to in[r], and nothing is
 * copied of what this rank has for itself. */
int ranks_swap_into(struct ranks_link *link, size_t item_bytes, const void *out,
                    const uint64_t *first_out, void *const *in, const uint64_t *first_in);
/* Send as ranks_swap does where the receiver does not know how much: *in is allocated,
 * first_in[size + 1] written. */
int ranks_deal(struct ranks_link *link, size_t item_bytes, const void *out,
               const uint64_t *first_out, void **in, uint64_t *first_in);
/* Question to other ranks about each of some items. */
struct ranks_question {
    size_t item_bytes, answer_bytes;
    /* Answer all items that came to this rank. Every rank calls it once, so that it may
     * be collective. */
    int (*answer)(void *context, const void *items, uint64_t count, void *answers);
    void *context;
};
/* Ask as ranks_deal sends. Answers come in the order of the items. */
int ranks_ask(struct ranks_link *link, const struct ranks_question *question,
              const void *items, const uint64_t *first, void *answers);

/* Items that are to go to other ranks, each to one. */
struct ranks_post {
    size_t item_bytes;
    void *items;
    uint32_t *to;
    uint64_t count, room;
    bool is_lost; /* this rank had no memory: ranks_post_deal says so to all */
};
/* Begin a post, in this rank alone, with room for so many; it grows where there are
 * more. */
void ranks_post_begin(struct ranks_post *post, size_t item_bytes, uint64_t room);
/* Make room, in this rank alone, for one more item, for rank `to`, and return where it
 * is. NULL: no memory. */
void *ranks_post_room(struct ranks_post *post, uint32_t to);
/* Add a copy of an item for rank `to`, in this rank alone. */
void ranks_post_add(struct ranks_post *post, uint32_t to, const void *item);
/* Send all; what comes is in the order of the ranks and of their items. *in is allocated,
 * what the post held is freed. */
int ranks_post_deal(struct ranks_link *link, struct ranks_post *post, void **in,
                    uint64_t *in_count);
/* Spread `count` items of each rank to all; otherwise as ranks_deal. */
int ranks_spread(struct ranks_link *link, size_t item_bytes, const void *mine,
                 uint64_t count, void **all, uint64_t *first);

/* Wait for messages to or from one rank, until the timeout. Returns the link's status. */
int ranks_wait(struct ranks_link *link, MPI_Request *requests, int count);
/* Break the link if `code`, from MPI, is an error, with a text that says `what` was done.
 * Returns the link's status. */
int ranks_mpi(struct ranks_link *link, int code, const char *what);

/* Allocate count items, never 0 bytes, to be freed by free. NULL: no memory. */
void *ranks_array(uint64_t count, size_t item_bytes);

#endif

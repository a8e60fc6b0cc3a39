/* deal.h - deals the items of a long work out to the ranks, on demand.
 *
 * Threads: the main thread of the root deals, and alone calls MPI; work->compute runs in
 * its second thread, in the only one elsewhere. work->take runs in either of the root's,
 * never in both at once.
 *
 * An item is whatever one rank does by itself and has a number, such as a step of a
 * recording. Each rank gets some numbers, all higher than those before, and asks for more
 * before it has done them: of 100 items for two ranks 12 each, then fewer and fewer, in
 * the end one. So nobody waits for long, whatever an item takes.
 */
#ifndef PROGRAM_DEAL_H
#define PROGRAM_DEAL_H

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
    /* Root: a result has come. With *is_last no item above it is dealt any more. Errors
     * end the work. */
    int (*take)(void *context, uint64_t item, const void *result, bool *is_last,
                struct ctl_error *error);
    /* Every rank: deal_next and deal_put until DEAL_NONE. Errors end the work. */
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

#endif

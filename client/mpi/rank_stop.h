/* rank_stop.h - ends a step or a question on all ranks before it is done.
 *
 * Threads: one, but for ranks_stop_cancel.
 *
 * Who says "stop" sends an empty message to each other rank, once in a call at most. The
 * others look for one while they compute, and while they wait for those who do: between
 * ranks_stop_open and ranks_stop_close, with an agreement of all ranks in between
 * (ranks_agree_on). So a rank that has computed its part can still say it. Afterwards
 * nobody does, the ranks add up how many have, and each takes what it has not seen: no
 * message is left for the next call.
 */
#ifndef RANKS_RANK_STOP_H
#define RANKS_RANK_STOP_H

#include <stdatomic.h>

#include "rank_link.h"

struct ranks_stop {
    struct ranks_link *link;
    atomic_bool is_cancelled; /* since the call began */
    uint64_t end_ns;          /* of the deadline; 0: none */
    bool is_open;
    bool is_set;           /* this rank ends the call: it was cancelled, or told to */
    uint64_t said;         /* 1: it has told the others */
    uint64_t heard;        /* messages of others, in this call */
    uint64_t next_ns;      /* when to look for one */
    uint32_t asked;        /* how often it was, by libpccd */
    MPI_Request *requests; /* [2 * link->size] */
    int request_count;     /* of messages that are being sent */
};

/* Make what ends calls of this link. PCCD_E_NOMEM. */
int ranks_stop_init(struct ranks_stop *stop, struct ranks_link *link);
void ranks_stop_deinit(struct ranks_stop *stop);

/* End the call that this rank is in, if any; not one that begins later. Any thread. */
void ranks_stop_cancel(struct ranks_stop *stop);

/* Begin a call that may be ended, in this rank alone. */
void ranks_stop_begin(struct ranks_stop *stop);
/* Give the call deadline_ns from now, when all ranks have come, in this rank alone. 0:
 * for ever. */
void ranks_stop_limit(struct ranks_stop *stop, uint64_t deadline_ns);

/* Return why the call is to end, PCCD_COMPLETE if it is not, in this rank alone. The
 * greatest of all ranks is that of all. */
enum pccd_incomplete ranks_stop_reason(struct ranks_stop *stop);
/* Collective. Agree on *reason: the greatest of all ranks. */
int ranks_stop_agree(struct ranks_stop *stop, enum pccd_incomplete *reason);
/* Return what is left of the time that the call has, in ns, 1 at least; 0: it has no
 * end. */
uint64_t ranks_stop_rest(const struct ranks_stop *stop);

/* Look for messages of others, in this rank alone, until it is closed: libpccd computes
 * from here on. All ranks do so. */
void ranks_stop_open(struct ranks_stop *stop);
void ranks_stop_close(struct ranks_stop *stop);
/* Return whether the call is to end, for cli_mpi_watch. asked: struct ranks_stop. Cheap:
 * it looks for messages a thousand times a second at most. */
bool ranks_stop_look(void *asked);
/* Tell the others, while it is open, that they need not go on. */
void ranks_stop_say(struct ranks_stop *stop);

/* Collective. Take what others have sent and this rank has not seen, after it was closed
 * for the last time in a call; `said` is the sum of stop->said of all ranks. The second
 * one adds up itself. */
int ranks_stop_settle(struct ranks_stop *stop, uint64_t said);
int ranks_stop_settle_alone(struct ranks_stop *stop);

#endif

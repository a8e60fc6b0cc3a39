/* actor.h - one client of a run.
 *
 * Room:     client/load. May include: load.h, pace.h, pccd.h.
 * Does:     connect, register its shape, keep some steps in flight, and judge each
 *           answer: is it to a request that waits for one, and what a lone client got?
 * Does not: wait: who has many of them takes turns (crowd.h).
 * Threads:  one process for one actor.
 *
 * What kind a client is follows from its number:
 *   follow  x1 float, mode all: a step starts where the last one has ended, so that one
 *           that is lost, doubled or out of turn makes the next answer wrong
 *   jump    both ends, double; now and then cancelled, due at once, or not finite
 *   rigid   transforms, mode first
 *   pairs   x1 double, mode pairs
 *   churn   like follow; now and then its mesh is replaced, its objects, its scene or
 *           its connection are made anew
 *   share   like follow, one at a time; held for the step of a second client, whose the
 *           floor is (couple.h); now and then the sheet may meet nothing
 */
#ifndef LOAD_ACTOR_H
#define LOAD_ACTOR_H

#include <poll.h>

#include "load.h"
#include "pace.h"
#include "pccd.h"

enum load_kind {
    LOAD_FOLLOW,
    LOAD_JUMP,
    LOAD_RIGID,
    LOAD_PAIRS,
    LOAD_CHURN,
    LOAD_SHARE,
    LOAD_KINDS
};

#define LOAD_KINDS_ALL ((1u << LOAD_KINDS) - 1)

/* What is special about a request. */
enum load_mischief { LOAD_PLAIN, LOAD_CANCELLED, LOAD_DUE, LOAD_NOT_FINITE, LOAD_MASKED };

struct load_pending {
    uint64_t step;
    uint32_t from; /* position; the next one is where it goes */
    enum load_mischief mischief;
    uint64_t due_ns; /* in the open loop: when it should have been submitted */
    uint64_t sent_ns;
};

struct load_actor {
    const struct load *load;
    struct load_tally *tally;
    uint32_t number;
    enum load_kind kind;
    struct load_shape shape;
    bool is_alone;    /* its answers become the truth, and it makes no mischief */
    bool sheet_first; /* it adds the sheet before the floor */
    struct pccd_client *client;
    uint32_t scene, floor_mesh, sheet_mesh, floor, sheet;
    struct pccd_client *second; /* share: whose the floor is; else NULL */
    uint32_t second_scene;
    uint64_t second_step;           /* in flight; 0: none */
    struct pccd_answer held_answer; /* of the first, without records */
    bool is_held_answered;          /* it has come, the second's has not */
    bool is_masked;                 /* the sheet may meet nothing now */
    uint64_t next;                  /* number of the next request */
    uint64_t changed;               /* churn: when it last did */
    uint64_t last_step;
    struct load_pace pace;
    uint64_t stall_until_ns; /* it does nothing before that */
    bool is_blocked;         /* it can submit nothing before an answer has come */
    struct load_pending pending[LOAD_DEPTH_MAX];
    uint32_t pending_count;
    uint64_t moved_ns; /* when something last came of a turn */
};

/* Connect and register; `is_alone`: for the truth, as is who adds the sheet first.
 * Returns 0 or a status, after saying why if `loud`; close it in either case. */
int load_actor_open(struct load_actor *actor, const struct load *load, uint32_t number,
                    struct load_tally *tally, bool is_alone, bool sheet_first, bool loud);

/* What it waits for. */
void load_actor_fds(const struct load_actor *actor, struct pollfd fds[2]);

/* Submit what is due, if `more`, and take what has arrived, if its descriptor is readable
 * or something was submitted. Returns whether anything was. */
bool load_actor_turn(struct load_actor *actor, bool more, bool readable);

/* When it wants a turn even if its descriptor is silent; UINT64_MAX: not at all. */
uint64_t load_actor_wake_ns(const struct load_actor *actor, bool more);

/* Begin anew if an answer has not come for very long. */
void load_actor_check(struct load_actor *actor, uint64_t now_ns);

/* What waits for an answer is lost. */
void load_actor_close(struct load_actor *actor);

#endif

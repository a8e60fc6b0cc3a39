/* actor.h - simulates one client of a load test.
 *
 * Connect, register its shape, keep some steps in flight, and check each answer: does it
 * belong to a request that waits, and is it what a lone client got?
 *
 * Threads: one process for one actor.
 */
#ifndef LOAD_ACTOR_H
#define LOAD_ACTOR_H

#include <poll.h>

#include "load.h"
#include "pccd.h"

/* ---- When a client sends its next request.
 *
 * In the open loop, follow a plan that does not depend on answers: clients join one by
 * one, spread over the period, and send at even or at random intervals. In the closed
 * loop, send when the client has paused after its answer. */

struct load_pace {
    uint32_t client;
    uint64_t count;  /* of requests planned */
    uint64_t due_ns; /* of the next one; 0: the load has not begun */
};

/* Return when the warm-up ends: nobody measures requests that are due before. */
uint64_t load_measured_from_ns(const struct load *load);

/* Plan the first request, when the load has begun. */
void load_pace_begin(struct load_pace *pace, const struct load *load, uint32_t client);

/* Plan the next one, as a request has been submitted at now_ns. */
void load_pace_next(struct load_pace *pace, const struct load *load, uint64_t now_ns);

/* Return how long its client stops before it takes the answer to the last request; mostly
 * 0. */
uint64_t load_pace_stall_ns(const struct load_pace *pace, const struct load *load);

/* ---- State: the connection, the shape, and the steps that wait. */

/* The kind of a client follows from its number. */
enum load_kind {
    LOAD_FOLLOW,
    LOAD_JUMP,
    LOAD_RIGID,
    LOAD_PAIRS,
    LOAD_CHURN,
    LOAD_SHARE,
    LOAD_BATCH,
    LOAD_KINDS
};

/* Whose requests are steps of one scene. */
#define LOAD_KINDS_USUAL ((1u << LOAD_BATCH) - 1)

/* The kinds of requests that are special. */
enum load_mischief { LOAD_PLAIN, LOAD_CANCELLED, LOAD_DUE, LOAD_NOT_FINITE, LOAD_MASKED };

struct load_pending {
    uint64_t step;
    uint32_t from; /* position; the next one is where it goes */
    enum load_mischief mischief;
    bool is_near;    /* it asks what is near there */
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
    struct pccd_batch *batch;   /* batch: of its scenes; NULL: alone, or another kind */
    void **places;              /* [2][scenes] where it writes positions to */
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

/* Connect and register an actor of which `load`, `tally`, `number`, `is_alone` and
 * `sheet_first` are set, and all else is zero. Return 0 or a status, after saying why if
 * `loud`; close it in either case. */
int load_actor_open(struct load_actor *actor, bool loud);

/* Write the descriptors that it waits for. */
void load_actor_fds(const struct load_actor *actor, struct pollfd fds[2]);

/* Submit what is due, if `more`, and take what has arrived, if its descriptor is readable
 * or something was submitted. Returns whether anything was. */
bool load_actor_turn(struct load_actor *actor, bool more, bool readable);

/* Return when it wants a turn even if its descriptor is silent; UINT64_MAX: not at
 * all. */
uint64_t load_actor_wake_ns(const struct load_actor *actor, bool more);

/* Begin anew if an answer has not come for very long. */
void load_actor_check(struct load_actor *actor, uint64_t now_ns);

/* Close it; what waits for an answer is lost. */
void load_actor_close(struct load_actor *actor);

/* ---- Two simulated clients that share one scene.
 *
 * Let the first client hold the motion of its sheet, and let the second, which owns the
 * floor, step the scene until the first is answered. One answer has the records, the
 * other the numbers of the same step: both are checked as one. */

/* Make the scene, with a name that nothing else has, and let the second client connect
 * and take part in it. Returns 0 or a status. */
int load_couple_open(struct load_actor *actor, const struct pccd_options *options);
/* Wait until both have added what is theirs to the same daemon's scene. Returns 0 or a
 * status. */
int load_couple_settle(struct load_actor *actor);
void load_couple_close(struct load_actor *actor);

/* Let the sheet meet all, or nothing; before its way is written. Returns 0 or a
 * status. */
int load_couple_set(struct load_actor *actor, bool may_meet);
/* Submit the second client's step, after the sheet's way was held. Returns 0 or a
 * status. */
int load_couple_step(struct load_actor *actor);

/* Take everything that has arrived for either. Returns 0 or a status. */
int load_couple_take(struct load_actor *actor, bool *moved);

/* ---- A simulated client that steps many scenes by one request.
 *
 * Give the client further scenes like its first, whose objects have the same handles;
 * step all of them as a batch. Each must be answered as the step of a lone client, who
 * makes no batch. */

/* Make the other scenes, as the first one has its objects, and the batch of all. Returns
 * 0 or a status. */
int load_flock_open(struct load_actor *actor);
void load_flock_close(struct load_actor *actor);

/* Write the positions of all scenes; of mischief only to the last one. The slot is begun
 * then. Returns 0 or a status. */
int load_flock_write(struct load_actor *actor, const struct load_pending *pending);
/* Take everything that has arrived. Returns 0 or a status. */
int load_flock_take(struct load_actor *actor, bool *moved);

/* ---- Whether an answer is the right one. */

/* Judge the answer to a request, which does not wait any more. Of an actor that is alone:
 * note the truth. */
void load_judge(struct load_actor *actor, const struct pccd_answer *answer);

/* Judge the answer to a batch: each scene has the answer of a lone client's step, and
 * counts as a request. */
void load_judge_batch(struct load_actor *actor, const struct pccd_batch_answer *answer);

#endif

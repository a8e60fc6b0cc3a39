/* actor_state.h - the state of one simulated client of pccd-load.
 *
 * Hold the client's connection, its shape and the steps it waits for, for the files that
 * move it (actor.h), couple it with another (couple.h) and check its answers (judge.h).
 *
 * Threads: one process for one actor.
 *
 * The kind of a client follows from its number:
 */
#ifndef LOAD_ACTOR_STATE_H
#define LOAD_ACTOR_STATE_H

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
    LOAD_BATCH,
    LOAD_KINDS
};

/* Whose requests are steps of one scene. */
#define LOAD_KINDS_USUAL ((1u << LOAD_BATCH) - 1)

/* What is special about a request. */
enum load_mischief { LOAD_PLAIN, LOAD_CANCELLED, LOAD_DUE, LOAD_NOT_FINITE, LOAD_MASKED };

struct load_pending {
    uint64_t step;
    uint32_t from; /* position; the next one is where it goes */
    enum load_mischief mischief;
    bool is_near; /* it asks what is near there */
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

#endif

/* request.h - a request that has to be computed, from its message to its answer.
 *
 * The life of a request, from left to right:
 *
 *              pushed                 its work is done
 *     NEW -------------> QUEUED ---------------------------> OWED ----------> OVER
 *      |                  | | |  the thread has answered      ^ |             ^^^^
 *      |                  | | `-------------------------> REPLIED ------------'|||
 *      |                  | |    the socket took no answer    | |              |||
 *      |                  | `---------------------------> TRIED | -------------'||
 *      |                  |      answered before its turn     | |               ||
 *      |                  `-----> EARLY ------ its work is done ----------------'|
 *      | the loop does it                                     | | it waits for   |
 *      v                                                      | v another's step |
 *     BRIEF -------- done at once, the loop answers ----------' WAITING ---------'
 *       `-- longer than that --> MOVED, and then as QUEUED, but not to EARLY
 *
 * A request that is taken back goes from QUEUED, MOVED or EARLY straight to OVER. No
 * other request is answered twice: EARLY and REPLIED have been answered; OWED, TRIED and
 * WAITING are answered by the loop when they are concluded.
 *
 * A step goes from QUEUED to OPEN while it runs. Then whoever is first answers it: its
 * thread, which takes it back to QUEUED before it writes a page; or the loop, which makes
 * it EARLY, where the thread is late with an answer that had to come.
 * A batch is OPEN when its answer is written and some of its scenes still have to move,
 * because it had to end: the loop sends that answer.
 */
#ifndef SRV_REQUEST_H
#define SRV_REQUEST_H

#include <stdatomic.h>

#include "call.h"
#include "deadlines.h"
#include "replies.h"
#include "ringio.h"
#include "srv_scene.h"

struct srv_batch;
struct srv_held_frame;
struct srv_laststep;
struct srv_member;
struct srv_outlet;
struct srv_replacement;
struct srv_request;
struct srv_service;
struct srv_tracing;

/* A scene that a request steps, or asks about. */
struct srv_item {
    struct srv_scene *scene; /* NULL: `status` says why there is none */
    struct srv_member
        *member;       /* with which the session takes part; NULL: it is its own */
    int32_t status;    /* of the table of a batch, then [compute] of the step */
    uint32_t segments; /* of a batch: that are its own, */
    uint32_t first;    /* and where they begin in the table of all */
    uint64_t joints_end; /* [compute] of a batch: where its tables of joints must end */
    bool is_staged;      /* [compute] of a batch: what it moves was read */
    bool has_stepped;  /* [compute] then [loop], as all that follows */
    struct srv_held_frame *taken; /* held frames that went along */
    struct proto_answer
        *answer; /* what others who take part are told; NULL: nobody does */
    struct proto_STEP_request event; /* what those who watch are told of how it went */
};

/* The things that a handler asks for. References are taken for as long as the request
 * lives. */
struct srv_plan {
    /* [compute]; returns 0 with request->result filled in, or with job.goes_on set, to be
     * called again; or a negative status with request->error set. */
    int (*work)(struct srv_request *request);
    /* [loop], may be NULL; after the work, or instead of it when the request was taken
     * back; request->status says how it went. */
    void (*finish)(struct srv_request *request);
    struct srv_ring *ring;   /* NULL: uses none */
    struct srv_shape *shape; /* NULL: uses none */
    struct srv_scene *scene; /* NULL: uses none */
    struct srv_ring
        *attached; /* a ring that is not the session's yet; no reference taken */
    struct srv_ring *replaced;           /* by `attached`; freed after the work, by the
                                          * same thread; NULL: none */
    struct srv_tracing *tracing;         /* a reference is taken */
    struct srv_replacement *replacement; /* given back by `finish`; NULL: none */
    struct srv_batch *batch;             /* given back by `finish`; NULL: none */
    struct srv_claim **claims; /* of these two, of their scenes, which no other */
    uint32_t claim_count;      /* job uses meanwhile; NULL: of `scene` */
    uint64_t mesh_number;      /* of the mesh that `shape` serves */
    uint32_t generation;       /* of that mesh */
    uint32_t object;           /* handle in `scene` */
    struct srv_member
        *member;         /* with which the session takes part in it: leaves it behind
                                * its requests (shared.h); NULL: the scene is its own */
    uint64_t held_bytes; /* charged for a frame that is held (held.h); 0: none */
    bool takes_slot;     /* a slot of the ring, to be returned exactly once */
    bool makes_pages;    /* the work is done on [pages], beside what is computed */
    /* [loop] It still waits for its turn, and its deadline has come or it was cancelled:
     * answer it (srv_request_answer_early), or leave it to its turn. False: ask again a
     * little later. NULL: it is left. */
    bool (*answer_early)(struct srv_request *request, enum pccd_incomplete why);
    /* [loop] while nothing is computed: whether the work is certain to take no longer
     * than some tens of microseconds, or else to set job.goes_on, if it is BRIEF.
     * NULL: it is not. */
    bool (*can_be_brief)(struct srv_request *request);
    /* [loop] It has run: whether it now waits for something other than a thread, until
     * whoever brings that concludes it; and stop that, and answer it. NULL: it does
     * not. */
    bool (*waits)(struct srv_request *request);
    void (*stop_waiting)(struct srv_request *request, enum pccd_incomplete why);
    uint64_t deadline_ns; /* CLOCK_MONOTONIC; 0: none */
    bool replies;         /* the answer may go out from where it was computed */
};

/* Changed by whoever works on the request: [loop], or [compute] while its job runs; EARLY
 * is set by [loop] while its job is queued and cannot begin, or runs and is OPEN. */
enum srv_request_state {
    SRV_REQUEST_NEW = 0,     /* being made */
    SRV_REQUEST_QUEUED = 1,  /* waits for its turn, or a thread works on it */
    SRV_REQUEST_BRIEF = 2,   /* the loop works on it, and must not be held up */
    SRV_REQUEST_MOVED = 3,   /* as QUEUED; BRIEF has staged what it moves already */
    SRV_REQUEST_EARLY = 4,   /* as QUEUED; it does what is left without an answer */
    SRV_REQUEST_OWED = 5,    /* has run; the loop is to answer it */
    SRV_REQUEST_TRIED = 6,   /* the same, as the thread that computed it could not */
    SRV_REQUEST_REPLIED = 7, /* has run, and that thread has answered it */
    SRV_REQUEST_WAITING = 8, /* has run; its frame waits for a step (hold.h) */
    SRV_REQUEST_OVER = 9,    /* everything is given back */
    SRV_REQUEST_OPEN = 10,   /* runs, and thread or loop may answer it */
    SRV_REQUEST_STATES = 11
};

struct srv_request {
    struct srv_job job; /* first: the job is the request */
    _Atomic(enum srv_request_state) state;
    struct srv_session *session;
    struct srv_request *prev; /* [loop] in the session's list */
    struct srv_request *next;
    struct srv_plan plan;
    struct srv_claim *claim; /* of plan.scene */
    uint32_t id;
    int method;
    uint64_t arrival_ns;
    bool is_alone; /* it came when its client was the only one: nobody else is held up */
    union srv_params params;
    union srv_result result;
    struct proto_error error;
    int status;
    uint32_t connection;    /* of the session, with which it came, or came again last */
    uint64_t upload_bytes;  /* copied out of slots */
    uint64_t begin_ns;      /* [compute] of a step: since when it computes */
    uint32_t items_done;    /* [compute] of a request that runs in parts */
    const uint8_t *payload; /* [compute] of such a request, in its slot */
    struct srv_laststep *last_step; /* of a step that was computed; else NULL */
    int fds[2];                     /* to send with the answer and close; -1: none */
    struct srv_deadline deadline;   /* [loop] the plan's; at_ns 0: none */
    uint64_t end_ns;           /* [loop] since when it is to end; 0: it is not */
    uint8_t *copy;             /* EARLY: of its slot, charged to its user; NULL: none */
    uint64_t copy_bytes;       /* of `copy` */
    struct srv_outlet *outlet; /* [loop] may answer by it on [compute]; NULL: on [loop] */
    uint64_t replied_ns;       /* REPLIED: when */
    struct srv_kept_reply
        reply; /* REPLIED: for a client that comes back; 0 bytes: none */
    struct srv_held_frame *held; /* that it has brought; NULL: none, or it was answered */
    struct srv_item item; /* plan.scene; those of a batch are its own (srv_batch.h) */
};

/* Return whether a method is one of those that move scenes: it counts among the steps in
 * flight, ends soon when its end has come, and moves what it moves though it is
 * cancelled. [any] */
bool srv_is_step(int method);

/* Return the state of a request. Relaxed: nothing is read because of it; a state of
 * [compute] is of the loop's interest only when the job is done. [any] */
static inline enum srv_request_state srv_request_state(const struct srv_request *request)
{
    return atomic_load_explicit(&request->state, memory_order_relaxed);
}

/* Go on to another state, which the drawing allows. [loop], [compute] */
void srv_request_move(struct srv_request *request, enum srv_request_state to);

/* Answer one that has run or was taken back, and let go of everything. [loop] */
void srv_request_conclude(struct srv_request *request);

/* Answer a request whose deadline has come, where it waits and can be answered before its
 * turn. [loop] */
void srv_request_overdue(struct srv_deadline *deadline);

/* Answer with `result`, of its method, a request that still waits for its turn, when it
 * will do what is left without an answer: out of `copy`, of malloc, charged as
 * SRV_QUOTA_SHM_BYTES and taken over, in the place of its slot, which is returned; or
 * one that is OPEN, without a copy. `write`, NULL: there is none, writes the page of one
 * that waits, where srv_request_may_write, or returns false: it cannot now. False: it is
 * neither, or has no page, and nothing has changed. [loop] */
bool srv_request_answer_early(struct srv_request *request, const void *result,
                              uint8_t *copy, uint64_t copy_bytes,
                              bool (*write)(struct srv_request *request));
/* Return whether the page of a request that waits for its turn may be written: nobody
 * uses its ring, and the client has all answers whose pages lie before. [loop] */
bool srv_request_may_write(struct srv_request *request);

/* Queue a request for `call`. Returns SRV_LATER, or PCCD_E_BUSY or PCCD_E_NOMEM with
 * call->error set: then neither function of the plan is called. [loop] */
int srv_request_start(struct srv_call *call, const struct srv_plan *plan);

/* Conclude, before a message is handled, what was answered where it was computed, so that
 * who has an answer finds what it says everywhere. Where one is just on its way it waits
 * for the few microseconds until the compute thread has put the request down. [loop] */
void srv_request_catch_up(struct srv_service *service);

/* Give the slot back as soon as it has been read; once, further calls do nothing.
 * [compute] */
void srv_request_return_slot(struct srv_request *request);

/* Let the loop answer it, too, from now on: its slot has been read. [compute] */
void srv_request_open(struct srv_request *request);

/* Have the loop send request->result now: the thread goes on with what is left, and may
 * not change it. It ends with srv_request_claim. [compute] */
void srv_request_answer_now(struct srv_request *request);
/* Send what was left to the loop so. [loop] */
void srv_request_send_open(struct srv_service *service);

/* Take the answer to oneself; then it is not OPEN any more. False: the client has it, and
 * the request is EARLY. [compute] */
bool srv_request_claim(struct srv_request *request);

/* Stop it: a queued step is answered at once where that is possible (answer_early), and
 * runs in its turn with its flag set; another queued request is answered with
 * PCCD_E_CANCELLED at once; a running one sees the flag. [loop] */
void srv_request_cancel(struct srv_request *request);

/* Stop all that a session has in flight, as srv_request_cancel does. [loop] */
void srv_request_cancel_all(struct srv_session *session);

/* Stop all that a session has in flight, without answers: its client is gone. [loop] */
void srv_request_abandon_all(struct srv_session *session);

/* Return the request in flight with that message id that has no answer yet, or NULL.
 * [loop] */
struct srv_request *srv_request_find(const struct srv_session *session, uint32_t id);

/* Return whether the connection with which it came is lost: it is not answered over the
 * next one unless it comes again, so that answers keep the order of the requests. [loop]
 */
bool srv_request_is_cut_off(const struct srv_request *request);

#endif

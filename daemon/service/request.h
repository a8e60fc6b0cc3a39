/* request.h - a request on its way through the compute thread.
 *
 * Room:     service. May include: call.h, resource.h, ringio.h, compute.h.
 * Does:     keep a request's parameters and everything it uses until its answer is sent,
 *           or its client is gone.
 * Does not: know any method: handlers give the functions.
 * Threads:  functions say.
 */
#ifndef SRV_REQUEST_H
#define SRV_REQUEST_H

#include "call.h"
#include "resource.h"
#include "ringio.h"

#define SRV_OVERDUE_NOWHERE UINT32_MAX

struct srv_held;
struct srv_laststep;
struct srv_loop;
struct srv_outlet;
struct srv_replacement;
struct srv_request;
struct srv_seat;
struct srv_tracing;

/* What a handler asks for. References are taken for as long as the request lives. */
struct srv_plan {
    /* [compute]; returns 0 with request->result filled in, or with job.goes_on set, to be
     * called again; or a negative status with request->error set. */
    int (*work)(struct srv_request *request);
    /* [loop], may be NULL; after the work, or instead of it when the request was taken
     * back; request->status says how it went. */
    void (*finish)(struct srv_request *request);
    struct srv_ring *ring;   /* NULL: uses none */
    struct srv_shape *shape; /* likewise */
    struct srv_scene *scene; /* likewise */
    struct srv_ring
        *attached; /* a ring that is not the session's yet; no reference taken */
    struct srv_tracing *tracing;         /* a reference is taken */
    struct srv_replacement *replacement; /* given back by `finish`; NULL: none */
    uint64_t mesh_number;                /* of the mesh that `shape` serves */
    uint32_t generation;                 /* likewise */
    uint32_t object;                     /* handle in `scene` */
    struct srv_seat *seat; /* with which the session takes part in it: leaves it behind
                            * its requests (shared.h); NULL: the scene is its own */
    uint64_t held_bytes;   /* charged for a frame that is held (held.h); 0: none */
    bool takes_slot;       /* a slot of the ring, to be returned exactly once */
    /* [loop] It still waits for its turn, and its deadline has come or it was cancelled:
     * answer it (srv_request_answer_early), or leave it to its turn. NULL: it is left. */
    void (*answer_early)(struct srv_request *request, enum pccd_incomplete why);
    /* [loop] while nothing is computed: whether the work is certain to take no longer
     * than some tens of microseconds, or else to set job.goes_on, if `is_brief` is set.
     * NULL: it is not. */
    bool (*can_be_brief)(struct srv_request *request);
    uint64_t deadline_ns; /* CLOCK_MONOTONIC; 0: none */
    bool replies;         /* the answer may go out from where it was computed */
};

struct srv_request {
    struct srv_job job; /* first: the job is the request */
    struct srv_session *session;
    struct srv_request *prev; /* [loop] in the session's list */
    struct srv_request *next;
    struct srv_plan plan;
    struct srv_claim *claim; /* of plan.scene */
    uint32_t id;
    int method;
    uint64_t arrival_ns;
    union srv_params params;
    union srv_result result;
    struct proto_error error;
    int status;
    bool is_held; /* its connection was lost: not answered until it comes again */
    uint64_t upload_bytes;          /* copied out of slots */
    bool is_brief;                  /* whoever runs it must not be held up */
    bool has_moved;                 /* [compute] a step that goes on: it was staged */
    uint64_t begin_ns;              /* [compute] of a step: since when it computes */
    uint32_t items_done;            /* [compute] of a request that runs in parts */
    const uint8_t *payload;         /* [compute] likewise, in its slot */
    bool has_stepped;               /* [compute] then [loop]: its scene has moved on */
    struct srv_laststep *last_step; /* of a step that was computed; else NULL */
    int fds[2];                     /* to send with the answer and close; -1: none */
    uint64_t deadline_ns;           /* [loop] as the plan's */
    uint32_t overdue_at;            /* [loop] its place in overdue.h */
    bool is_answered;               /* before its turn; changes only while it is queued */
    uint8_t *copy;       /* likewise: of its slot, charged to its user; NULL: none */
    uint64_t copy_bytes; /* likewise */
    struct srv_outlet *outlet; /* [loop] may answer by it on [compute]; NULL: on [loop] */
    bool has_tried;            /* [compute] to answer it, */
    bool is_replied;           /* and has, */
    uint64_t replied_ns;       /* then; */
    bool is_owed;              /* or it is one of the session's owed_count */
    struct srv_held *held;     /* that it has brought; NULL: none, or it was answered */
    struct srv_held *taken;    /* [compute] then [loop]: by its step */
    bool is_waiting;           /* for a step of another session (held.h) */
};

/* Admission: the session's ring, or PCCD_E_STATE with call->error set. [loop] */
int srv_request_ring(struct srv_call *call, struct srv_ring **ring);
/* Admission: whether slot and sequence number can be those of a written slot. [loop] */
int srv_request_slot(struct srv_call *call, const struct srv_ring *ring, uint32_t slot,
                     uint64_t seq);

/* Answer one that waits, and let go of everything. [loop] */
void srv_request_conclude(struct srv_request *request);

/* Its deadline has come. [loop] */
void srv_request_overdue(struct srv_request *request);

/* Answer with `result` a request that still waits for its turn, when it will do what is
 * left without an answer: out of `copy`, of malloc, charged as SRV_QUOTA_SHM_BYTES and
 * taken over, in the place of its slot, which is returned. False: it has begun, and
 * nothing has changed. [loop] */
bool srv_request_answer_early(struct srv_request *request,
                              const struct proto_FRAME_SUBMIT_result *result,
                              uint8_t *copy, uint64_t copy_bytes);

/* Queue a request for `call`. Returns SRV_LATER, or PCCD_E_BUSY or PCCD_E_NOMEM with
 * call->error set: then neither function of the plan is called. [loop] */
int srv_request_start(struct srv_call *call, const struct srv_plan *plan);

/* Before a message is handled: conclude what was answered where it was computed, so that
 * who has an answer finds what it says everywhere. Where one is just on its way it waits
 * for the few microseconds until the compute thread has put the request down. [loop] */
void srv_request_catch_up(struct srv_loop *loop);

/* The session is over: the memory that it has kept for requests goes. [loop] */
void srv_request_free_spares(struct srv_session *session);

/* Give the slot back as soon as it has been read; once, further calls do nothing.
 * [compute] */
void srv_request_return_slot(struct srv_request *request);

/* Stop it: a queued step is answered at once where that is possible (answer_early), and
 * runs in its turn with its flag set; another queued request is answered with
 * PCCD_E_CANCELLED at once; a running one sees the flag. [loop] */
void srv_request_cancel(struct srv_request *request);

/* The client is gone: stop it without an answer. [loop] */
void srv_request_abandon(struct srv_request *request);

#endif

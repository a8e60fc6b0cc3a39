/* plan.h - what a request will do when it is its turn, and everything that it uses
 * until then.
 */
#ifndef SRV_PLAN_H
#define SRV_PLAN_H

#include <stdbool.h>
#include <stdint.h>

#include "pccd_types.h"
#include "ringio.h"
#include "srv_scene.h"

struct srv_batch;
struct srv_replacement;
struct srv_request;
struct srv_member;
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
    struct srv_ring *replaced;           /* by `attached`; freed after the work, by the
                                          * same thread; NULL: none */
    struct srv_tracing *tracing;         /* a reference is taken */
    struct srv_replacement *replacement; /* given back by `finish`; NULL: none */
    struct srv_batch *batch;             /* likewise */
    uint64_t mesh_number;                /* of the mesh that `shape` serves */
    uint32_t generation;                 /* likewise */
    uint32_t object;                     /* handle in `scene` */
    struct srv_member
        *member;         /* with which the session takes part in it: leaves it behind
                            * its requests (shared.h); NULL: the scene is its own */
    uint64_t held_bytes; /* charged for a frame that is held (held.h); 0: none */
    bool takes_slot;     /* a slot of the ring, to be returned exactly once */
    bool makes_pages;    /* the work is done on [pages], beside what is computed */
    /* [loop] It still waits for its turn, and its deadline has come or it was cancelled:
     * answer it (srv_request_answer_early), or leave it to its turn. NULL: it is left. */
    void (*answer_early)(struct srv_request *request, enum pccd_incomplete why);
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

/* A reference to each thing that the plan names, and back. [loop] */
void srv_plan_acquire(const struct srv_plan *plan);
void srv_plan_release(const struct srv_plan *plan);

#endif

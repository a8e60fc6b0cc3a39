/* srv_batch.h - the scenes of a batch: which ones a request names, who computes them, and
 * what came of each.
 *
 * Threads: [loop], but for members marked otherwise.
 */
#ifndef SRV_BATCH_H
#define SRV_BATCH_H

#include <stdatomic.h>
#include <stdint.h>

#include "metrics.h"
#include "srv_step.h"

/* The part of a batch that a thread has for itself. [compute] */
struct srv_batch_tally {
    struct srv_metrics metrics;             /* of its scenes */
    struct proto_LIST_SESSION_result stats; /* of its scenes */
    struct eng_thread_record record;        /* of its scenes */
    uint64_t scenes;                        /* that it had a part in */
    struct proto_error error;               /* of the scene at hand */
    uint64_t upload_bytes;
    uint32_t failed;
};

struct srv_batch {
    struct srv_quota_user *user; /* charged with `bytes` of SRV_QUOTA_SHM_BYTES */
    uint64_t bytes;              /* of this struct and all that is in it */
    uint32_t count;
    uint32_t claim_count;
    uint32_t order_count;
    uint32_t shared_count;
    uint32_t tally_count;
    atomic_bool has_begun; /* by [compute]; relaxed, as is the next: for lists */
    atomic_uint done;      /* scenes, of `count` */
    struct srv_batch_tally *tallies; /* [tally_count] for the threads; [compute], then the
                                   * first has what all have counted, and [loop] */
    struct proto_answer *shared;     /* [shared_count] of scenes that others share */
    struct srv_claim **claims;       /* [claim_count], of the scenes */
    struct proto_segment *segments;  /* [compute] the table, that of the request */
    uint32_t *order; /* [order_count]: the items that have a scene which is not shared */
    uint32_t *rest;  /* [order_count] [compute]: of these, see srv_batch.c */
    struct srv_item items[]; /* [count], with a reference to their scenes */
};

/* Read the table. A scene that the session does not have, may only read, or that the
 * table names once more has a status of its own: PCCD_E_HANDLE, PCCD_E_ACCESS,
 * PCCD_E_INVAL. All memory that the batch takes is taken here, in one piece.
 * Returns 0, PCCD_E_SLOT_STALE, PCCD_E_SLOT_TORN, PCCD_E_SEGMENT (the segments of the
 * scenes are not as many as the request says), PCCD_E_QUOTA or PCCD_E_NOMEM with *error
 * set: nothing has changed then. */
int srv_batch_begin(struct srv_call *call, struct srv_ring *ring,
                    const struct srv_step_params *params, struct srv_batch **batch);
/* Give everything back. */
void srv_batch_end(struct srv_batch *batch);

/* Do the work of a plan for many scenes. [compute] */
int srv_batch_work(struct srv_request *request);

/* Answer a batch that is to end: one that waits for its turn (plan.answer_early), or is
 * OPEN. [loop] */
bool srv_batch_answer_early(struct srv_request *request, enum pccd_incomplete why);

#endif

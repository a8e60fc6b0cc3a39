/* srv_batch.h - the scenes of a batch: which ones a request names, and what came of each.
 *
 * Threads: [loop], but for members marked otherwise.
 */
#ifndef SRV_BATCH_H
#define SRV_BATCH_H

#include <stdatomic.h>
#include <stdbool.h>
#include <stdint.h>

#include "codec.h"
#include "member.h"
#include "messages.h"
#include "metrics.h"
#include "ringio.h"
#include "shm.h"
#include "srv_scene.h"

struct srv_held;

/* What the loop tells others of a step of a shared scene. */
struct srv_batch_shared {
    struct srv_member *member;  /* with which the session takes part */
    struct srv_held *taken;     /* [compute] then [loop]: held frames that went along */
    bool has_stepped;           /* likewise */
    struct proto_answer answer; /* likewise: of the scene, if it has */
};

/* What a thread of the batch has for itself. [compute] */
struct srv_batch_lane {
    struct srv_metrics metrics;      /* of its scenes */
    struct eng_thread_record record; /* likewise */
    uint64_t scenes;                 /* that it had a part in */
    struct proto_error error;        /* of the scene at hand */
    uint64_t upload_bytes;
    uint64_t ns_steps;
    uint32_t failed;
    uint32_t incomplete;
};

/* One scene. */
struct srv_batch_item {
    struct srv_scene *scene; /* with a reference; NULL: `status` says why there is none */
    uint32_t handle;
    int32_t status;                  /* of the table, then [compute] of the step */
    uint32_t first;                  /* segment in the table of all */
    uint32_t segments;               /* that are its own */
    struct srv_batch_shared *shared; /* NULL: the scene is the session's alone */
    /* [compute] then [loop], of a step that succeeded */
    uint64_t total;
    uint64_t hash[2];
    uint64_t ns_step;
    uint32_t incomplete;
    uint32_t verdict;
    uint32_t threads;
};

struct srv_batch {
    struct srv_quota_user *user; /* charged with `bytes` of SRV_QUOTA_SHM_BYTES */
    uint64_t bytes;              /* of this struct and all that is in it */
    uint32_t count;
    uint32_t claim_count;
    uint32_t order_count;
    uint32_t shared_count;
    uint32_t lane_count;
    atomic_bool has_begun;        /* by [compute]; relaxed, as is the next: for lists */
    atomic_uint done;             /* scenes, of `count` */
    struct srv_batch_lane *lanes; /* [lane_count] for the threads; [compute], then the
                                      * first has what all have counted, and [loop] */
    struct srv_batch_shared *shared; /* [shared_count] */
    struct srv_claim **claims;       /* [claim_count], of the scenes */
    struct proto_segment *segments;  /* [compute] the table, that of the request */
    uint32_t *order; /* [order_count]: the items that have a scene which is not shared */
    uint32_t *rest;  /* [order_count] [compute]: of these, see handlers_batch.c */
    struct srv_batch_item items[]; /* [count] */
};

/* Read the table. A scene that the session does not have, may only read, or that the
 * table names once more has a status of its own: PCCD_E_HANDLE, PCCD_E_ACCESS,
 * PCCD_E_INVAL. All memory that the batch takes is taken here, in one piece.
 * Returns 0, PCCD_E_SLOT_STALE, PCCD_E_SLOT_TORN, PCCD_E_SEGMENT (the segments of the
 * scenes are not as many as the request says), PCCD_E_QUOTA or PCCD_E_NOMEM with *error
 * set: nothing has changed then. */
int srv_batch_begin(struct srv_session *session, struct srv_ring *ring,
                    const struct proto_BATCH_SUBMIT_request *request,
                    struct srv_batch **batch, struct proto_error *error);
/* Give everything back. */
void srv_batch_end(struct srv_batch *batch);

/* Why an item had no scene: a sentence. [any] */
const char *srv_batch_why(int status);

#endif

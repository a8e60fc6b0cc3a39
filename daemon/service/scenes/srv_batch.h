/* srv_batch.h - the scenes of a batch: which ones a request names, and what came of each.
 *
 * Room:     service. May include: srv_scene.h, ringio.h, the protocol's headers.
 * Does:     read the table of scenes out of the slot, take a reference to each scene, and
 *           keep what the loop is to tell of it when the batch is done.
 * Does not: compute (requests/handlers_batch.c).
 * Threads:  [loop], but for members marked otherwise.
 */
#ifndef SRV_BATCH_H
#define SRV_BATCH_H

#include <stdint.h>

#include "codec.h"
#include "messages.h"
#include "metrics.h"
#include "ringio.h"
#include "srv_scene.h"

/* One scene. */
struct srv_batch_item {
    struct srv_scene *scene; /* with a reference; NULL: `status` says why there is none */
    uint32_t handle;
    int32_t status;    /* of the table, then [compute] of the step */
    uint32_t first;    /* segment in the table of all */
    uint32_t segments; /* that are its own */
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
    struct srv_metrics metrics;    /* [compute] then [loop]: what its steps count */
    struct srv_claim **claims;     /* [claim_count], of the scenes */
    uint32_t *order;               /* [claim_count]: of the items that have a scene */
    struct srv_batch_item items[]; /* [count] */
};

/* Read the table, whose scenes have to be the session's. A scene that is unknown, shared
 * or named before has a status of its own: PCCD_E_HANDLE, PCCD_E_STATE, PCCD_E_INVAL.
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

/* held.h - frames that wait for the step of another session.
 *
 * Room:     service. May include: request.h, resource.h.
 * Does:     keep what a held frame moves, copied and checked, until a step of its scene
 *           takes it along; keep its request until then, and answer it.
 * Does not: outlive the session that holds it (shared.h).
 * Threads:  functions say.
 *
 *     frame.submit (hold) --copied, checked--> waits --a step, anybody's--> answered
 *                                                `--deadline, cancel--> answered; what it
 *                                                   moves still goes along
 */
#ifndef SRV_HELD_H
#define SRV_HELD_H

#include <stdint.h>

#include "codec.h"
#include "request.h"
#include "resource.h"

struct srv_loop;

struct srv_held {
    struct srv_held *next;       /* [compute] of the scene, the oldest first */
    struct srv_request *request; /* [loop] NULL: it has been answered */
    struct srv_seat *seat;       /* that has brought it */
    struct proto_FRAME_SUBMIT_request submit;
    uint8_t *copy; /* of the slot, of malloc */
    uint64_t bytes;
    uint64_t charge;          /* SRV_QUOTA_SHM_BYTES: a whole slot */
    uint64_t changes;         /* of the scene, when it was checked last */
    struct proto_error error; /* code 0; else why it could not be taken along */
};

/* srv_request_start for a frame that is held, which is charged for before: it is copied,
 * checked against the scene, and waits. Besides what that returns: PCCD_E_INVAL (the
 * scene is not shared, or nothing moves, or it is to be placed), PCCD_E_BUSY (another one
 * waits) or PCCD_E_QUOTA with call->error set. [loop] */
int srv_held_start(struct srv_call *call, struct srv_plan *plan);

/* Check anew what waits, where the scene has changed since: what cannot be moved any more
 * goes to request->taken. [compute] */
void srv_held_check(struct srv_request *request);
/* Stage what waits, in the staging that is open. [compute] */
int srv_held_stage(struct srv_request *request);
/* The step has run: what was staged goes to request->taken; nothing was where objects
 * were only placed. [compute] */
void srv_held_take(struct srv_request *request);
/* Answer what a step has taken along, and free it. [loop] */
void srv_held_answer(struct srv_request *request);

/* Take what was held with the seat out of the scene. [compute] */
struct srv_held *srv_held_remove(struct srv_scene *scene, const struct srv_seat *seat);
/* What still waits for its answer is answered as cancelled. [loop] */
void srv_held_free(struct srv_held *list);
/* The daemon ends: what waits is answered as cancelled, and nothing begins to. [loop] */
void srv_held_end_all(struct srv_loop *loop);

/* Whether a request that has run goes on to wait. If its deadline has come, or it was
 * cancelled, or its client is gone, or the daemon ends: no, and its result says so.
 * [loop] */
bool srv_held_waits(struct srv_request *request);
/* End the waiting of a request, which is answered so. [loop] */
void srv_held_end(struct srv_request *request, enum pccd_incomplete why);

#endif

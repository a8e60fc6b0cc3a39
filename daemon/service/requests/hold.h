/* hold.h - frames that a client of a shared scene submits with `hold`: they wait for
 * the next step of any client.
 *
 * Threads: [loop], but for the work.
 */
#ifndef SRV_HOLD_H
#define SRV_HOLD_H

#include "request.h"

struct srv_service;

/* Start a request, as srv_request_start, for a frame that is held, which is charged for
 * before: it is copied, checked against the scene, and waits. Returns besides what that
 * does: PCCD_E_INVAL (the scene is not shared, nothing moves, it is to be placed, or its
 * start to be told), PCCD_E_BUSY (another one waits) or PCCD_E_QUOTA with call->error
 * set. */
int srv_hold_start(struct srv_call *call, struct srv_plan *plan);

/* Answer those whose frames a step has taken along with its answer, `step`, or with the
 * error of their frame, and free the frames. */
void srv_hold_answer(struct srv_held_frame *taken, const struct proto_answer *step);

/* Answer what waits as cancelled, as the daemon ends; nothing begins to wait any more. */
void srv_hold_end_all(struct srv_service *service);

#endif

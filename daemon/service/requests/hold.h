/* hold.h - frames that a client of a shared scene submits with `hold`: they wait for
 * the next step of any client.
 *
 * Threads: [loop], but for the work.
 */
#ifndef SRV_HOLD_H
#define SRV_HOLD_H

#include "request.h"

struct srv_service;

/* srv_request_start for a frame that is held, which is charged for before: it is copied,
 * checked against the scene, and waits. Besides what that returns: PCCD_E_INVAL (the
 * scene is not shared, or nothing moves, or it is to be placed), PCCD_E_BUSY (another one
 * waits) or PCCD_E_QUOTA with call->error set. */
int srv_hold_start(struct srv_call *call, struct srv_plan *plan);

/* A step was answered with `step`: so are those whose frames it has taken along; free the
 * frames. */
void srv_hold_answer(struct srv_held_frame *taken, const struct proto_answer *step);

/* The daemon ends: what waits is answered as cancelled, and nothing begins to. */
void srv_hold_end_all(struct srv_service *service);

#endif

/* admission.h - the checks that every request with positions in shared memory must
 * pass before it is queued.
 */
#ifndef SRV_ADMISSION_H
#define SRV_ADMISSION_H

#include "call.h"
#include "ringio.h"

/* The session's ring, or PCCD_E_STATE with call->error set. */
int srv_admit_ring(struct srv_call *call, struct srv_ring **ring);
/* 0, or with call->error set PCCD_E_INVAL: slot and sequence number cannot be those of a
 * written slot, or PCCD_E_STATE: the slot has no memory. */
int srv_admit_slot(struct srv_call *call, const struct srv_ring *ring, uint32_t slot,
                   uint64_t seq);

#endif

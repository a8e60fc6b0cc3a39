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

/* A choice of a message by name, of 0 .. count-1: 0, or PCCD_E_INVAL with call->error
 * set. */
int srv_check_choice(struct srv_call *call, const char *name, uint32_t value,
                     uint32_t count);
/* A length of a message, 0 .. 1e18: 0; or, with call->error set, PCCD_E_INVAL: negative
 * or not finite, PCCD_E_LIMIT: longer. */
int srv_check_length(struct srv_call *call, const char *name, double length);

#endif

/* admission.c - what every request that uses the ring is asked for first. */
#include "admission.h"

#include "session.h"

int srv_admit_ring(struct srv_call *call, struct srv_ring **ring)
{
    if (call->session->attaching) {
        return proto_error_set(&call->error, PCCD_E_STATE, "shm.attach is not done yet");
    }
    if (call->session->ring == NULL) {
        return proto_error_set(&call->error, PCCD_E_STATE, "%s needs shm.attach first",
                               proto_messages[call->method].name);
    }
    *ring = call->session->ring;
    return 0;
}

int srv_admit_slot(struct srv_call *call, const struct srv_ring *ring, uint32_t slot,
                   uint64_t seq)
{
    if (slot >= ring->slot_count) {
        return proto_error_set(&call->error, PCCD_E_INVAL, "slot is %u, the ring has %u",
                               slot, ring->slot_count);
    }
    if (!srv_ring_has_slot(ring, slot)) {
        return proto_error_set(&call->error, PCCD_E_STATE,
                               "slot %u has no memory: shm.take gives it some", slot);
    }
    if (seq == 0 || seq % 2 != 0) {
        return proto_error_set(&call->error, PCCD_E_INVAL,
                               "seq is %llu, a written slot has an even one from 2 on",
                               (unsigned long long)seq);
    }
    return 0;
}

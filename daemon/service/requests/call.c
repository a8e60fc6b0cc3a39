/* call.c - what many requests are checked for. */
#include "call.h"

#include <math.h>

#include "ringio.h"
#include "session.h"

int srv_refuse_handle(struct srv_call *call, const struct srv_session *owner,
                      const char *kind, uint32_t handle)
{
    const char *is = srv_handles_get(&owner->scenes, handle) != NULL   ? ", it is a scene"
                     : srv_handles_get(&owner->meshes, handle) != NULL ? ", it is a mesh"
                                                                       : "";
    return proto_error_set(&call->error, PCCD_E_HANDLE, "there is no %s 0x%x%s", kind,
                           handle, is);
}

struct srv_scene *srv_admit_scene(struct srv_call *call, const struct srv_session *owner,
                                  uint32_t handle)
{
    struct srv_scene *scene = srv_handles_get(&owner->scenes, handle);
    if (scene == NULL) {
        (void)srv_refuse_handle(call, owner, "scene", handle);
    }
    return scene;
}

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

int srv_check_choice(struct srv_call *call, const char *name, uint32_t value,
                     uint32_t count)
{
    return value < count ? 0
                         : proto_error_set(&call->error, PCCD_E_INVAL, "unknown %s %u",
                                           name, value);
}

int srv_check_length(struct srv_call *call, const char *name, double length)
{
    if (!(length >= 0.0) || isinf(length)) { /* written so that NaN is refused */
        return proto_error_set(&call->error, PCCD_E_INVAL, "%s is %g, not 0 to %g", name,
                               length, PROTO_COORDINATE_MAX);
    }
    if (length > PROTO_COORDINATE_MAX) {
        return proto_error_set(&call->error, PCCD_E_LIMIT, "%s is %g, at most %g may be",
                               name, length, PROTO_COORDINATE_MAX);
    }
    return 0;
}

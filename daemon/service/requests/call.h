/* call.h - one decoded request while it is being answered, and what many are checked
 * for. */
#ifndef SRV_CALL_H
#define SRV_CALL_H

#include "codec.h"
#include "messages.h"

struct srv_ring;
struct srv_scene;
struct srv_session;

#define SRV_MEMBER(ID, name, since, flags, text) struct proto_##ID##_request ID;
union srv_params {
    PROTO_METHODS(SRV_MEMBER)
};
#undef SRV_MEMBER

#define SRV_MEMBER(ID, name, since, flags, text) struct proto_##ID##_result ID;
union srv_result {
    PROTO_METHODS(SRV_MEMBER)
    struct proto_answer answer; /* of a step, scene.near and both fetches */
};
#undef SRV_MEMBER

struct srv_call {
    struct srv_session *session;
    uint32_t id;
    int method;          /* enum proto_method */
    uint64_t arrival_ns; /* common_now_ns */
    union srv_params params;
    union srv_result result;  /* zeroed */
    struct proto_error error; /* set by whoever returns a negative status */
};

/* A handler returned: the answer comes from the compute thread. */
#define SRV_LATER 1

/* srv_on_HELLO and so on. Each returns 0 (call->result is the answer), SRV_LATER, or a
 * negative status with call->error set; the session is as before then. [loop] */
#define SRV_HANDLER(ID, name, since, flags, text) int srv_on_##ID(struct srv_call *call);
PROTO_METHODS(SRV_HANDLER)
#undef SRV_HANDLER

/* ---- checks [loop] ----------------------------------------------------------------- */

/* Set call->error to PCCD_E_HANDLE, which it returns: `owner` has no scene, or mesh, of
 * that handle; it may be what the other one has. */
int srv_refuse_handle(struct srv_call *call, const struct srv_session *owner,
                      const char *kind, uint32_t handle);
/* Return the scene that `owner` knows by the handle; NULL, with call->error set to
 * PCCD_E_HANDLE: there is none. */
struct srv_scene *srv_admit_scene(struct srv_call *call, const struct srv_session *owner,
                                  uint32_t handle);
/* Give *ring the session's ring. Returns 0, or PCCD_E_STATE with call->error set. */
int srv_admit_ring(struct srv_call *call, struct srv_ring **ring);
/* Check the slot that a message names. Returns 0, or with call->error set PCCD_E_INVAL:
 * slot and sequence number cannot be those of a written slot, or PCCD_E_STATE: the slot
 * has no memory. */
int srv_admit_slot(struct srv_call *call, const struct srv_ring *ring, uint32_t slot,
                   uint64_t seq);
/* Check a choice of a message, by name, of 0 .. count-1. Returns 0, or PCCD_E_INVAL with
 * call->error set. */
int srv_check_choice(struct srv_call *call, const char *name, uint32_t value,
                     uint32_t count);
/* Check a length of a message, 0 .. 1e18. Returns 0; or, with call->error set,
 * PCCD_E_INVAL: negative or not finite, PCCD_E_LIMIT: longer. */
int srv_check_length(struct srv_call *call, const char *name, double length);

#endif

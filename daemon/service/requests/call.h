/* call.h - one decoded request while it is being answered. */
#ifndef SRV_CALL_H
#define SRV_CALL_H

#include "codec.h"
#include "messages.h"

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

#endif

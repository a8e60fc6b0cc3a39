/* handlers_hello.c - hello and bye: how a session begins, goes on and ends. */
#include <string.h>
#include <unistd.h>

#include "call.h"
#include "dispatch.h"
#include "host.h"
#include "linger.h"
#include "service.h"
#include "session.h"
#include "shared.h"

#define DAEMON_NAME "pccdd " PACKAGE_VERSION

/* The newest version that both speak, or a fatal error. */
static int choose_version(struct srv_call *call, uint32_t *version)
{
    const struct proto_HELLO_request *request = &call->params.HELLO;
    if (request->version_min > request->version_max) {
        return proto_error_set(&call->error, PCCD_E_INVAL,
                               "version_min %u is greater than version_max %u",
                               request->version_min, request->version_max);
    }
    *version = request->version_max < PROTO_VERSION_MAX ? request->version_max
                                                        : PROTO_VERSION_MAX;
    if (*version >= request->version_min && *version >= PROTO_VERSION_MIN) {
        return 0;
    }
    proto_error_set(&call->error, PCCD_E_VERSION,
                    "the client speaks versions %u to %u, the daemon %u to %u",
                    request->version_min, request->version_max, PROTO_VERSION_MIN,
                    PROTO_VERSION_MAX);
    call->error.fatal = true;
    return PCCD_E_VERSION;
}

/* Return whether a session that was refused has a place after all: one that has become
 * free, or that of one that only waits. */
static bool finds_place(struct srv_session *session, struct proto_error *error)
{
    struct srv_service *service = session->service;
    if (session->is_stranger || (session->came_when_full && srv_host_is_full(service))) {
        return false;
    }
    return (session->came_when_full && srv_session_admit(session, error) == 0) ||
           (srv_linger_evict(service, session->owner.user) &&
            srv_session_admit(session, error) == 0);
}

static int open_session(struct srv_call *call, uint32_t version)
{
    struct srv_session *session = call->session;
    const struct proto_HELLO_request *request = &call->params.HELLO;
    bool is_observer = request->observer && srv_session_observe(session);
    if (session->state == SRV_SESSION_REFUSED && !finds_place(session, &call->error)) {
        return srv_dispatch_refuse_quota(session, &call->error);
    }
    if (request->resumable && !is_observer) {
        srv_linger_enable(session);
    }
    srv_session_open(session, version);
    strcpy(session->stats.client, request->client); /* as long at most */
    srv_log(SRV_LOG_INFO, session->id, "opened by \"%s\", user %u", request->client,
            (unsigned)session->owner.user->uid);
    return 0;
}

int srv_on_HELLO(struct srv_call *call)
{
    const struct proto_HELLO_request *request = &call->params.HELLO;
    struct srv_service *service = call->session->service;
    uint32_t version = 0;
    if (call->session->state == SRV_SESSION_OPEN) {
        return proto_error_set(&call->error, PCCD_E_STATE, "hello was said already");
    }
    int status = choose_version(call, &version);
    if (status != 0) {
        return status;
    }
    struct srv_session *older =
        call->session->is_stranger
            ? NULL
            : srv_linger_find(service, request, call->session->owner.user);
    if (older != NULL) {
        srv_linger_resume(older, call->session);
        srv_shared_resumed(older);
        call->session = older;
        older->version = version;
        srv_log(SRV_LOG_INFO, older->id, "resumed by \"%s\"", request->client);
    } else {
        status = open_session(call, version);
        if (status != 0) {
            return status;
        }
    }
    call->result.HELLO = (struct proto_HELLO_result){
        .version = version,
        .epoch = service->epoch,
        .session = call->session->id,
        .pid = (uint32_t)getpid(),
        .threads_max = service->options->threads_max,
        .daemon = DAEMON_NAME,
        .resumed = older != NULL,
        .token_hi = call->session->token[0],
        .token_lo = call->session->token[1],
        .linger_ms =
            call->session->replies != NULL ? service->options->linger_s * 1000u : 0,
    };
    strcpy(call->result.HELLO.cpu, eng_kernels_name(eng_kernels()));
    return 0;
}

int srv_on_BYE(struct srv_call *call)
{
    call->session->is_ending = true;
    call->result.BYE.done = true;
    return 0;
}

/* handlers_config.c - config.get and config.set. */
#include <string.h>

#include "call.h"
#include "config.h"
#include "log.h"
#include "service.h"
#include "session.h"

static int find_setting(struct srv_call *call, const char *name, uint32_t *index)
{
    *index = srv_config_find(name);
    return *index < srv_config_count()
               ? 0
               : proto_error_set(&call->error, PCCD_E_INVAL,
                                 "there is no setting \"%.64s\"", name);
}

int srv_on_CONFIG_GET(struct srv_call *call)
{
    const struct proto_CONFIG_GET_request *request = &call->params.CONFIG_GET;
    uint32_t index = request->index;
    int status = request->name[0] != '\0' ? find_setting(call, request->name, &index) : 0;
    if (status != 0) {
        return status;
    }
    if (index >= srv_config_count()) {
        return proto_error_set(&call->error, PCCD_E_INVAL,
                               "setting %u is wanted, there are %u", index,
                               srv_config_count());
    }
    call->result.CONFIG_GET.count = srv_config_count();
    srv_config_describe(call->session->service, index, &call->result.CONFIG_GET);
    return 0;
}

int srv_on_CONFIG_SET(struct srv_call *call)
{
    const struct proto_CONFIG_SET_request *request = &call->params.CONFIG_SET;
    struct srv_service *service = call->session->service;
    struct proto_CONFIG_GET_result before;
    uint32_t index = 0;
    int status = srv_session_refuse_stranger(call->session, &call->error);
    if (status == 0) {
        status = find_setting(call, request->name, &index);
    }
    if (status != 0) {
        return status;
    }
    srv_config_describe(service, index, &before);
    status = srv_config_set(service, index, request->value, &call->error);
    if (status == 0) {
        memcpy(call->result.CONFIG_SET.before, before.value, sizeof before.value);
        srv_log(SRV_LOG_INFO, call->session->id, "%s: %s, was %s", request->name,
                request->value, before.value);
    }
    return status;
}

/* setup.c - puts a service together, and takes it apart. */
#include "setup.h"

#include <stdlib.h>
#include <sys/random.h>
#include <unistd.h>

#include "dispatch.h"
#include "invariant.h"
#include "linger.h"
#include "now.h"
#include "pccd_types.h"
#include "request.h"
#include "stray.h"

/* A number that differs from start to start. */
static uint64_t make_epoch(void)
{
    uint64_t epoch = 0;
    if (getrandom(&epoch, sizeof epoch, GRND_NONBLOCK) != (ssize_t)sizeof epoch) {
        epoch = common_now_ns() ^ (uint64_t)getpid() << 32;
    }
    return epoch == 0 ? 1 : epoch; /* 0 means none */
}

int srv_service_init(struct srv_service *service, const struct srv_options *options)
{
    service->live = *options;
    service->options = &service->live;
    service->start_options = options;
    service->epoch = make_epoch();
    service->let_go = srv_let_go;
    service->refuse = srv_refuse;
    srv_quota_init(&service->quota, options->quota);
    srv_quota_bound_engine(&service->quota, options->engine_bytes_max);
    srv_quota_bound_memory(&service->quota, options->memory_total_max);
    service->decoder = proto_decoder_new();
    service->encoder = malloc(sizeof *service->encoder);
    if (service->decoder == NULL || service->encoder == NULL ||
        srv_workspace_init(service->workspaces, 0) != 0) {
        return PCCD_E_NOMEM;
    }
    int status = srv_linger_init(service);
    if (status == 0) {
        status = srv_spare_runner_init(&service->spare_runner, service, &service->compute,
                                       service->workspaces);
    }
    return status != 0
               ? status
               : srv_deadlines_init(&service->deadlines, service, srv_request_overdue);
}

void srv_service_deinit(struct srv_service *service)
{
    PCCD_ASSERT(service->sessions == NULL);
    srv_linger_deinit(service);
    srv_spare_runner_deinit(&service->spare_runner);
    srv_reclaim_deinit(&service->reclaim);
    srv_stray_deinit(service);
    srv_deadlines_deinit(&service->deadlines);
    srv_quota_deinit(&service->quota);
    srv_laststep_set(&service->spare_step, &service->last_step, NULL);
    srv_laststep_deinit(&service->spare_step);
    proto_decoder_free(service->decoder);
    free(service->encoder);
    srv_workspace_deinit(service->workspaces);
}

/* runners.c - the threads that compute: their scratch memory, and one more. */
#include "runners.h"

#include <stdlib.h>

#include "compute.h"
#include "host.h"
#include "invariant.h"
#include "log.h"
#include "now.h"
#include "pccd_types.h"
#include "proto_limits.h"

/* ---- What each thread that computes has for itself. */

int srv_workspace_init(struct srv_workspace workspaces[SRV_RUNNERS_MAX], uint32_t number)
{
    struct srv_workspace *workspace = &workspaces[number];
    if (workspace->encoder != NULL) {
        return 0;
    }
    bool has_team = number < SRV_PLACES;
    struct proto_encoder *encoder = malloc(sizeof *encoder);
    struct proto_segment *segments = malloc(PROTO_SEGMENTS_MAX * sizeof *segments);
    struct eng_affinity *affinity = has_team ? malloc(sizeof *affinity) : NULL;
    if (encoder == NULL || segments == NULL || (has_team && affinity == NULL)) {
        free(encoder);
        free(segments);
        free(affinity);
        return PCCD_E_NOMEM;
    }
    if (number == 0) {
        eng_affinity_init(affinity);
    } else if (has_team) {
        eng_affinity_for_team(workspaces[0].affinity, number, affinity);
    }
    *workspace = (struct srv_workspace){affinity, encoder, segments};
    return 0;
}

void srv_workspace_deinit(struct srv_workspace workspaces[SRV_RUNNERS_MAX])
{
    for (uint32_t i = 0; i < SRV_RUNNERS_MAX; i++) {
        free(workspaces[i].affinity);
        free(workspaces[i].encoder);
        free(workspaces[i].segments);
    }
}

#define NS_PER_MS 1000000u

/* Threads or memory may be there again then. */
#define RETRY_NS 1000000000u

static bool start_runner(struct srv_spare_runner *spare)
{
    uint32_t number = spare->compute->runner_count;
    int status = srv_workspace_init(spare->workspaces, number);
    if (status == 0) {
        status = srv_host_start_runner(spare->service);
    }
    if (status != 0) {
        spare->retry_ns = common_now_ns() + RETRY_NS;
        srv_log(SRV_LOG_WARN, 0,
                "no threads to compute beside %u requests that take long; others wait",
                number);
        return false;
    }
    srv_log(SRV_LOG_INFO, 0,
            "%u requests take long: others are computed beside them from now on", number);
    return true;
}

static void look(struct srv_spare_runner *spare)
{
    bool wants_runner = false;
    uint64_t after_ns = srv_compute_look(spare->compute, &wants_runner);
    if (wants_runner) {
        bool can_try = common_now_ns() >= spare->retry_ns;
        after_ns = can_try && start_runner(spare) ? SRV_SOON_NS : RETRY_NS;
    }
    spare->is_set = after_ns > 0;
    if (spare->is_set) {
        srv_timer_start(spare->timer, (after_ns + NS_PER_MS - 1) / NS_PER_MS, 0);
    }
}

static void on_timer(void *context)
{
    look(context);
}

/* A job waits. While the timer is set it will be seen to. */
static void on_backlog(void *context)
{
    struct srv_spare_runner *spare = context;
    srv_assert_loop();
    if (!spare->is_set && spare->timer != NULL) {
        look(spare);
    }
}

int srv_spare_runner_init(struct srv_spare_runner *spare, struct srv_service *service,
                          struct srv_compute *compute, struct srv_workspace *workspaces)
{
    *spare = (struct srv_spare_runner){
        .service = service, .compute = compute, .workspaces = workspaces};
    spare->timer = srv_timer_new(service, on_timer, spare);
    return spare->timer != NULL ? 0 : PCCD_E_NOMEM;
}

void srv_spare_runner_deinit(struct srv_spare_runner *spare)
{
    srv_timer_free(spare->timer);
    spare->timer = NULL;
}

void srv_spare_runner_begin(struct srv_spare_runner *spare)
{
    spare->compute->on_backlog = on_backlog;
    spare->compute->backlog_context = spare;
}

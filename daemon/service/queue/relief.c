/* relief.c - the threads that compute: their scratch memory, and one more. */
#include "relief.h"

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

static bool start_runner(struct srv_relief *relief)
{
    uint32_t number = relief->compute->runner_count;
    int status = srv_workspace_init(relief->workspaces, number);
    if (status == 0) {
        status = srv_host_start_runner(relief->service);
    }
    if (status != 0) {
        relief->retry_ns = common_now_ns() + RETRY_NS;
        srv_log(SRV_LOG_WARN, 0,
                "no threads to compute beside %u requests that take long; others wait",
                number);
        return false;
    }
    srv_log(SRV_LOG_INFO, 0,
            "%u requests take long: others are computed beside them from now on", number);
    return true;
}

static void look(struct srv_relief *relief)
{
    bool wants_runner = false;
    uint64_t after_ns = srv_compute_look(relief->compute, &wants_runner);
    if (wants_runner) {
        bool can_try = common_now_ns() >= relief->retry_ns;
        after_ns = can_try && start_runner(relief) ? SRV_SOON_NS : RETRY_NS;
    }
    relief->is_set = after_ns > 0;
    if (relief->is_set) {
        srv_timer_start(relief->timer, (after_ns + NS_PER_MS - 1) / NS_PER_MS, 0);
    }
}

static void on_timer(void *context)
{
    look(context);
}

/* A job waits. While the timer is set it will be seen to. */
static void on_crowded(void *context)
{
    struct srv_relief *relief = context;
    srv_assert_loop();
    if (!relief->is_set && relief->timer != NULL) {
        look(relief);
    }
}

int srv_relief_init(struct srv_relief *relief, struct srv_service *service,
                    struct srv_compute *compute, struct srv_workspace *workspaces)
{
    *relief = (struct srv_relief){
        .service = service, .compute = compute, .workspaces = workspaces};
    relief->timer = srv_timer_new(service, on_timer, relief);
    return relief->timer != NULL ? 0 : PCCD_E_NOMEM;
}

void srv_relief_deinit(struct srv_relief *relief)
{
    srv_timer_free(relief->timer);
    relief->timer = NULL;
}

void srv_relief_begin(struct srv_relief *relief)
{
    relief->compute->crowded = on_crowded;
    relief->compute->crowded_context = relief;
}

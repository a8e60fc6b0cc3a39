/* relief.c - another thread computes while a job takes long.
 *
 * Room:     service. See relief.h.
 * Does:     one timer, which is set only while a job waits for another.
 * Threads:  [loop]
 */
#include "relief.h"

#include "host.h"
#include "invariant.h"
#include "log.h"
#include "loop.h"
#include "now.h"
#include "pccd_types.h"

#define NS_PER_MS 1000000u

/* Threads or memory may be there again then. */
#define RETRY_NS 1000000000u

static bool start_runner(struct srv_loop *loop)
{
    uint32_t number = loop->compute.runner_count;
    int status = srv_desk_init(loop->desks, number);
    if (status == 0) {
        status = srv_host_start_runner(loop);
    }
    if (status != 0) {
        loop->relief.retry_ns = srv_now_ns() + RETRY_NS;
        srv_log(SRV_LOG_WARN, 0,
                "no threads to compute beside %u requests that take long; others wait",
                number);
        return false;
    }
    srv_log(SRV_LOG_INFO, 0,
            "%u requests take long: others are computed beside them from now on", number);
    return true;
}

static void look(struct srv_loop *loop)
{
    struct srv_relief *relief = &loop->relief;
    bool wants_runner = false;
    uint64_t after_ns = srv_compute_look(&loop->compute, &wants_runner);
    if (wants_runner) {
        bool can_try = srv_now_ns() >= relief->retry_ns;
        after_ns = can_try && start_runner(loop) ? SRV_LONG_NS : RETRY_NS;
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
    struct srv_loop *loop = context;
    srv_assert_loop();
    if (!loop->relief.is_set && loop->relief.timer != NULL) {
        look(loop);
    }
}

int srv_relief_init(struct srv_loop *loop)
{
    loop->relief.timer = srv_timer_new(loop, on_timer, loop);
    return loop->relief.timer != NULL ? 0 : PCCD_E_NOMEM;
}

void srv_relief_deinit(struct srv_loop *loop)
{
    srv_timer_free(loop->relief.timer);
    loop->relief.timer = NULL;
}

void srv_relief_begin(struct srv_loop *loop)
{
    loop->compute.crowded = on_crowded;
}

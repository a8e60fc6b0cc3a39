/* heartbeat.c - what the service manager is told while the loop turns.
 *
 * Beat twice in the time that the watchdog waits, from the loop itself: when it is stuck,
 * so are the beats. Nor does it while a thread that computes is stuck; one that computes
 * for long is not.
 */
#include "notify.h"

#include <inttypes.h>
#include <stdio.h>
#include <string.h>

#include "printable.h"
#include "service.h"

#define CHANGE_MS 1000u

/* Append what is served now, if that is news. */
static void add_status(struct srv_heartbeat *heartbeat, char *lines, size_t bytes)
{
    uint32_t clients = heartbeat->service->client_count;
    uint64_t steps = heartbeat->service->metrics.counters.steps;
    size_t used = strlen(lines);
    if (clients == heartbeat->reported_clients && steps == heartbeat->reported_steps) {
        return;
    }
    heartbeat->reported_clients = clients;
    heartbeat->reported_steps = steps;
    snprintf(lines + used, bytes - used, "%sSTATUS=%" PRIu32 " %s, %" PRIu64 " %s",
             used > 0 ? "\n" : "", clients, proto_plural(clients, "client", "clients"),
             steps, proto_plural(steps, "step", "steps"));
}

/* Return whether all is well, and say once if it is not. */
static bool is_well(struct srv_heartbeat *heartbeat)
{
    bool is_stuck = srv_compute_is_stuck(&heartbeat->service->compute);
    if (is_stuck && !heartbeat->is_stuck) {
        srv_log(SRV_LOG_ERROR, 0,
                "a thread that computes is stuck; the watchdog is not "
                "told any more that all is well");
    }
    heartbeat->is_stuck = is_stuck;
    return !is_stuck;
}

static void on_timer(uv_timer_t *timer)
{
    struct srv_heartbeat *heartbeat = timer->data;
    char lines[96] = "";
    if (heartbeat->beats && is_well(heartbeat)) {
        strcpy(lines, "WATCHDOG=1");
    }
    add_status(heartbeat, lines, sizeof lines);
    if (lines[0] != '\0') {
        srv_notify_say(lines);
    }
}

void srv_heartbeat_init(struct srv_heartbeat *heartbeat, uv_loop_t *uv,
                        struct srv_service *service)
{
    *heartbeat = (struct srv_heartbeat){.service = service};
    uv_timer_init(uv, &heartbeat->timer);
    heartbeat->timer.data = heartbeat;
}

void srv_heartbeat_ready(struct srv_heartbeat *heartbeat)
{
    uint64_t half_ms = srv_notify_watchdog_us() / 2000u;
    if (!srv_notify_is_open()) {
        return;
    }
    if (heartbeat->service->options->listen_fd < 0) {
        srv_notify_ready();
    } else {
        srv_notify_announce("READY=1");
    }
    srv_notify_say("STATUS=0 clients, 0 steps");
    if (srv_notify_watchdog_us() > 0) {
        heartbeat->beats = true;
        half_ms = half_ms > 0 ? half_ms : 1;
        uv_timer_start(&heartbeat->timer, on_timer, 0, half_ms);
    }
}

void srv_heartbeat_change(struct srv_heartbeat *heartbeat)
{
    if (srv_notify_is_open() && !heartbeat->beats &&
        !uv_is_closing((uv_handle_t *)&heartbeat->timer) &&
        !uv_is_active((uv_handle_t *)&heartbeat->timer)) {
        uv_timer_start(&heartbeat->timer, on_timer, CHANGE_MS, 0);
    }
}

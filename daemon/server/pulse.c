/* pulse.c - what the service manager is told while the loop turns.
 *
 * Room:     server. See pulse.h.
 * Does:     beat twice in the time that the watchdog waits, from the loop itself: when it
 *           is stuck, so are the beats. Nor does it while a thread that computes is
 *           stuck; one that computes for long is not.
 * Threads:  [loop]
 */
#include "pulse.h"

#include <inttypes.h>
#include <stdio.h>
#include <string.h>

#include "loop.h"
#include "notify.h"
#include "plural.h"

#define CHANGE_MS 1000u

/* Append what is served now, if that is news. */
static void add_status(struct srv_pulse *pulse, char *lines, size_t bytes)
{
    uint32_t clients = pulse->loop->client_count;
    uint64_t steps = pulse->loop->metrics.counters.steps;
    size_t used = strlen(lines);
    if (clients == pulse->told_clients && steps == pulse->told_steps) {
        return;
    }
    pulse->told_clients = clients;
    pulse->told_steps = steps;
    snprintf(lines + used, bytes - used, "%sSTATUS=%" PRIu32 " %s, %" PRIu64 " %s",
             used > 0 ? "\n" : "", clients, proto_plural(clients, "client", "clients"),
             steps, proto_plural(steps, "step", "steps"));
}

/* Whether all is well, and say once if it is not. */
static bool is_well(struct srv_pulse *pulse)
{
    bool is_stuck = srv_stuck_look(&pulse->stuck, &pulse->loop->compute);
    if (is_stuck && !pulse->is_stuck) {
        srv_log(SRV_LOG_ERROR, 0,
                "a thread that computes is stuck; the watchdog is not "
                "told any more that all is well");
    }
    pulse->is_stuck = is_stuck;
    return !is_stuck;
}

static void on_timer(uv_timer_t *timer)
{
    struct srv_pulse *pulse = timer->data;
    char lines[96] = "";
    if (pulse->beats && is_well(pulse)) {
        strcpy(lines, "WATCHDOG=1");
    }
    add_status(pulse, lines, sizeof lines);
    if (lines[0] != '\0') {
        srv_notify_say(lines);
    }
}

void srv_pulse_init(struct srv_pulse *pulse, uv_loop_t *uv, struct srv_loop *loop)
{
    *pulse = (struct srv_pulse){.loop = loop};
    uv_timer_init(uv, &pulse->timer);
    pulse->timer.data = pulse;
}

void srv_pulse_ready(struct srv_pulse *pulse)
{
    uint64_t half_ms = srv_notify_watchdog_us() / 2000u;
    if (!srv_notify_is_open()) {
        return;
    }
    if (pulse->loop->options->listen_fd < 0) {
        srv_notify_ready();
    } else {
        srv_notify_announce("READY=1");
    }
    srv_notify_say("STATUS=0 clients, 0 steps");
    if (srv_notify_watchdog_us() > 0) {
        pulse->beats = true;
        half_ms = half_ms > 0 ? half_ms : 1;
        uv_timer_start(&pulse->timer, on_timer, 0, half_ms);
    }
}

void srv_pulse_change(struct srv_pulse *pulse)
{
    if (srv_notify_is_open() && !pulse->beats &&
        !uv_is_closing((uv_handle_t *)&pulse->timer) &&
        !uv_is_active((uv_handle_t *)&pulse->timer)) {
        uv_timer_start(&pulse->timer, on_timer, CHANGE_MS, 0);
    }
}

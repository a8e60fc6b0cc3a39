/* wakeup.c - how another thread wakes the loop, and when it stays awake. */
#include "watch.h"

#include <errno.h>
#include <stdbool.h>
#include <stdint.h>
#include <sys/eventfd.h>
#include <unistd.h>

#include "invariant.h"
#include "now.h"
#include "pccd_types.h"

#define TRIES 1000 /* for calls that a signal interrupts */

static void on_poll(uv_poll_t *poll, int status, int events)
{
    struct srv_wakeup *wakeup = (struct srv_wakeup *)poll;
    uint64_t rings = 0;
    (void)status;
    (void)events;
    /* When it fails, the loop finds the wakeup rung once more. */
    ssize_t bytes = read(wakeup->fd, &rings, sizeof rings);
    (void)bytes;
    wakeup->heard(wakeup->context);
}

int srv_wakeup_init(struct srv_wakeup *wakeup, uv_loop_t *loop,
                    void (*heard)(void *context), void *context)
{
    *wakeup = (struct srv_wakeup){.heard = heard, .context = context};
    wakeup->fd = eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK);
    if (wakeup->fd < 0) {
        return PCCD_E_SYSTEM;
    }
    if (uv_poll_init(loop, &wakeup->poll, wakeup->fd) != 0) {
        close(wakeup->fd);
        return PCCD_E_SYSTEM;
    }
    int status = srv_watch_start(&wakeup->poll, wakeup->fd, UV_READABLE, on_poll);
    if (status != 0) {
        srv_wakeup_close(wakeup);
    }
    return status;
}

void srv_wakeup_ring(struct srv_wakeup *wakeup)
{
    const uint64_t one = 1;
    /* Full (EAGAIN) means rung already. */
    for (int i = 0; i < TRIES; i++) {
        if (write(wakeup->fd, &one, sizeof one) == (ssize_t)sizeof one ||
            errno == EAGAIN) {
            return;
        }
    }
    srv_assert_failed("the loop can be woken", __FILE__, __LINE__);
}

void srv_wakeup_close(struct srv_wakeup *wakeup)
{
    uv_close((uv_handle_t *)&wakeup->poll, NULL); /* stops it, too */
    close(wakeup->fd);
}

/* ---- staying awake ----------------------------------------------------------------- */

#define AWAKE_NS    50000u
#define IN_VAIN_MAX 8u

/* It ends, in vain or not. */
static void end(struct srv_awake *awake, bool was_in_vain)
{
    uint32_t count = was_in_vain ? awake->in_vain + 1 : 0;
    awake->in_vain = count < IN_VAIN_MAX ? count : IN_VAIN_MAX;
    awake->skip = count > 0 ? 1u << awake->in_vain : 0;
    uv_idle_stop(&awake->idle);
}

/* Between two looks. */
static void on_idle(uv_idle_t *idle)
{
    struct srv_awake *awake = (struct srv_awake *)idle;
    if (awake->service->metrics.counters.messages != awake->messages_seen) {
        end(awake, false);
    } else if (common_now_ns() >= awake->until_ns) {
        end(awake, true);
    }
}

void srv_awake_init(struct srv_awake *awake, uv_loop_t *loop,
                    const struct srv_service *service)
{
    *awake = (struct srv_awake){.service = service};
    uv_idle_init(loop, &awake->idle);
}

void srv_awake_before_wait(struct srv_awake *awake)
{
    const struct proto_STATS_result *counters = &awake->service->metrics.counters;
    bool has_stepped = counters->steps_brief != awake->steps_seen;
    awake->steps_seen = counters->steps_brief;
    if (!has_stepped || counters->processors < 2 ||
        awake->service->phase != SRV_PHASE_RUNNING) {
        return;
    }
    if (awake->skip > 0) {
        awake->skip--;
        return;
    }
    awake->messages_seen = counters->messages;
    awake->until_ns = common_now_ns() + AWAKE_NS;
    uv_idle_start(&awake->idle, on_idle);
}

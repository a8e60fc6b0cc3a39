/* wakeup.c - how another thread wakes the loop. */
#include "watch.h"

#include <errno.h>
#include <stdbool.h>
#include <stdint.h>
#include <sys/eventfd.h>
#include <unistd.h>

#include "invariant.h"
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

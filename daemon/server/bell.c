/* bell.c - how another thread wakes the loop.
 *
 * Room:     server. See bell.h.
 * Does:     one write, and one read; neither waits.
 * Threads:  functions say.
 */
#include "bell.h"

#include <errno.h>
#include <stdbool.h>
#include <stdint.h>
#include <sys/eventfd.h>
#include <unistd.h>

#include "invariant.h"
#include "pccd_types.h"
#include "watch.h"

#define TRIES 1000 /* for calls that a signal interrupts */

static void on_poll(uv_poll_t *poll, int status, int events)
{
    struct srv_bell *bell = (struct srv_bell *)poll;
    uint64_t rings = 0;
    (void)status;
    (void)events;
    /* When it fails, the loop finds the bell rung once more. */
    ssize_t bytes = read(bell->fd, &rings, sizeof rings);
    (void)bytes;
    bell->heard(bell->context);
}

int srv_bell_init(struct srv_bell *bell, uv_loop_t *loop, void (*heard)(void *context),
                  void *context)
{
    *bell = (struct srv_bell){.heard = heard, .context = context};
    bell->fd = eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK);
    if (bell->fd < 0) {
        return PCCD_E_SYSTEM;
    }
    if (uv_poll_init(loop, &bell->poll, bell->fd) != 0) {
        close(bell->fd);
        return PCCD_E_SYSTEM;
    }
    int status = srv_watch_start(&bell->poll, bell->fd, UV_READABLE, on_poll);
    if (status != 0) {
        srv_bell_close(bell);
    }
    return status;
}

void srv_bell_ring(struct srv_bell *bell)
{
    const uint64_t one = 1;
    /* Full (EAGAIN) means rung already. */
    for (int i = 0; i < TRIES; i++) {
        if (write(bell->fd, &one, sizeof one) == (ssize_t)sizeof one || errno == EAGAIN) {
            return;
        }
    }
    srv_assert_failed("the loop can be woken", __FILE__, __LINE__);
}

void srv_bell_close(struct srv_bell *bell)
{
    uv_close((uv_handle_t *)&bell->poll, NULL); /* stops it, too */
    close(bell->fd);
}

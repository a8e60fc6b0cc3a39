/* wakeup.h - lets another thread wake the event loop.
 *
 * Room:     server. May include: libuv.
 * Does:     own an eventfd that any thread writes to and the loop waits for.
 * Does not: count: several wake-ups before the loop looks are one.
 * Threads:  functions say.
 * Source:   in the place of uv_async_send, which is not safe against being preempted in
 *           it: libuv 1.44's loop, woken, yields its processor until the sender has
 *           returned. Where both share a processor, and the sender goes on with a long
 *           job, the answer waits for that job: 5 ms, seen with the kernel's tracer.
 */
#ifndef SRV_WAKEUP_H
#define SRV_WAKEUP_H

#include <uv.h>

struct srv_wakeup {
    uv_poll_t poll; /* first: the handle that is closed */
    void (*heard)(void *context);
    void *context;
    int fd;
};

/* `heard` is called on [loop] after each ring, or after some. Returns 0, or PCCD_E_SYSTEM
 * with nothing left open. [loop] */
int srv_wakeup_init(struct srv_wakeup *wakeup, uv_loop_t *loop,
                    void (*heard)(void *context), void *context);

/* What was written before is seen by `heard`. [any] */
void srv_wakeup_ring(struct srv_wakeup *wakeup);

/* Nobody rings any more. The memory may go when the loop has closed handles. [loop] */
void srv_wakeup_close(struct srv_wakeup *wakeup);

#endif

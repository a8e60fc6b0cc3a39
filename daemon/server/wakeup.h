/* wakeup.h - lets another thread wake the event loop. */
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

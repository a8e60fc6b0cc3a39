/* watch.h - guards libuv's polling; wakes the event loop, and closes for it. */
#ifndef SRV_WATCH_H
#define SRV_WATCH_H

#include <stdbool.h>
#include <stdint.h>
#include <uv.h>

/* Let the system's table have room for `count` descriptors, if it may. Before there is a
 * second thread: then every growth waits until all processors have seen the old table
 * out of use, some 10 ms. [main] */
void srv_watch_widen(uint32_t count);

/* Let libuv's table have room for descriptors below *count, or for as many as this
 * process may have: then *count is that number. `poll` is closed again before the loop
 * waits; `fd` is any descriptor that can be polled. Returns 0 or PCCD_E_SYSTEM. */
int srv_watch_reserve(uv_loop_t *loop, uv_poll_t *poll, int fd, uint32_t *count);

/* uv_poll_start. PCCD_E_SYSTEM: epoll has no room for it; nothing is watched then. */
int srv_watch_start(uv_poll_t *poll, int fd, int events, uv_poll_cb on_poll);

/* Return whether the peer of a connected socket has closed it, or both ways of it, by
 * now. False also where the system does not say. */
bool srv_watch_has_ended(int fd);

/* ---- Lets another thread wake the event loop. */

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

/* Wake the loop: what was written before is seen by `heard`. [any] */
void srv_wakeup_ring(struct srv_wakeup *wakeup);

/* Nobody rings any more. The memory may go when the loop has closed handles. [loop] */
void srv_wakeup_close(struct srv_wakeup *wakeup);

/* ---- Closes descriptors on a thread of its own, because close(2) may block.
 *
 * Close whatever a client has sent or holds. A client can make close(2) block for as long
 * as it likes: it can send a socket that lingers, or a file of a file system that it
 * serves itself, even as an unread message. */

struct srv_closer;

/* Start the thread, all signals blocked in it. NULL: no memory or no thread. [loop] */
struct srv_closer *srv_closer_new(void);

/* Wait a second for what is left, then leave it to the end of the process. [loop] */
void srv_closer_free(struct srv_closer *closer);

/* Close `fd` soon. Waits while there are many that do close. [loop] */
void srv_closer_push(struct srv_closer *closer, int fd);

#endif

/* watch.h - guards libuv's polling; wakes the loop, keeps it awake, and closes for it. */
#ifndef SRV_WATCH_H
#define SRV_WATCH_H

#include <stdbool.h>
#include <stdint.h>
#include <uv.h>

#include "service.h"

/* Let the system's table have room for `count` descriptors, if it may. Before there is a
 * second thread: then every growth waits until all processors have seen the old table
 * out of use, some 10 ms. [main] */
void srv_watch_widen(uint32_t count);

/* Let libuv's table have room for descriptors below *count, or for as many as this
 * process may have: then *count is that number. `poll` is closed again before the loop
 * waits; `fd` is any descriptor that can be polled. Returns 0 or PCCD_E_SYSTEM. */
int srv_watch_reserve(uv_loop_t *loop, uv_poll_t *poll, int fd, uint32_t *count);

/* Watch `fd`, as uv_poll_start does. Returns 0, or PCCD_E_SYSTEM: epoll has no room for
 * it; nothing is watched then. */
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

/* Prepare to be woken: `heard` is called on [loop] after each ring, or after some.
 * Returns 0, or PCCD_E_SYSTEM with nothing left open. [loop] */
int srv_wakeup_init(struct srv_wakeup *wakeup, uv_loop_t *loop,
                    void (*heard)(void *context), void *context);

/* Wake the loop: what was written before is seen by `heard`. [any] */
void srv_wakeup_ring(struct srv_wakeup *wakeup);

/* Close it, as nobody rings any more. The memory may go when the loop has closed handles.
 * [loop] */
void srv_wakeup_close(struct srv_wakeup *wakeup);

/* ---- Lets the loop stay awake for a client that asks again at once.
 *
 * A client that asks for one small step after another sends the next message some
 * microseconds after an answer. To fall asleep and be woken is 15 us, more than the step,
 * where its processor sleeps meanwhile. So the loop looks for messages for 50 us after
 * steps that it has computed itself. Where nothing came in that time, n times in a row,
 * the next 2^n such steps go without: a client that asks now and then, or waits for this
 * very processor, costs 50 us in 257 steps. The number of steps from one try to the next
 * is odd, so that of two steps by turns both are tried. */

struct srv_awake {
    uv_idle_t idle; /* first: the handle that is closed; active: the loop does not wait */
    const struct srv_service *service;
    uint64_t until_ns;
    uint64_t steps_seen;    /* brief ones, at the last wait */
    uint64_t messages_seen; /* when it began to stay awake */
    uint32_t in_vain;       /* the last times, in a row */
    uint32_t skip;          /* steps that are still to go without */
};

void srv_awake_init(struct srv_awake *awake, uv_loop_t *loop,
                    const struct srv_service *service);

/* Choose whether to stay awake; before each wait, when answers are on their way. */
void srv_awake_before_wait(struct srv_awake *awake);

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

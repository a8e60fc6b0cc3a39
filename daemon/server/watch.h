/* watch.h - guards libuv's polling against the cases in which libuv would end the
 * process.
 */
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

/* Whether the peer of a connected socket has closed it, or both ways of it, by now.
 * False also where the system does not say. */
bool srv_watch_has_ended(int fd);

#endif

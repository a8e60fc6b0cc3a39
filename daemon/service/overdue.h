/* overdue.h - steps whose deadline may come before their turn.
 *
 * Room:     service. May include: libuv.
 * Does:     keep the requests with a deadline, the earliest first, and say when it has
 *           come (srv_request_overdue).
 * Does not: answer them.
 * Threads:  [loop]
 */
#ifndef SRV_OVERDUE_H
#define SRV_OVERDUE_H

#include <stdint.h>
#include <uv.h>

struct srv_request;

struct srv_overdue {
    uv_timer_t timer;
    struct srv_request **heap; /* [capacity] earliest deadline first */
    uint32_t count;
    uint32_t capacity;
};

void srv_overdue_init(struct srv_overdue *overdue, uv_loop_t *loop);
/* Nothing may be in it. */
void srv_overdue_close(struct srv_overdue *overdue);

/* Wait for request->deadline_ns. Without the memory for it the request is answered in its
 * turn. */
void srv_overdue_add(struct srv_overdue *overdue, struct srv_request *request);
/* No longer, if it does. */
void srv_overdue_remove(struct srv_overdue *overdue, struct srv_request *request);

#endif

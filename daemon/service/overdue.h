/* overdue.h - steps whose deadline may come before their turn.
 *
 * Room:     service. May include: host.h.
 * Does:     keep the requests with a deadline, the earliest first, and say when it has
 *           come (srv_request_overdue).
 * Does not: answer them.
 * Threads:  [loop]
 */
#ifndef SRV_OVERDUE_H
#define SRV_OVERDUE_H

#include <stdint.h>

struct srv_loop;
struct srv_request;
struct srv_timer;

struct srv_overdue {
    struct srv_timer *timer;
    struct srv_request **heap; /* [capacity] earliest deadline first */
    uint32_t count;
    uint32_t capacity;
};

/* Returns 0 or PCCD_E_NOMEM. */
int srv_overdue_init(struct srv_overdue *overdue, struct srv_loop *loop);
/* Nothing may be in it. */
void srv_overdue_deinit(struct srv_overdue *overdue);

/* Room for one more. Returns 0 or PCCD_E_NOMEM. */
int srv_overdue_reserve(struct srv_overdue *overdue);
/* Wait for request->deadline_ns; there is room for it. */
void srv_overdue_add(struct srv_overdue *overdue, struct srv_request *request);
/* No longer, if it does. */
void srv_overdue_remove(struct srv_overdue *overdue, struct srv_request *request);

#endif

/* deadlines.h - a list of deadlines, the earliest first. */
#ifndef SRV_DEADLINES_H
#define SRV_DEADLINES_H

#include <stdint.h>

struct srv_service;
struct srv_timer;

#define SRV_DEADLINE_NOWHERE UINT32_MAX

struct srv_deadline {
    uint64_t at_ns; /* common_now_ns */
    uint32_t place; /* in the heap; SRV_DEADLINE_NOWHERE: it is not waited for */
};

struct srv_deadlines {
    struct srv_timer *timer;
    void (*come)(struct srv_deadline *deadline);
    struct srv_deadline **heap; /* [capacity] earliest first */
    uint32_t count;
    uint32_t capacity;
};

/* Prepare `deadlines`, zeroed before: `come` is called with each deadline that has come,
 * which is not waited for any more. Returns 0 or PCCD_E_NOMEM. */
int srv_deadlines_init(struct srv_deadlines *deadlines, struct srv_service *service,
                       void (*come)(struct srv_deadline *deadline));
/* Free what it has; none may be waited for. Does nothing a second time. */
void srv_deadlines_deinit(struct srv_deadlines *deadlines);

/* Make room for one more. Returns 0 or PCCD_E_NOMEM. */
int srv_deadlines_reserve(struct srv_deadlines *deadlines);
/* Wait for deadline->at_ns; there is room for it. */
void srv_deadlines_add(struct srv_deadlines *deadlines, struct srv_deadline *deadline);
/* Stop waiting for a deadline, if it is waited for. */
void srv_deadlines_remove(struct srv_deadlines *deadlines, struct srv_deadline *deadline);

#endif

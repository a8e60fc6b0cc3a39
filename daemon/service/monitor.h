/* monitor.h - clients that are told of steps.
 *
 * Room:     service. May include: the protocol's headers.
 * Does:     keep, for each session that watches, the steps that its client has not been
 *           sent yet: PROTO_WATCH_ROOM of them; more are lost, and counted.
 * Does not: ever let a watcher that does not read hold anything up, or be dropped for
 *           what it did not ask for one by one: a step is sent when nothing else waits
 *           to be.
 * Threads:  [loop]
 */
#ifndef SRV_MONITOR_H
#define SRV_MONITOR_H

#include <stdint.h>

#include "messages.h"

struct srv_request;
struct srv_session;

struct srv_monitor {
    struct srv_monitor *next; /* of the loop's list */
    struct srv_session *session;
    uint64_t of_session; /* 0: everybody's */
    uint32_t of_scene;   /* 0: all */
    uint64_t lost;       /* since the start */
    uint64_t lost_now;   /* since the step told last */
    uint32_t first;      /* of the ring */
    uint32_t count;
    struct proto_STEP_request ring[PROTO_WATCH_ROOM];
};

/* Begin, with another choice if the session watches already. Returns 0 or PCCD_E_NOMEM.
 * The caller has seen to it that the session may. */
int srv_monitor_start(struct srv_session *session, uint64_t of_session,
                      uint32_t of_scene);
/* End, if the session watches; how many steps it was not told. */
uint64_t srv_monitor_stop(struct srv_session *session);

/* A step was answered: its request knows how. */
void srv_monitor_step(const struct srv_request *request, uint64_t number);

/* The session's connection takes messages again. */
void srv_monitor_flush(struct srv_session *session);

#endif

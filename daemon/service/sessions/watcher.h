/* watcher.h - tells clients that asked for it of each step that the daemon computes
 * (`pccdctl watch`).
 */
#ifndef SRV_WATCHER_H
#define SRV_WATCHER_H

#include <stdint.h>

#include "messages.h"

struct srv_service;
struct srv_session;

struct srv_watcher {
    struct srv_watcher *next; /* of the loop's list */
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
int srv_watcher_start(struct srv_session *session, uint64_t of_session,
                      uint32_t of_scene);
/* End, if the session watches. Returns how many steps it was not told. */
uint64_t srv_watcher_stop(struct srv_session *session);

/* Tell those who watch its session and scene that a step was answered. */
void srv_watcher_step(const struct srv_service *service,
                      const struct proto_STEP_request *step);

/* Tell the session the steps that wait, as its connection takes messages again. */
void srv_watcher_flush(struct srv_session *session);

#endif

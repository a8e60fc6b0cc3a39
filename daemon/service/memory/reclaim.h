/* reclaim.h - gives the memory of large answers back to the system when the client is
 * idle.
 *
 * Threads: [loop], but for the jobs.
 *
 * For example, an answer of 6 MiB is followed by silence: half a second to a second
 * later the result region (ringio.h) is back at its first 64 KiB, the slots that the
 * client does not need have no memory, and the user's quota says so.
 */
#ifndef SRV_RECLAIM_H
#define SRV_RECLAIM_H

#include <stdbool.h>

#include "compute.h"
#include "resource.h"

struct srv_service;
struct srv_timer;

/* Who has memory to give back: part of a resource. */
struct srv_reclaimed {
    struct srv_job job; /* first: gives it back */
    struct srv_resource *resource;
    struct srv_reclaim *list; /* that it is in; NULL: none */
    struct srv_reclaimed *prev;
    struct srv_reclaimed *next;
    bool is_page_job; /* on [pages], else on [compute] */
    bool was_used;    /* since the timer last fired */
    bool is_idle;     /* within the timer's function */
};

/* Zeroed before; until srv_reclaim_init nothing is given back. */
struct srv_reclaim {
    struct srv_timer *timer;
    struct srv_reclaimed *first; /* what has memory to give back; the timer is set */
};

/* Returns 0 or PCCD_E_NOMEM. Only for a host whose timers fire by themselves. */
int srv_reclaim_init(struct srv_reclaim *reclaim, struct srv_service *service);
/* A second time is nothing. */
void srv_reclaim_deinit(struct srv_reclaim *reclaim);

/* `give_back` is run in the turn of the resource's owner, on [pages] or [compute]. */
void srv_reclaimed_init(struct srv_reclaimed *reclaimed, struct srv_resource *resource,
                        bool is_page_job, srv_job_fn give_back);
/* Give back now, in that turn, whether it was used or not. [loop] */
void srv_reclaimed_start(struct srv_reclaimed *reclaimed);
/* It has memory to give back, and was used now. */
void srv_reclaimed_use(struct srv_reclaimed *reclaimed, struct srv_reclaim *reclaim);
/* It is going to be freed. */
void srv_reclaimed_forget(struct srv_reclaimed *reclaimed);

#endif

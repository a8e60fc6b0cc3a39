/* reclaim.c - memory that answers have needed goes back to the system when the client
 * is idle.
 */
#include "ringio.h"

#include "host.h"
#include "invariant.h"
#include "pccd_types.h"

#define PERIOD_MS 500u

static void on_given(struct srv_job *job)
{
    struct srv_reclaimed *reclaimed = (struct srv_reclaimed *)job;
    struct srv_resource *resource = reclaimed->resource;
    struct srv_owner *owner = resource->owner;
    srv_resource_drop(resource);
    srv_owner_release(owner);
}

/* In the turn of the owner: behind all that it has asked of that thread. */
void srv_reclaimed_start(struct srv_reclaimed *reclaimed)
{
    srv_assert_loop();
    struct srv_resource *resource = reclaimed->resource;
    struct srv_owner *owner = resource->owner;
    if (reclaimed->job.state != SRV_JOB_IDLE) {
        return; /* it still runs */
    }
    srv_resource_acquire(resource);
    srv_owner_keep(owner);
    if (reclaimed->is_page_job) {
        srv_compute_push_reap(owner->pages, &owner->page_job_list, &reclaimed->job);
    } else {
        srv_compute_push_reap(owner->compute, &owner->job_list, &reclaimed->job);
    }
}

static void on_timer(void *context)
{
    struct srv_reclaim *reclaim = context;
    /* Requests in flight have references beside the session's; so have the jobs that are
     * started below, and a resource may have two. */
    for (struct srv_reclaimed *at = reclaim->first; at != NULL; at = at->next) {
        at->is_idle = !at->was_used && at->resource->refs == 1;
        at->was_used = false;
    }
    for (struct srv_reclaimed *at = reclaim->first; at != NULL;) {
        struct srv_reclaimed *next = at->next;
        if (at->is_idle) {
            srv_reclaimed_forget(at);
            srv_reclaimed_start(at);
        }
        at = next;
    }
    if (reclaim->first != NULL) {
        srv_timer_start(reclaim->timer, PERIOD_MS, 0);
    }
}

void srv_reclaimed_init(struct srv_reclaimed *reclaimed, struct srv_resource *resource,
                        bool is_page_job, srv_job_fn give_back)
{
    *reclaimed = (struct srv_reclaimed){.resource = resource, .is_page_job = is_page_job};
    srv_job_init(&reclaimed->job, give_back, on_given);
}

void srv_reclaimed_use(struct srv_reclaimed *reclaimed, struct srv_reclaim *reclaim)
{
    srv_assert_loop();
    reclaimed->was_used = true;
    if (reclaimed->list != NULL || reclaim->timer == NULL) {
        return;
    }
    if (reclaim->first == NULL) {
        srv_timer_start(reclaim->timer, PERIOD_MS, 0);
    } else {
        reclaim->first->prev = reclaimed;
    }
    reclaimed->list = reclaim;
    reclaimed->next = reclaim->first;
    reclaimed->prev = NULL;
    reclaim->first = reclaimed;
}

void srv_reclaimed_forget(struct srv_reclaimed *reclaimed)
{
    struct srv_reclaim *reclaim = reclaimed->list;
    if (reclaim == NULL) {
        return;
    }
    if (reclaimed->prev != NULL) {
        reclaimed->prev->next = reclaimed->next;
    } else {
        reclaim->first = reclaimed->next;
    }
    if (reclaimed->next != NULL) {
        reclaimed->next->prev = reclaimed->prev;
    }
    reclaimed->list = NULL;
}

int srv_reclaim_init(struct srv_reclaim *reclaim, struct srv_service *service)
{
    reclaim->timer = srv_timer_new(service, on_timer, reclaim);
    return reclaim->timer != NULL ? 0 : PCCD_E_NOMEM;
}

void srv_reclaim_deinit(struct srv_reclaim *reclaim)
{
    srv_timer_free(reclaim->timer);
    reclaim->timer = NULL;
}

/* resource.c - what a session holds and the compute thread uses, until nobody does. */
#include "resource.h"

#include "enginemem.h"
#include "invariant.h"

void srv_owner_keep(struct srv_owner *owner)
{
    srv_assert_loop();
    owner->keep_count++;
}

void srv_owner_release(struct srv_owner *owner)
{
    srv_assert_loop();
    PCCD_ASSERT(owner->keep_count > 0);
    owner->keep_count--;
    owner->settle(owner);
}

/* [compute] */
static void reap(struct srv_job *job)
{
    struct srv_resource *resource = (struct srv_resource *)job;
    struct srv_enginemem memory;
    srv_enginemem_begin(&memory, resource->owner->user);
    resource->free_engine(job);
    srv_enginemem_end(&memory);
}

void srv_resource_init(struct srv_resource *resource, struct srv_owner *owner,
                       srv_job_fn free_engine, srv_job_fn free_rest)
{
    srv_job_init(&resource->reap, reap, free_rest);
    resource->free_engine = free_engine;
    resource->owner = owner;
    resource->refs = 1;
}

void srv_resource_acquire(struct srv_resource *resource)
{
    srv_assert_loop();
    PCCD_ASSERT(resource->refs > 0);
    resource->refs++;
}

void srv_resource_drop(struct srv_resource *resource)
{
    srv_assert_loop();
    PCCD_ASSERT(resource->refs > 0);
    if (--resource->refs > 0) {
        return;
    }
    struct srv_owner *owner = resource->owner;
    srv_owner_keep(owner);
    if (resource->is_ring) {
        srv_job_init(&resource->reap, resource->free_engine, resource->reap.done);
        srv_compute_push_reap(owner->pages, &owner->page_job_list, &resource->reap);
    } else {
        srv_compute_push_reap(owner->compute, &owner->job_list, &resource->reap);
    }
}

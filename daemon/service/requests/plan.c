/* plan.c - what a handler asks for: what a request will do, and what it uses
 * meanwhile.
 */
#include "plan.h"

#include "tracing.h"

void srv_plan_acquire(const struct srv_plan *plan)
{
    if (plan->ring != NULL) {
        srv_resource_acquire(&plan->ring->resource);
    }
    if (plan->shape != NULL) {
        srv_resource_acquire(&plan->shape->resource);
    }
    if (plan->scene !=
        NULL) { /* list.pair's may be another session's, which then stays */
        srv_resource_acquire(&plan->scene->resource);
        srv_owner_keep(plan->scene->resource.owner);
    }
    if (plan->tracing != NULL) {
        srv_resource_acquire(&plan->tracing->resource);
    }
}

void srv_plan_release(const struct srv_plan *plan)
{
    if (plan->ring != NULL) {
        srv_resource_drop(&plan->ring->resource);
    }
    if (plan->shape != NULL) {
        srv_resource_drop(&plan->shape->resource);
    }
    if (plan->scene != NULL) {
        struct srv_owner *owner = plan->scene->resource.owner;
        srv_resource_drop(&plan->scene->resource);
        srv_owner_release(owner);
    }
    if (plan->tracing != NULL) {
        srv_resource_drop(&plan->tracing->resource);
    }
}

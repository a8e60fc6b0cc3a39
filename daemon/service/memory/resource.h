/* resource.h - reference counts for what a session owns while the compute thread uses it.
 *
 * Count the references of meshes' shapes, scenes, rings and recordings. When the last one
 * goes, free the engine's part on the compute thread and the rest on the loop, in the
 * turn of its owner.
 */
#ifndef SRV_RESOURCE_H
#define SRV_RESOURCE_H

#include <stdbool.h>
#include <stdint.h>

#include "compute.h"
#include "quota.h"

/* Whoever has resources: the part of a session that they know. */
struct srv_owner {
    struct srv_quota_user *user;       /* who pays */
    struct srv_compute *compute;       /* frees what the engine has; constant */
    struct srv_compute *pages;         /* makes and frees rings: 2 us a page; constant */
    struct srv_job_list job_list;      /* of `compute` */
    struct srv_job_list page_job_list; /* of `pages` */
    uint32_t keep_count; /* [loop] reasons to stay: resources being freed, and
                                  * requests of others that use one of its scenes */
    void (*settle)(struct srv_owner *owner); /* [loop] one reason fewer */
};

/* Add a reason to stay. [loop] */
void srv_owner_keep(struct srv_owner *owner);
/* Drop a reason to stay: the owner may be freed inside. [loop] */
void srv_owner_release(struct srv_owner *owner);

/* The common start of a shape, a scene, a ring and a recording. */
struct srv_resource {
    struct srv_job reap; /* first: the job is the resource */
    srv_job_fn free_engine;
    bool
        is_ring; /* freed on the thread that makes rings; nothing of it is the engine's */
    struct srv_owner *owner;
    uint32_t refs; /* [loop] the session's table, and each request in flight */
};

/* Begin a resource with one reference. When the last is dropped, `free_engine` runs on
 * [compute], that of a ring on [pages], then `free_rest` on [loop]; that calls
 * srv_owner_release. */
void srv_resource_init(struct srv_resource *resource, struct srv_owner *owner,
                       srv_job_fn free_engine, srv_job_fn free_rest);
/* Add a reference. [loop] */
void srv_resource_acquire(struct srv_resource *resource);
/* Drop one. [loop] */
void srv_resource_drop(struct srv_resource *resource);

#endif

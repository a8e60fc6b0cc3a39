/* quota.h - quotas: how much memory, how many clients and triangles one user may have,
 * and all users together.
 *
 * Count clients, shared memory, meshes and triangles per user id. Every amount is charged
 * before it is allocated, and released after it is freed. Bound the memory of all users:
 * what is shared and what the engine holds.
 *
 * Threads: [loop], but for shared memory, which [compute] charges and refunds as well:
 * one lock for all amounts.
 */
#ifndef SRV_QUOTA_H
#define SRV_QUOTA_H

#include <pthread.h>
#include <stdatomic.h>
#include <stdbool.h>
#include <stdint.h>
#include <sys/types.h>

#include "codec.h"
#include "compute.h"
#include "engine.h"
#include "options.h"

struct srv_quota;

struct srv_quota_user {
    struct srv_quota_user *next;
    struct srv_quota *quota;
    uid_t uid;
    uint32_t refs;            /* sessions */
    uint32_t leaving;         /* of these, over, and not freed yet */
    uint32_t keepers_leaving; /* of these, sessions that held a shared scene */
    uint32_t observers;       /* sessions that take no place of a client */
    uint32_t waiting;         /* sessions that wait for their client to come back */
    uint64_t used[SRV_QUOTA_COUNT];
    struct srv_group jobs;      /* of the user's sessions; the compute queue's */
    struct srv_group page_jobs; /* of the same sessions; the pages queue's */
    /* That the engine holds for the user's sessions. Charged on [compute]; the loop may
     * read an older value. */
    struct eng_account engine;
};

struct srv_quota {
    pthread_mutex_t lock;            /* of used, total and the limits */
    uint64_t limit[SRV_QUOTA_COUNT]; /* per user */
    uint64_t total[SRV_QUOTA_COUNT]; /* over all users */
    struct srv_quota_user *users;    /* at most one per open session */
    /* Of all users, relaxed, for [compute] only says them: */
    _Atomic uint64_t engine_bytes_max; /* that the engine holds for one user */
    _Atomic uint64_t memory_max;       /* shared and the engine's; 0: no bound */
    _Atomic uint64_t shared;           /* as total[SRV_QUOTA_SHM_BYTES] */
    _Atomic uint64_t refusals;         /* for memory_max */
    bool is_beyond; /* what was refused last is more than any user may have */
};

void srv_quota_init(struct srv_quota *quota, const uint64_t limit[SRV_QUOTA_COUNT]);
void srv_quota_deinit(struct srv_quota *quota); /* every user must have been released */

/* Let a user have at most so many from now on; what one has already stays. */
void srv_quota_set_limit(struct srv_quota *quota, enum srv_quota_kind kind,
                         uint64_t limit);

/* Let the engine hold at most so many bytes for one user from now on (enginemem.h). */
void srv_quota_bound_engine(struct srv_quota *quota, uint64_t bytes);

/* Let all users together have at most so many bytes of memory from now on; 0: no bound.
 * What they have already stays. */
void srv_quota_bound_memory(struct srv_quota *quota, uint64_t bytes);

/* Return the entry of `uid`, made when there is none, with a reference. NULL: no
 * memory. */
struct srv_quota_user *srv_quota_acquire(struct srv_quota *quota, uid_t uid);
/* Drop a reference. The entry goes with its last one; nothing may be charged to it
 * then. */
void srv_quota_release(struct srv_quota *quota, struct srv_quota_user *user);

/* Charge a user. Returns 0, or PCCD_E_QUOTA with *error naming user, or all of them,
 * amounts and limit; nothing is charged then. */
int srv_quota_charge(struct srv_quota_user *user, enum srv_quota_kind kind,
                     uint64_t amount, struct proto_error *error);
/* Charge a user for shared memory that is taken while a request is worked on. Returns as
 * srv_quota_charge. [any] */
int srv_quota_charge_shared(struct srv_quota_user *user, uint64_t amount,
                            struct proto_error *error);
/* Return whether it is more than a user, or all users, may ever have. [loop] */
bool srv_quota_is_beyond(const struct srv_quota *quota, enum srv_quota_kind kind,
                         uint64_t amount);
/* Refund what was charged. [any] for shared memory. */
void srv_quota_refund(struct srv_quota_user *user, enum srv_quota_kind kind,
                      uint64_t amount);

/* Count and explain a refusal for the bound of all users, of so many bytes. Returns
 * PCCD_E_QUOTA. [any] */
int srv_quota_refuse_memory(struct srv_quota *quota, struct proto_error *error,
                            uint64_t amount);

/* Return the charge of a mesh: its triangles, an edge or a point that is named by itself
 * being as much as one, or a third of its vertices where that is more (a soup has three a
 * triangle), so that vertices are bounded too. An object is charged the memory that it
 * takes (enginemem.h), and its triangles only in a scene of another user. */
uint64_t srv_triangle_charge(uint32_t vertex_count, uint64_t triangle_count);

#endif

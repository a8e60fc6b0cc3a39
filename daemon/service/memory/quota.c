/* quota.c - what one user may take, and all of them together.
 *
 * A short list of users, searched once per connection. What is left of the memory of all
 * users beside what is shared is the engine's ceiling: of two that ask at once, on two
 * threads, no more than there is gets any.
 */
#include "quota.h"

#include <stdlib.h>
#include <string.h>

#include "invariant.h"

static const char *const kind_names[SRV_QUOTA_COUNT] = {
    "clients", "bytes of shared memory", "meshes", "triangles"};

void srv_quota_init(struct srv_quota *quota, const uint64_t limit[SRV_QUOTA_COUNT])
{
    *quota = (struct srv_quota){.users = NULL};
    memcpy(quota->limit, limit, sizeof quota->limit);
    pthread_mutex_init(&quota->lock, NULL);
}

/* Return the memory that the engine may have. */
static uint64_t memory_left(const struct srv_quota *quota)
{
    uint64_t shared = quota->total[SRV_QUOTA_SHM_BYTES];
    return quota->memory_max == 0       ? UINT64_MAX
           : quota->memory_max > shared ? quota->memory_max - shared
                                        : 0;
}

void srv_quota_set_limit(struct srv_quota *quota, enum srv_quota_kind kind,
                         uint64_t limit)
{
    pthread_mutex_lock(&quota->lock);
    quota->limit[kind] = limit;
    pthread_mutex_unlock(&quota->lock);
}

void srv_quota_bound_engine(struct srv_quota *quota, uint64_t bytes)
{
    atomic_store_explicit(&quota->engine_bytes_max, bytes, memory_order_relaxed);
}

void srv_quota_bound_memory(struct srv_quota *quota, uint64_t bytes)
{
    pthread_mutex_lock(&quota->lock);
    quota->memory_max = bytes;
    eng_alloc_set_ceiling(memory_left(quota));
    pthread_mutex_unlock(&quota->lock);
}

/* Add to, or take from, the memory that is shared. */
static void share(struct srv_quota *quota, uint64_t more, uint64_t less)
{
    quota->total[SRV_QUOTA_SHM_BYTES] += more - less;
    atomic_store_explicit(&quota->shared, quota->total[SRV_QUOTA_SHM_BYTES],
                          memory_order_relaxed);
    eng_alloc_set_ceiling(memory_left(quota));
}

int srv_quota_refuse_memory(struct srv_quota *quota, struct proto_error *error,
                            uint64_t amount)
{
    uint64_t shared = atomic_load_explicit(&quota->shared, memory_order_relaxed);
    uint64_t max = atomic_load_explicit(&quota->memory_max, memory_order_relaxed);
    atomic_fetch_add_explicit(&quota->refusals, 1, memory_order_relaxed);
    return proto_error_set(error, PCCD_E_QUOTA,
                           "all users have %llu MiB of memory, %llu KiB more exceed the "
                           "bound of %llu MiB (pccdd --memory-total-mib)",
                           (unsigned long long)((shared + eng_alloc_bytes()) >> 20),
                           (unsigned long long)((amount + 1023) >> 10),
                           (unsigned long long)(max >> 20));
}

static int share_more(struct srv_quota *quota, uint64_t amount, struct proto_error *error)
{
    uint64_t shared = quota->total[SRV_QUOTA_SHM_BYTES];
    share(quota, amount, 0);
    uint64_t held = eng_alloc_bytes();
    if (quota->memory_max == 0 ||
        (shared + amount <= quota->memory_max && held <= memory_left(quota))) {
        return 0;
    }
    share(quota, 0, amount);
    return srv_quota_refuse_memory(quota, error, amount);
}

void srv_quota_deinit(struct srv_quota *quota)
{
    PCCD_ASSERT(quota->users == NULL);
    eng_alloc_set_ceiling(UINT64_MAX);
    pthread_mutex_destroy(&quota->lock);
}

struct srv_quota_user *srv_quota_acquire(struct srv_quota *quota, uid_t uid)
{
    struct srv_quota_user *user = quota->users;
    while (user != NULL && user->uid != uid) {
        user = user->next;
    }
    if (user == NULL) {
        user = calloc(1, sizeof *user);
        if (user == NULL) {
            return NULL;
        }
        user->uid = uid;
        user->quota = quota;
        user->next = quota->users;
        quota->users = user;
    }
    user->refs++;
    return user;
}

void srv_quota_release(struct srv_quota *quota, struct srv_quota_user *user)
{
    PCCD_ASSERT(user->refs > 0);
    if (--user->refs > 0) {
        return;
    }
    for (int kind = 0; kind < SRV_QUOTA_COUNT; kind++) {
        PCCD_ASSERT(user->used[kind] == 0);
    }
    PCCD_ASSERT(user->leaving == 0 && atomic_load(&user->engine.bytes) == 0);
    struct srv_quota_user **link = &quota->users;
    while (*link != user) {
        link = &(*link)->next;
    }
    *link = user->next;
    free(user);
}

bool srv_quota_is_beyond(const struct srv_quota *quota, enum srv_quota_kind kind,
                         uint64_t amount)
{
    return amount > quota->limit[kind] ||
           (kind == SRV_QUOTA_SHM_BYTES && quota->memory_max != 0 &&
            amount > quota->memory_max);
}

/* With the lock held. */
static int charge(struct srv_quota_user *user, enum srv_quota_kind kind, uint64_t amount,
                  struct proto_error *error)
{
    struct srv_quota *quota = user->quota;
    uint64_t used = user->used[kind];
    uint64_t limit = quota->limit[kind];
    /* Who has more than the limit had it before the limit was lowered (config.c). */
    if (amount > 0 && (used > limit || amount > limit - used)) {
        return proto_error_set(error, PCCD_E_QUOTA,
                               "user %u has %llu %s, %llu more exceed the quota of %llu",
                               (unsigned)user->uid, (unsigned long long)used,
                               kind_names[kind], (unsigned long long)amount,
                               (unsigned long long)limit);
    }
    if (kind == SRV_QUOTA_SHM_BYTES && amount > 0) {
        int status = share_more(quota, amount, error);
        if (status != 0) {
            return status;
        }
    } else {
        quota->total[kind] += amount;
    }
    user->used[kind] += amount;
    return 0;
}

int srv_quota_charge(struct srv_quota_user *user, enum srv_quota_kind kind,
                     uint64_t amount, struct proto_error *error)
{
    struct srv_quota *quota = user->quota;
    pthread_mutex_lock(&quota->lock);
    int status = charge(user, kind, amount, error);
    pthread_mutex_unlock(&quota->lock);
    if (status != 0) {
        quota->is_beyond = srv_quota_is_beyond(quota, kind, amount);
    }
    return status;
}

int srv_quota_charge_shared(struct srv_quota_user *user, uint64_t amount,
                            struct proto_error *error)
{
    struct srv_quota *quota = user->quota;
    pthread_mutex_lock(&quota->lock);
    int status = charge(user, SRV_QUOTA_SHM_BYTES, amount, error);
    pthread_mutex_unlock(&quota->lock);
    return status;
}

void srv_quota_refund(struct srv_quota_user *user, enum srv_quota_kind kind,
                      uint64_t amount)
{
    struct srv_quota *quota = user->quota;
    pthread_mutex_lock(&quota->lock);
    PCCD_ASSERT(user->used[kind] >= amount && quota->total[kind] >= amount);
    user->used[kind] -= amount;
    if (kind == SRV_QUOTA_SHM_BYTES) {
        share(quota, 0, amount);
    } else {
        quota->total[kind] -= amount;
    }
    pthread_mutex_unlock(&quota->lock);
}

uint64_t srv_triangle_charge(uint32_t vertex_count, uint64_t triangle_count)
{
    uint64_t thirds = ((uint64_t)vertex_count + 2) / 3;
    return thirds > triangle_count ? thirds : triangle_count;
}

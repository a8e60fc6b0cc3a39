/* quota.c - what one user may take.
 *
 * Room:     service. See quota.h.
 * Does:     a short list of users, searched once per connection.
 * Does not: forgive: a refund of more than was charged is our bug.
 * Threads:  [loop].
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
}

void srv_quota_deinit(struct srv_quota *quota)
{
    PCCD_ASSERT(quota->users == NULL);
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
    PCCD_ASSERT(user->leaving == 0 && user->engine_bytes == 0);
    struct srv_quota_user **link = &quota->users;
    while (*link != user) {
        link = &(*link)->next;
    }
    *link = user->next;
    free(user);
}

int srv_quota_charge(struct srv_quota *quota, struct srv_quota_user *user,
                     enum srv_quota_kind kind, uint64_t amount, struct proto_error *error)
{
    uint64_t used = user->used[kind];
    uint64_t limit = quota->limit[kind];
    /* Who has more than the limit had it before the limit was lowered (config.c). */
    if (amount > 0 && (used > limit || amount > limit - used)) {
        quota->is_beyond = amount > limit;
        return proto_error_set(error, PCCD_E_QUOTA,
                               "user %u has %llu %s, %llu more exceed the quota of %llu",
                               (unsigned)user->uid, (unsigned long long)used,
                               kind_names[kind], (unsigned long long)amount,
                               (unsigned long long)limit);
    }
    user->used[kind] += amount;
    quota->total[kind] += amount;
    return 0;
}

void srv_quota_refund(struct srv_quota *quota, struct srv_quota_user *user,
                      enum srv_quota_kind kind, uint64_t amount)
{
    PCCD_ASSERT(user->used[kind] >= amount && quota->total[kind] >= amount);
    user->used[kind] -= amount;
    quota->total[kind] -= amount;
}

uint64_t srv_triangle_charge(uint32_t vertex_count, uint32_t triangle_count)
{
    uint64_t thirds = ((uint64_t)vertex_count + 2) / 3;
    return thirds > triangle_count ? thirds : triangle_count;
}

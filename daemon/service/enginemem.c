/* enginemem.c - the engine's memory, charged to the user it is for.
 *
 * Room:     service. See enginemem.h.
 * Does:     differences of the engine's byte count.
 * Threads:  [compute].
 */
#include "enginemem.h"

#include "invariant.h"
#include "memory.h"

void srv_enginemem_begin(struct srv_enginemem *memory, struct srv_quota_user *user,
                         uint64_t limit)
{
    srv_assert_compute();
    uint64_t used = atomic_load_explicit(&user->engine_bytes, memory_order_relaxed);
    *memory =
        (struct srv_enginemem){.user = user, .limit = limit, .before = eng_alloc_bytes()};
    uint64_t asked;
    memory->ceiling_hits = eng_alloc_ceiling_hits(&asked);
    memory->refused = eng_alloc_limit(memory->before + (used < limit ? limit - used : 0));
}

bool srv_enginemem_end(struct srv_enginemem *memory)
{
    uint64_t now = eng_alloc_bytes();
    uint64_t used =
        atomic_load_explicit(&memory->user->engine_bytes, memory_order_relaxed);
    PCCD_ASSERT(used + now >= memory->before);
    atomic_store_explicit(&memory->user->engine_bytes, used + now - memory->before,
                          memory_order_relaxed);
    return eng_alloc_limit(UINT64_MAX) != memory->refused;
}

int srv_enginemem_explain(struct srv_enginemem *memory, int status,
                          struct proto_error *error)
{
    bool refused = srv_enginemem_end(memory);
    if (status != PCCD_E_NOMEM || !refused) {
        return status;
    }
    uint64_t asked;
    if (eng_alloc_ceiling_hits(&asked) != memory->ceiling_hits) {
        return srv_quota_refuse_memory(memory->user->quota, error, asked);
    }
    return proto_error_set(
        error, PCCD_E_QUOTA,
        "user %u holds %llu MiB of the engine's memory, more exceed the quota of %llu",
        (unsigned)memory->user->uid,
        (unsigned long long)(memory->user->engine_bytes >> 20),
        (unsigned long long)(memory->limit >> 20));
}

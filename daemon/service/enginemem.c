/* enginemem.c - the engine's memory, charged to the user it is for.
 *
 * Room:     service. See enginemem.h.
 * Does:     let the thread and its team charge the user's account.
 * Threads:  [compute].
 */
#include "enginemem.h"

#include "invariant.h"
#include "memory.h"

void srv_enginemem_begin(struct srv_enginemem *memory, struct srv_quota_user *user,
                         uint64_t limit)
{
    struct eng_account *account = &user->engine;
    srv_assert_compute();
    /* Relaxed: several threads may store it, all what the daemon's setting is. */
    atomic_store_explicit(&account->limit, limit < INT64_MAX ? (int64_t)limit : INT64_MAX,
                          memory_order_relaxed);
    struct eng_payer *payer = eng_payer();
    *memory = (struct srv_enginemem){
        .user = user,
        .limit = limit,
        .refused = atomic_load_explicit(&account->refused, memory_order_relaxed),
        .ceiling_hits = atomic_load_explicit(&payer->ceiling_hits, memory_order_relaxed)};
    payer->account = account;
}

bool srv_enginemem_end(struct srv_enginemem *memory)
{
    const struct eng_account *account = &memory->user->engine;
    eng_payer()->account = NULL;
    return atomic_load_explicit(&account->refused, memory_order_relaxed) !=
           memory->refused;
}

int srv_enginemem_explain(struct srv_enginemem *memory, int status,
                          struct proto_error *error)
{
    bool refused = srv_enginemem_end(memory);
    const struct eng_payer *payer = eng_payer();
    uint64_t hits = atomic_load_explicit(&payer->ceiling_hits, memory_order_relaxed);
    if (status == PCCD_E_NOMEM && hits != memory->ceiling_hits) {
        return srv_quota_refuse_memory(
            memory->user->quota, error,
            atomic_load_explicit(&payer->ceiling_asked, memory_order_relaxed));
    }
    if (status != PCCD_E_NOMEM || !refused) {
        return status;
    }
    int64_t held =
        atomic_load_explicit(&memory->user->engine.bytes, memory_order_relaxed);
    return proto_error_set(
        error, PCCD_E_QUOTA,
        "user %u holds %lld MiB of the engine's memory, more exceed the quota of %llu",
        (unsigned)memory->user->uid, (long long)held >> 20,
        (unsigned long long)(memory->limit >> 20));
}

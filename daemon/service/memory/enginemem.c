/* enginemem.c - the engine's memory, charged to the user it is for. */
#include "enginemem.h"

#include <string.h>

#include "invariant.h"

/* The user's account, with the limit that holds now, and what was refused so far. */
static void look(struct srv_enginemem *memory, struct srv_quota_user *user)
{
    struct eng_account *account = &user->engine;
    uint64_t limit =
        atomic_load_explicit(&user->quota->engine_bytes_max, memory_order_relaxed);
    /* Relaxed: several threads may store it, all what the daemon's setting is. */
    atomic_store_explicit(&account->limit, limit < INT64_MAX ? (int64_t)limit : INT64_MAX,
                          memory_order_relaxed);
    *memory = (struct srv_enginemem){
        .user = user,
        .limit = limit,
        .refused = atomic_load_explicit(&account->refused, memory_order_relaxed),
        .ceiling_hits =
            atomic_load_explicit(&eng_payer()->ceiling_hits, memory_order_relaxed)};
}

void srv_enginemem_begin(struct srv_enginemem *memory, struct srv_quota_user *user)
{
    srv_assert_compute();
    look(memory, user);
    eng_payer()->account = &user->engine;
}

static bool was_refused(const struct srv_enginemem *memory)
{
    return atomic_load_explicit(&memory->user->engine.refused, memory_order_relaxed) !=
           memory->refused;
}

bool srv_enginemem_end(struct srv_enginemem *memory)
{
    eng_payer()->account = NULL;
    return was_refused(memory);
}

int srv_enginemem_explain(struct srv_enginemem *memory, int status,
                          struct proto_error *error)
{
    eng_payer()->account = NULL;
    return srv_enginemem_tell(memory, status, error);
}

int srv_enginemem_tell(const struct srv_enginemem *memory, int status,
                       struct proto_error *error)
{
    bool refused = was_refused(memory);
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
        "user %u holds %lld MiB of the engine's memory, more exceed the quota of %llu "
        "(pccdd --memory-max-mib)",
        (unsigned)memory->user->uid, (long long)held >> 20,
        (unsigned long long)(memory->limit >> 20));
}

/* While the loop allocates or frees for a user: nobody else uses its payer then. */
static struct eng_account *pay(struct eng_account *account)
{
    struct eng_payer *payer = eng_payer();
    struct eng_account *before = payer->account;
    payer->account = account;
    return before;
}

void *srv_enginemem_new(struct srv_quota_user *user, size_t bytes, const char *what,
                        struct proto_error *error)
{
    struct srv_enginemem memory;
    srv_assert_loop();
    look(&memory, user);
    struct eng_account *before = pay(&user->engine);
    void *block = eng_alloc(1, bytes);
    (void)pay(before);
    if (block != NULL) {
        memset(block, 0, bytes);
        return block;
    }
    user->quota->is_beyond = false; /* sessions that wait may make room */
    if (srv_enginemem_tell(&memory, PCCD_E_NOMEM, error) == PCCD_E_NOMEM) {
        (void)proto_error_set(error, PCCD_E_NOMEM, "no memory for %s", what);
    }
    return NULL;
}

void srv_enginemem_delete(struct srv_quota_user *user, void *block)
{
    srv_assert_loop();
    struct eng_account *before = pay(&user->engine);
    eng_free(block);
    (void)pay(before);
}

/* The engine's memory for a triangle of a mesh while that is committed (twice the 40 that
 * stay, four times where all meet at a vertex), or of an object; on the safe side, as
 * nothing depends on it but whether a session that waits makes room before a refusal or
 * after it. */
#define TRIANGLE_BYTES 512u

static bool is_tight(const struct srv_quota_user *user, uint64_t triangles)
{
    uint64_t limit =
        atomic_load_explicit(&user->quota->engine_bytes_max, memory_order_relaxed);
    uint64_t wanted =
        triangles < limit / TRIANGLE_BYTES ? triangles * TRIANGLE_BYTES : limit;
    int64_t used = atomic_load_explicit(&user->engine.bytes, memory_order_relaxed);
    return used > 0 && (uint64_t)used > limit - wanted &&
           (user->leaving > 0 || user->waiting > 0);
}

int srv_enginemem_refuse_tight(struct srv_quota_user *user, uint64_t triangles,
                               struct proto_error *error)
{
    srv_assert_loop();
    if (!is_tight(user, triangles)) {
        return 0;
    }
    user->quota->is_beyond = false;
    return proto_error_set(error, PCCD_E_QUOTA,
                           "user %u: the engine's memory is held by sessions that end",
                           (unsigned)user->uid);
}

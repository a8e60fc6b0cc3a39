/* memory.c - the engine's allocations, counted.
 *
 * Put a 128-byte header with the size before each block, so that bytes can be counted
 * down when a block goes. Blocks are aligned here: glibc's aligned_alloc cuts pieces off
 * a larger block on both sides, and up to version 2.37 seldom finds a freed one again
 * (its bug 14581), so that the memory of a daemon whose clients come and go crept up.
 */
#include "memory.h"

#include <assert.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <unistd.h>

#define ALIGNMENT    128u
#define HEADER_BYTES ALIGNMENT

/* malloc aligns to that much by itself; the rest is for the alignment. */
#define ORIGIN_BYTES (ALIGNMENT - _Alignof(max_align_t))

/* Bytes that a block takes besides itself: charged with it, as many scenes are small. */
#define BESIDES (HEADER_BYTES + ORIGIN_BYTES)

/* Blocks of so many bytes and more ask for large pages, which are as long: to touch a
 * page for the first time takes longer than to fill it. */
#define LARGE_MIN (2u << 20)

struct header {
    size_t total; /* bytes charged */
    void *origin; /* what malloc gave */
};

_Static_assert(sizeof(struct header) <= HEADER_BYTES, "it stands before the block");

static atomic_uint_fast64_t alloc_count;
static atomic_uint_fast64_t alloc_bytes;
static atomic_uint_fast64_t byte_ceiling = UINT64_MAX;

static _Thread_local struct eng_payer own_payer;
static _Thread_local struct eng_payer *joined_payer; /* NULL: its own */
static _Thread_local struct eng_account *charged;    /* NULL: the payer's */

struct eng_payer *eng_payer(void)
{
    return joined_payer ? joined_payer : &own_payer;
}

void eng_payer_join(struct eng_payer *payer)
{
    assert(payer);
    joined_payer = payer;
}

struct eng_account *eng_charge_to(struct eng_account *account)
{
    struct eng_account *before = charged;
    charged = account;
    return before;
}

static struct eng_account *account_of(const struct eng_payer *payer)
{
    return charged ? charged : payer->account;
}

/* The first aligned place of a block of malloc. */
static unsigned char *align(void *origin)
{
    uintptr_t place = (uintptr_t)origin;
    return (unsigned char *)origin + (-place & (ALIGNMENT - 1));
}

/* Relaxed, here and below: the counters order nothing. */
static void uncharge(size_t total)
{
    struct eng_account *account = account_of(eng_payer());
    atomic_fetch_sub_explicit(&alloc_bytes, total, memory_order_relaxed);
    if (account) {
        atomic_fetch_sub_explicit(&account->bytes, (int64_t)total, memory_order_relaxed);
    }
}

/* Add to what is held unless it then is more than `limit`. Never for a moment: what one
 * thread is refused may not be in the way of what another asks for. */
static bool take_all(size_t total)
{
    uint64_t limit = atomic_load_explicit(&byte_ceiling, memory_order_relaxed);
    uint64_t held = atomic_load_explicit(&alloc_bytes, memory_order_relaxed);
    do {
        if (total > limit || held > limit - total) {
            return false;
        }
    } while (!atomic_compare_exchange_weak_explicit(
        &alloc_bytes, &held, held + total, memory_order_relaxed, memory_order_relaxed));
    return true;
}

static bool take_own(struct eng_account *account, size_t total)
{
    int64_t limit = atomic_load_explicit(&account->limit, memory_order_relaxed);
    int64_t held = atomic_load_explicit(&account->bytes, memory_order_relaxed);
    do {
        if (held + (int64_t)total > limit) {
            return false;
        }
    } while (!atomic_compare_exchange_weak_explicit(
        &account->bytes, &held, held + (int64_t)total, memory_order_relaxed,
        memory_order_relaxed));
    return true;
}

/* Count a block before it is made: together all threads keep the limits. */
static bool charge(size_t total)
{
    struct eng_payer *payer = eng_payer();
    struct eng_account *account = account_of(payer);
    if (account && !take_own(account, total)) {
        atomic_fetch_add_explicit(&account->refused, 1, memory_order_relaxed);
        return false;
    }
    if (!take_all(total)) {
        if (account) {
            atomic_fetch_sub_explicit(&account->bytes, (int64_t)total,
                                      memory_order_relaxed);
        }
        atomic_store_explicit(&payer->ceiling_asked, total, memory_order_relaxed);
        atomic_fetch_add_explicit(&payer->ceiling_hits, 1, memory_order_relaxed);
        return false;
    }
    return true;
}

/* The bytes that a block is charged with. False: there cannot be so many. */
static bool total_of(size_t count, size_t bytes, size_t *total)
{
    if (__builtin_mul_overflow(count, bytes, total) ||
        __builtin_add_overflow(*total, BESIDES + ALIGNMENT - 1, total)) {
        return false;
    }
    *total = ((*total - BESIDES) & ~(size_t)(ALIGNMENT - 1)) + BESIDES;
    return *total <= INT64_MAX;
}

/* Write the header into what malloc gave, and return the block. */
static void *begin(void *origin, size_t total)
{
    unsigned char *base = align(origin);
    struct header header = {.total = total, .origin = origin};
    memcpy(base, &header, sizeof header);
    atomic_fetch_add_explicit(&alloc_count, 1, memory_order_relaxed);
    atomic_fetch_add_explicit(&eng_payer()->allocs, 1, memory_order_relaxed);
    return base + HEADER_BYTES;
}

/* Wherever the system only gives large pages when it is asked to. All that is mapped for
 * the block is asked for, as part of a mapping could not be moved with the rest. */
static void ask_for_large_pages(void *origin, size_t total)
{
    if (total >= LARGE_MIN) {
        size_t before = (uintptr_t)origin % (size_t)sysconf(_SC_PAGESIZE);
        (void)madvise((unsigned char *)origin - before, total + before, MADV_HUGEPAGE);
    }
}

void *eng_alloc(size_t count, size_t bytes)
{
    size_t total;
    if (!total_of(count, bytes, &total) || !charge(total)) {
        return NULL;
    }
    void *origin = malloc(total);
    if (!origin) {
        uncharge(total);
        return NULL;
    }
    ask_for_large_pages(origin, total);
    return begin(origin, total);
}

static struct header header_of(const void *block)
{
    struct header header;
    memcpy(&header, (const unsigned char *)block - HEADER_BYTES, sizeof header);
    return header;
}

/* The C library moves the pages of a large block, and touches none of them; whatever it
 * moved, the block is to be aligned again. */
void *eng_realloc(void *block, size_t count, size_t bytes)
{
    size_t total;
    if (!block) {
        return eng_alloc(count, bytes);
    }
    if (!total_of(count, bytes, &total) || !charge(total)) {
        return NULL;
    }
    struct header old = header_of(block);
    size_t place = (size_t)((unsigned char *)block - (unsigned char *)old.origin);
    unsigned char *origin = realloc(old.origin, total);
    if (!origin) {
        uncharge(total);
        return NULL;
    }
    uncharge(old.total);
    size_t kept = (old.total < total ? old.total : total) - BESIDES;
    if (align(origin) + HEADER_BYTES != origin + place) {
        memmove(align(origin) + HEADER_BYTES, origin + place, kept);
    }
    ask_for_large_pages(origin, total);
    return begin(origin, total);
}

void eng_free(void *block)
{
    if (!block) {
        return;
    }
    struct header header = header_of(block);
    uncharge(header.total);
    free(header.origin);
}

uint64_t eng_alloc_count(void)
{
    return atomic_load_explicit(&alloc_count, memory_order_relaxed);
}

uint64_t eng_alloc_bytes(void)
{
    return atomic_load_explicit(&alloc_bytes, memory_order_relaxed);
}

void eng_alloc_set_ceiling(uint64_t bytes)
{
    atomic_store_explicit(&byte_ceiling, bytes, memory_order_relaxed);
}

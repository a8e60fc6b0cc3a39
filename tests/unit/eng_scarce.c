/* eng_scarce.c - memory that runs out on order. */
#include "eng_scarce.h"

#include <pthread.h>

#define HEADER 128u /* alignment, and room for the size */

struct scarce scarce;
static pthread_mutex_t lock = PTHREAD_MUTEX_INITIALIZER;

static bool should_fail(void)
{
    if (!scarce.is_failing && scarce.countdown > 0 && --scarce.countdown == 0) {
        scarce.failures++;
        scarce.is_failing = scarce.goes_on_failing;
        return true;
    }
    return scarce.is_failing;
}

void *eng_alloc(size_t count, size_t bytes)
{
    size_t total;
    if (__builtin_mul_overflow(count, bytes, &total) || total > SIZE_MAX - 2 * HEADER) {
        return NULL;
    }
    pthread_mutex_lock(&lock);
    bool fails = should_fail();
    if (!fails) {
        scarce.allocations++;
        scarce.held_blocks++;
        scarce.held_bytes += total;
    }
    pthread_mutex_unlock(&lock);
    if (fails) {
        return NULL;
    }
    unsigned char *base =
        aligned_alloc(HEADER, (total + 2 * HEADER - 1) & ~(size_t)(HEADER - 1));
    assert_non_null(base);
    memcpy(base, &total, sizeof total);
    memset(base + HEADER, 0xa5, total); /* nobody may count on zeros */
    return base + HEADER;
}

static size_t size_of(const void *block)
{
    size_t total;
    memcpy(&total, (const unsigned char *)block - HEADER, sizeof total);
    return total;
}

void *eng_realloc(void *block, size_t count, size_t bytes)
{
    void *grown = eng_alloc(count, bytes);
    if (grown && block) {
        size_t old = size_of(block);
        memcpy(grown, block, old < size_of(grown) ? old : size_of(grown));
        eng_free(block);
    }
    return grown;
}

void eng_free(void *block)
{
    if (block) {
        pthread_mutex_lock(&lock);
        scarce.held_blocks--;
        scarce.held_bytes -= size_of(block);
        pthread_mutex_unlock(&lock);
        memset(block, 0x5a, size_of(block)); /* nobody may look at it any more */
        free((unsigned char *)block - HEADER);
    }
}

struct eng_payer *eng_payer(void)
{
    static _Thread_local struct eng_payer own;
    return &own;
}

void eng_payer_join(struct eng_payer *payer)
{
    (void)payer;
}

struct eng_account *eng_charge_to(struct eng_account *account)
{
    (void)account;
    return NULL;
}

uint64_t eng_alloc_count(void)
{
    return scarce.allocations;
}

uint64_t eng_alloc_bytes(void)
{
    return scarce.held_bytes;
}

bool scarce_recovered(int status)
{
    if (status == PCCD_E_NOMEM) {
        assert_true(scarce.failures > 0); /* it may only say so if it is true */
    } else {
        assert_ok(status);
    }
    scarce.is_failing = false;
    return status == PCCD_OK;
}

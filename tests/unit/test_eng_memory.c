/* test_eng_memory.c - the engine's allocations, counted. */
#include "eng_kit.h"

#include <inttypes.h>
#include <malloc.h>
#include <pthread.h>
#include <sys/resource.h>
#include <unistd.h>

#include "memory.h"

/* Sizes beyond all memory are to be answered with NULL, under a sanitizer too. */
__attribute__((visibility("default"))) const char *__asan_default_options(void);
const char *__asan_default_options(void)
{
    return "allocator_may_return_null=1";
}

__attribute__((visibility("default"))) const char *__tsan_default_options(void);
const char *__tsan_default_options(void)
{
    return __asan_default_options();
}

/* If it failed: vector loads from a block would fault or be slow. */
CASE(memory__blocks_are_aligned_and_wholly_usable)
{
    for (size_t bytes = 0; bytes < 300; bytes++) {
        unsigned char *block = eng_alloc(bytes, 1);
        assert_non_null(block);
        assert_int_equal((uintptr_t)block % 128, 0);
        memset(block, 0xa5, bytes);
        block = eng_realloc(block, bytes + 65, 1);
        assert_non_null(block);
        assert_int_equal((uintptr_t)block % 128, 0);
        eng_free(block);
    }
}

/* If it failed: "a warm step allocates nothing" in the statistics would mean nothing. */
CASE(memory__count_rises_with_every_allocation)
{
    uint64_t start = eng_alloc_count();
    void *a = eng_alloc(10, 10);
    assert_int_equal(eng_alloc_count(), start + 1);
    a = eng_realloc(a, 20, 10);
    assert_int_equal(eng_alloc_count(), start + 2);
    void *b = eng_realloc(NULL, 1, 1);
    assert_non_null(b);
    assert_int_equal(eng_alloc_count(), start + 3);
    eng_free(a);
    eng_free(b);
    eng_free(NULL);
    assert_int_equal(eng_alloc_count(), start + 3);
}

/* If it failed: the bytes that quotas are charged for would drift. */
CASE(memory__bytes_return_to_the_start)
{
    uint64_t start = eng_alloc_bytes();
    void *blocks[50];
    for (size_t i = 0; i < 50; i++) {
        uint64_t before = eng_alloc_bytes();
        blocks[i] = eng_alloc(i, 1000);
        assert_true(eng_alloc_bytes() - before >= i * 1000);
        assert_true(eng_alloc_bytes() - before <= i * 1000 + 367);
    }
    for (size_t i = 0; i < 50; i++) {
        blocks[i] = eng_realloc(blocks[i], 50 - i, 500);
        assert_non_null(blocks[i]);
    }
    assert_true(eng_alloc_bytes() - start >= 50 * 51 / 2 * 500);
    for (size_t i = 0; i < 50; i++) {
        eng_free(blocks[i]);
    }
    assert_int_equal(eng_alloc_bytes(), start);
}

/* If it failed: a count from outside could make a block smaller than what is written to
 * it. */
CASE(memory__sizes_that_overflow_are_refused)
{
    uint64_t count = eng_alloc_count();
    uint64_t bytes = eng_alloc_bytes();
    assert_null(eng_alloc(SIZE_MAX, 2));
    assert_null(eng_alloc(SIZE_MAX / 2 + 1, 2)); /* wraps to 0 */
    assert_null(eng_alloc((size_t)1 << 32, (size_t)1 << 32));
    for (size_t less = 0; less <= 256; less += 32) {
        assert_null(eng_alloc(SIZE_MAX - less, 1)); /* the header must not wrap either */
    }
    assert_int_equal(eng_alloc_count(), count);
    assert_int_equal(eng_alloc_bytes(), bytes);
}

/* If it failed: growing an array would lose or spoil what it holds. */
CASE(memory__realloc_keeps_the_content)
{
    struct prng random = {1};
    size_t bytes = 100;
    unsigned char *block = eng_alloc(bytes, 1);
    for (size_t i = 0; i < bytes; i++) {
        block[i] = (unsigned char)(i * 7);
    }
    for (int round = 0; round < 200; round++) {
        size_t next = 1 + prng_u32(&random, 5000);
        size_t kept = next < bytes ? next : bytes;
        block = eng_realloc(block, next, 1);
        assert_non_null(block);
        for (size_t i = 0; i < kept; i++) {
            assert_int_equal(block[i], (unsigned char)(i * 7));
        }
        for (size_t i = kept; i < next; i++) {
            block[i] = (unsigned char)(i * 7);
        }
        bytes = next;
    }
    eng_free(block);
}

static long page_faults(void)
{
    struct rusage usage;
    assert_int_equal(getrusage(RUSAGE_SELF, &usage), 0);
    return usage.ru_minflt;
}

/* If it failed: with each object that comes, all positions of its scene would be copied
 * to fresh pages. */
CASE(memory__large_blocks_grow_without_a_copy)
{
#ifdef PCCD_SANITIZED
    test_skip("a sanitizer copies");
#else
    const size_t bytes = 64u << 20; /* beyond what the C library cuts out of a heap */
    unsigned char *block = eng_alloc(bytes, 1);
    assert_non_null(block);
    memset(block, 0x5a, bytes);
    long before = page_faults();
    block = eng_realloc(block, bytes + bytes / 8, 1);
    assert_non_null(block);
    assert_true(page_faults() - before < 64);
    assert_int_equal((uintptr_t)block % 128, 0);
    assert_int_equal(block[0], 0x5a);
    assert_int_equal(block[bytes - 1], 0x5a);
    eng_free(block);
#endif
}

/* If it failed: a scene that cannot grow would lose the array that it has. */
CASE(memory__refused_realloc_leaves_the_old_block)
{
    uint64_t bytes = eng_alloc_bytes();
    char *block = eng_alloc(3, 4);
    memcpy(block, "still here!", 12);
    assert_null(eng_realloc(block, SIZE_MAX / 2, 4));
    assert_string_equal(block, "still here!");
    eng_free(block);
    assert_int_equal(eng_alloc_bytes(), bytes);
}

/* One scene's blocks, and what its session has of the C library's beside them. */
#define SCENES 60u
#define BLOCKS 60u

struct held {
    void *blocks[BLOCKS];
    void *others[BLOCKS];
};

static void renew(struct held *held, const size_t *bytes, struct prng *random)
{
    for (size_t i = 0; i < BLOCKS; i++) {
        eng_free(held->blocks[i]);
        free(held->others[i]);
    }
    for (size_t i = 0; i < BLOCKS; i++) {
        held->blocks[i] = eng_alloc(bytes[i], 1);
        held->others[i] = malloc(prng_u32(random, 500));
        assert_non_null(held->blocks[i]);
    }
}

/* Freed bytes that the C library holds within its heaps. */
static size_t free_bytes(void)
{
#if defined(__GLIBC__) && __GLIBC_PREREQ(2, 33)
    return mallinfo2().fordblks;
#else
    return 0;
#endif
}

/* If it failed: a daemon whose clients come and go would grow, though it holds no more
 * than before. With aligned_alloc a tenth of the memory lies unused here. */
CASE(memory__freed_blocks_are_found_again)
{
    static struct held scenes[SCENES];
    struct prng random = {7};
    size_t bytes[BLOCKS];
    size_t before = free_bytes();
    uint64_t held = eng_alloc_bytes();
    for (size_t i = 0; i < BLOCKS; i++) {
        bytes[i] = ((size_t)1 << prng_u32(&random, 15)) + prng_u32(&random, 4096);
    }
    for (size_t i = 0; i < SCENES; i++) {
        renew(&scenes[i], bytes, &random);
    }
    held = eng_alloc_bytes() - held;
    for (size_t round = 0; round < 2000; round++) {
        struct held *other = &scenes[prng_u32(&random, SCENES)];
        for (size_t i = prng_u32(&random, 3); i < BLOCKS; i += 3) {
            other->blocks[i] = eng_realloc(other->blocks[i], bytes[i], 1);
        }
        renew(&scenes[prng_u32(&random, SCENES)], bytes, &random);
    }
    assert_in_range(free_bytes(), 0, before + held / 25);
    for (size_t i = 0; i < SCENES; i++) {
        for (size_t k = 0; k < BLOCKS; k++) {
            eng_free(scenes[i].blocks[k]);
            free(scenes[i].others[k]);
        }
    }
}

static void *churn(void *argument)
{
    (void)argument;
    for (size_t i = 0; i < 20000; i++) {
        void *block = eng_alloc(i % 97, 8);
        block = eng_realloc(block, i % 89, 8);
        eng_free(block);
    }
    return NULL;
}

/* If it failed: counts taken by several threads at once would get lost. */
CASE(memory__threads_lose_no_counts)
{
    pthread_t threads[4];
    uint64_t count = eng_alloc_count();
    uint64_t bytes = eng_alloc_bytes();
    for (int i = 0; i < 4; i++) {
        assert_int_equal(pthread_create(&threads[i], NULL, churn, NULL), 0);
    }
    for (int i = 0; i < 4; i++) {
        assert_int_equal(pthread_join(threads[i], NULL), 0);
    }
    assert_int_equal(eng_alloc_count(), count + 4 * 2 * 20000);
    assert_int_equal(eng_alloc_bytes(), bytes);
}

/* If it failed, a user could take more of the engine's memory than the quota allows, or
 * one refusal would refuse what fits afterwards. */
CASE(memory__limit_refuses_what_goes_beyond_it)
{
    struct eng_account account = {.limit = 10000};
    eng_payer()->account = &account;
    void *small = eng_alloc(1, 5000);
    assert_non_null(small);
    assert_null(eng_alloc(1, 5000)); /* the header counts */
    assert_null(eng_realloc(small, 1, 6000));
    assert_int_equal(account.refused, 2);
    account.limit = 20000;
    void *second = eng_alloc(1, 5000);
    assert_non_null(second);
    eng_free(small);
    eng_free(second);
    assert_int_equal(account.bytes, 0);
    assert_int_equal(account.refused, 2);
    eng_payer()->account = NULL;
}

struct customer {
    struct eng_account account;
    uint64_t blocks;
    uint64_t allocs; /* that it saw itself make */
};

#define HELPED 20000u

/* A thread of a team. */
static void *help(void *payer)
{
    eng_payer_join(payer);
    for (uint64_t i = 0; i < HELPED; i++) {
        eng_free(eng_alloc(1, 1000));
    }
    assert_null(eng_alloc(1, 100000));
    return NULL;
}

static void *buy(void *context)
{
    struct customer *customer = context;
    struct eng_payer *payer = eng_payer();
    uint64_t before = payer->allocs;
    pthread_t mate;
    payer->account = &customer->account;
    for (uint64_t i = 0; i < customer->blocks; i++) {
        eng_free(eng_alloc(1, 1000));
    }
    assert_int_equal(pthread_create(&mate, NULL, help, payer), 0);
    for (uint64_t i = 0; i < HELPED; i++) {
        eng_free(eng_alloc(1, 1000));
    }
    assert_null(eng_alloc(1, 100000));
    assert_int_equal(pthread_join(mate, NULL), 0);
    customer->allocs = payer->allocs - before;
    return NULL;
}

/* If it failed, a user would be charged for what a step of another user takes that runs
 * at the same time, and be refused memory for it. */
CASE(memory__those_who_compute_at_once_pay_each_for_itself)
{
    struct customer customers[2] = {{.account = {.limit = 50000}, .blocks = 20000},
                                    {.account = {.limit = 50000}, .blocks = 30000}};
    pthread_t threads[2];
    for (int i = 0; i < 2; i++) {
        assert_int_equal(pthread_create(&threads[i], NULL, buy, &customers[i]), 0);
    }
    for (int i = 0; i < 2; i++) {
        assert_int_equal(pthread_join(threads[i], NULL), 0);
        assert_int_equal(customers[i].account.bytes, 0);
        assert_int_equal(customers[i].account.refused, 2);
        assert_int_equal(customers[i].allocs, customers[i].blocks + 2 * HELPED);
    }
}

/* Return whether the mapping with `place` asks for large pages. */
static bool asks_for_large_pages(const void *place)
{
    FILE *file = fopen("/proc/self/smaps", "r");
    char line[512];
    bool is_inside = false;
    bool asks = false;
    assert_non_null(file);
    while (fgets(line, sizeof line, file) != NULL) {
        uintptr_t first;
        uintptr_t end;
        if (sscanf(line, "%" SCNxPTR "-%" SCNxPTR " ", &first, &end) == 2) {
            is_inside = (uintptr_t)place >= first && (uintptr_t)place < end;
        }
        asks |= is_inside && strncmp(line, "VmFlags:", 8) == 0 && strstr(line, " hg");
    }
    fclose(file);
    return asks;
}

/* If it failed, to touch the arrays of a large scene would take longer than to fill
 * them. */
CASE(memory__large_blocks_ask_for_large_pages)
{
    test_skip_emulated("its maps are not the kernel's");
    if (access("/sys/kernel/mm/transparent_hugepage", F_OK) != 0) {
        test_skip("the kernel has no large pages");
    }
    unsigned char *block = eng_alloc(4, 1u << 20);
    assert_non_null(block);
    assert_true(asks_for_large_pages(block + (3u << 20)));
    block = eng_realloc(block, 64, 1u << 20);
    assert_non_null(block);
    assert_true(asks_for_large_pages(block + (63u << 20)));
    eng_free(block);
}

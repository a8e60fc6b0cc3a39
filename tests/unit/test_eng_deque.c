/* test_eng_deque.c - the work-stealing deque, shares, the pool of blocks. */
#include "eng_kit.h"

#include <pthread.h>

#include "deque.h"
#include "memory.h"
#include "result.h"

static int setup(void **state)
{
    struct eng_deque *deque = aligned_alloc(128, sizeof *deque);
    if (!deque) {
        return -1;
    }
    eng_deque_init(deque);
    *state = deque;
    return 0;
}

static int teardown(void **state)
{
    free(*state);
    return 0;
}

/* If it failed: the owner would leave its cache, or a thief would get crumbs. */
CASE_WITH(deque__owner_takes_the_newest_and_thieves_the_oldest, setup, teardown)
{
    struct eng_deque *deque = *state;
    uint64_t task = 0;
    assert_false(eng_deque_pop(deque, &task));
    assert_false(eng_deque_steal(deque, &task));
    for (uint64_t i = 1; i <= 5; i++) {
        assert_true(eng_deque_push(deque, i));
    }
    assert_true(eng_deque_steal(deque, &task));
    assert_int_equal(task, 1);
    assert_true(eng_deque_pop(deque, &task));
    assert_int_equal(task, 5);
    for (uint64_t i = 4; i >= 2; i--) {
        assert_true(eng_deque_pop(deque, &task));
        assert_int_equal(task, i);
    }
    assert_false(eng_deque_pop(deque, &task));
}

/* If it failed: a full deque would overwrite tasks that nobody has done. */
CASE_WITH(deque__full_refuses_and_wraps, setup, teardown)
{
    struct eng_deque *deque = *state;
    uint64_t task = 0;
    for (uint64_t round = 0; round < 3; round++) {
        for (uint64_t i = 0; i < ENG_DEQUE_MAX; i++) {
            assert_true(eng_deque_push(deque, i));
        }
        assert_false(eng_deque_push(deque, 7));
        for (uint64_t i = 0; i < ENG_DEQUE_MAX; i++) {
            assert_true(eng_deque_steal(deque, &task));
            assert_int_equal(task, i);
        }
    }
}

#define TASKS   200000u
#define THIEVES 3

struct race {
    struct eng_deque *deque;
    atomic_uchar *seen; /* [TASKS] how often each was taken */
    atomic_bool over;
};

static void *thief(void *context)
{
    struct race *race = context;
    uint64_t task;
    while (!atomic_load(&race->over)) {
        if (eng_deque_steal(race->deque, &task)) {
            atomic_fetch_add(&race->seen[task], 1);
        }
    }
    return NULL;
}

/* If it failed: pairs of triangles would be tested twice or, worse, never. */
CASE_WITH(deque__races_lose_and_double_nothing, setup, teardown)
{
    struct race race = {.deque = *state};
    pthread_t threads[THIEVES];
    race.seen = test_room(TASKS * sizeof *race.seen);
    for (int i = 0; i < THIEVES; i++) {
        assert_int_equal(pthread_create(&threads[i], NULL, thief, &race), 0);
    }
    uint64_t task;
    for (uint64_t i = 0; i < TASKS; i++) {
        while (!eng_deque_push(race.deque, i)) {
            if (eng_deque_pop(race.deque, &task)) {
                atomic_fetch_add(&race.seen[task], 1);
            }
        }
        if (i % 3 == 0 && eng_deque_pop(race.deque, &task)) {
            atomic_fetch_add(&race.seen[task], 1);
        }
    }
    while (eng_deque_pop(race.deque, &task)) {
        atomic_fetch_add(&race.seen[task], 1);
    }
    atomic_store(&race.over, true);
    for (int i = 0; i < THIEVES; i++) {
        pthread_join(threads[i], NULL);
    }
    for (uint32_t i = 0; i < TASKS; i++) {
        assert_int_equal(race.seen[i], 1);
    }
    free(race.seen);
}

/* If it failed: two workers would write their records into one block, or a warm step
 * would ask the system for memory. */
CASE(pool__blocks_are_handed_out_once_and_kept)
{
    struct eng_pool pool;
    struct eng_block *blocks[64];
    uint64_t bytes = eng_alloc_bytes();
    eng_pool_init(&pool);
    uint64_t warm = 0;
    for (int round = 0; round < 4; round++) {
        eng_pool_reset(&pool, 2);
        uint64_t allocs = eng_alloc_count();
        for (int i = 0; i < 64; i++) {
            blocks[i] = eng_pool_take(&pool);
            assert_non_null(blocks[i]);
            assert_int_equal(blocks[i]->count, 0);
            assert_null(blocks[i]->next);
            for (int j = 0; j < i; j++) {
                assert_ptr_not_equal(blocks[i], blocks[j]);
            }
        }
        warm = eng_alloc_count() - allocs;
        assert_true(round == 0 || warm == 0);
    }
    eng_pool_deinit(&pool);
    assert_int_equal(eng_alloc_bytes(), bytes);
}

#define SHARES      4u
#define SHARE_ITEMS 10007u

struct sharers {
    struct eng_partition shares[SHARES];
    atomic_uint taken[SHARE_ITEMS];
    atomic_uint next_thread;
};

static void *take_shares(void *data)
{
    struct sharers *all = data;
    uint32_t thread = atomic_fetch_add(&all->next_thread, 1);
    for (uint32_t i = 0; i < SHARES; i++) {
        uint32_t item;
        while (eng_partition_take(&all->shares[(thread + i) % SHARES], &item)) {
            atomic_fetch_add(&all->taken[item], 1);
        }
    }
    return NULL;
}

/* If it failed: boxes would be made twice, or never, when a team has fewer threads than
 * were asked for. */
CASE(share__every_item_is_taken_once)
{
    for (uint32_t threads = 1; threads <= SHARES; threads++) {
        struct sharers *all = aligned_alloc(128, (sizeof *all + 127) / 128 * 128);
        assert_non_null(all);
        memset(all, 0, sizeof *all);
        for (uint32_t i = 0; i < SHARES; i++) {
            eng_partition_init(&all->shares[i], SHARE_ITEMS, i, SHARES);
        }
        pthread_t ids[SHARES];
        for (uint32_t i = 0; i < threads; i++) {
            assert_int_equal(pthread_create(&ids[i], NULL, take_shares, all), 0);
        }
        for (uint32_t i = 0; i < threads; i++) {
            assert_int_equal(pthread_join(ids[i], NULL), 0);
        }
        for (uint32_t i = 0; i < SHARE_ITEMS; i++) {
            assert_int_equal(atomic_load(&all->taken[i]), 1);
        }
        free(all);
    }
}

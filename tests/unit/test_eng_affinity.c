/* test_eng_affinity.c - where the threads of a team run.
 *
 * Threads: a new one for each test, since a thread that opens regions is bound too; its
 * team.
 */
#include "eng_crew.h"

#include <omp.h>
#include <pthread.h>
#include <sched.h>
#include <stdatomic.h>
#include <time.h>

#include "affinity.h"

#define TEAM_MAX 64u

/* What one region saw. */
struct sight {
    uint32_t count;
    int cpu[TEAM_MAX];     /* where each thread ran */
    int allowed[TEAM_MAX]; /* processors that it may use */
};

static int allowed_count(void)
{
    cpu_set_t set;
    return sched_getaffinity(0, sizeof set, &set) == 0 ? CPU_COUNT(&set) : -1;
}

static struct sight look(const struct eng_affinity *affinity, uint32_t threads)
{
    struct sight sight;
    memset(&sight, 0, sizeof sight);
#pragma omp parallel num_threads((int)threads)
    {
        uint32_t thread = (uint32_t)omp_get_thread_num();
        eng_affinity_bind_thread(affinity, thread, (uint32_t)omp_get_num_threads());
        sight.cpu[thread] = sched_getcpu();
        sight.allowed[thread] = allowed_count();
        if (thread == 0) {
            sight.count = (uint32_t)omp_get_num_threads();
        }
    }
    return sight;
}

/* Run `body` as a compute thread of its own would. */
static void apart(void *(*body)(void *), void *data)
{
    pthread_t thread;
    assert_int_equal(pthread_create(&thread, NULL, body, data), 0);
    assert_int_equal(pthread_join(thread, NULL), 0);
}

static uint32_t usable(struct eng_affinity *affinity)
{
    eng_affinity_init(affinity);
    if (affinity->count < 2) {
        test_skip("it takes two processors");
    }
    return affinity->count < TEAM_MAX ? affinity->count : TEAM_MAX;
}

static void check_bound(const struct sight *sight, const struct eng_affinity *affinity)
{
    for (uint32_t i = 0; i < sight->count; i++) {
        assert_int_equal(sight->cpu[i], affinity->cpu[i]);
        assert_int_equal(sight->allowed[i], 1);
    }
}

struct rounds {
    struct eng_affinity affinity;
    uint32_t threads;
    struct sight sights[5];
};

static void *unplaced(void *data)
{
    struct rounds *rounds = data;
    rounds->sights[0] = look(NULL, rounds->threads);
    return NULL;
}

/* If it failed: whoever asks for no places would be bound all the same. The first case:
 * clang's OpenMP library lends threads that were bound to the next who asks. */
CASE(place__without_places_nobody_is_bound)
{
    static struct rounds rounds;
    rounds.threads = usable(&rounds.affinity);
    apart(unplaced, &rounds);
    for (uint32_t i = 0; i < rounds.sights[0].count; i++) {
        assert_int_equal(rounds.sights[0].allowed[i], rounds.affinity.count);
    }
}

static void *as_guest(void *data)
{
    struct rounds *rounds = data;
    for (uint32_t i = 0; i < 2; i++) { /* it has moved in between */
        rounds->affinity.first_on = rounds->affinity.cpu[i];
        rounds->sights[i] = look(&rounds->affinity, rounds->threads);
    }
    rounds->sights[2] = look(&rounds->affinity, rounds->threads + 1);
    return NULL;
}

/* If it failed: a step in a game's process would bind the game's own thread, or the
 * others would wait behind it on its processor. */
CASE(place__guests_keep_off_the_first_thread_and_let_it_be)
{
    static struct rounds rounds;
    rounds.threads = usable(&rounds.affinity);
    if (rounds.threads == TEAM_MAX) {
        test_skip("there are too many processors");
    }
    rounds.affinity.is_guest = true;
    apart(as_guest, &rounds);
    for (uint32_t i = 0; i < 3; i++) {
        assert_int_equal(rounds.sights[i].allowed[0], rounds.affinity.count);
    }
    for (uint32_t i = 1; i < rounds.threads; i++) {
        assert_int_equal(rounds.sights[0].allowed[i], rounds.affinity.count - 1);
        assert_int_not_equal(rounds.sights[0].cpu[i], rounds.affinity.cpu[0]);
        assert_int_equal(rounds.sights[1].allowed[i], rounds.affinity.count - 1);
        assert_int_not_equal(rounds.sights[1].cpu[i], rounds.affinity.cpu[1]);
        assert_int_equal(rounds.sights[2].allowed[i],
                         rounds.affinity.count); /* a crowd */
    }
}

static void *shrink_and_grow(void *data)
{
    struct rounds *rounds = data;
    const uint32_t threads = rounds->threads;
    rounds->sights[0] = look(&rounds->affinity, threads);
    rounds->sights[1] = look(&rounds->affinity, 1);
    rounds->sights[2] = look(&rounds->affinity, threads);
    rounds->sights[3] = look(&rounds->affinity, threads - 1);
    rounds->sights[4] = look(&rounds->affinity, threads);
    return NULL;
}

/* If it failed: two threads of a team could share a processor while another is idle. */
CASE(place__each_thread_has_its_own_processor)
{
    static struct rounds rounds;
    rounds.threads = usable(&rounds.affinity);
    apart(shrink_and_grow, &rounds);
    for (int i = 0; i < 5; i++) {
        check_bound(&rounds.sights[i], &rounds.affinity);
    }
    assert_int_equal(rounds.sights[0].count, rounds.threads);
    assert_int_equal(rounds.sights[4].count, rounds.threads);
}

static void *bind_then_crowd(void *data)
{
    struct rounds *rounds = data;
    rounds->sights[0] = look(&rounds->affinity, rounds->threads);
    rounds->sights[1] = look(&rounds->affinity, rounds->threads + 1);
    rounds->sights[2] = look(&rounds->affinity, rounds->threads);
    return NULL;
}

/* If it failed: the threads added to a bound team would all stay on the processor of the
 * thread that made them. */
CASE(place__crowd_may_run_anywhere)
{
    static struct rounds rounds;
    rounds.threads = usable(&rounds.affinity);
    if (rounds.threads == TEAM_MAX) {
        test_skip("there are too many processors");
    }
    apart(bind_then_crowd, &rounds);
    check_bound(&rounds.sights[0], &rounds.affinity);
    assert_int_equal(rounds.sights[1].count, rounds.threads + 1);
    for (uint32_t i = 0; i < rounds.sights[1].count; i++) {
        assert_int_equal(rounds.sights[1].allowed[i], rounds.affinity.count);
    }
    check_bound(&rounds.sights[2], &rounds.affinity);
}

/* ---- lending ----------------------------------------------------------------------- */

#define BURNERS 3

/* One thread works, the other waits for it and looks. */
struct lending {
    struct eng_affinity affinity;
    pthread_t burners[BURNERS];
    atomic_bool burn;
    atomic_bool is_ready;
    atomic_bool is_done;
    uint64_t work_ns; /* of a processor; 0: the thread waits, too */
    uint64_t look_ns; /* between two looks at it, by the clock that they are told */
    bool is_waiting;  /* or says so */
    uint32_t moved;   /* looks that moved it */
    int cpu;          /* where it ended its work */
    int cpu_after;    /* and where it was sent back to */
    int allowed_after;
};

static void *burn(void *data)
{
    struct lending *lending = data;
    cpu_set_t set;
    CPU_ZERO(&set);
    CPU_SET(lending->affinity.cpu[1], &set);
    (void)sched_setaffinity(0, sizeof set, &set);
    while (atomic_load(&lending->burn)) {
    }
    return NULL;
}

static uint64_t thread_ns(void)
{
    struct timespec now;
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
    return (uint64_t)now.tv_sec * 1000000000u + (uint64_t)now.tv_nsec;
}

static void pause_us(long us)
{
    nanosleep(&(struct timespec){0, us * 1000}, NULL);
}

/* The thread that others wait for. */
static void work(struct lending *lending)
{
    uint64_t end_ns = thread_ns() + lending->work_ns;
    eng_processor_set_waiting(&lending->affinity, 1, lending->is_waiting);
    atomic_store(&lending->is_ready, true);
    if (lending->work_ns == 0) {
        pause_us(20000);
    }
    while (thread_ns() < end_ns) {
    }
    lending->cpu = sched_getcpu();
    atomic_store(&lending->is_done, true);
    eng_affinity_return(&lending->affinity, 1, 2);
    lending->cpu_after = sched_getcpu();
    lending->allowed_after = allowed_count();
}

static void *lend(void *data)
{
    struct lending *lending = data;
    struct eng_processor_look look = {0, 0, 0};
    uint64_t now_ns = 0;
#pragma omp parallel num_threads(2)
    {
        uint32_t thread = (uint32_t)omp_get_thread_num();
        eng_affinity_bind_thread(&lending->affinity, thread, 2);
        if (thread == 1) {
            work(lending);
        }
        while (thread == 0 && !atomic_load(&lending->is_done)) {
            if (atomic_load(&lending->is_ready)) {
                now_ns += lending->look_ns;
                lending->moved +=
                    eng_processor_lend(&lending->affinity, 0, 2, now_ns, &look);
            }
            pause_us(50);
        }
    }
    return NULL;
}

static void lend_beside_burners(struct lending *lending)
{
    (void)usable(&lending->affinity);
    lending->work_ns = 50000000;
    lending->look_ns = 50000;
    atomic_store(&lending->burn, true);
    for (int i = 0; i < BURNERS; i++) {
        assert_int_equal(pthread_create(&lending->burners[i], NULL, burn, lending), 0);
    }
    apart(lend, lending);
    atomic_store(&lending->burn, false);
    for (int i = 0; i < BURNERS; i++) {
        assert_int_equal(pthread_join(lending->burners[i], NULL), 0);
    }
    assert_int_equal(lending->moved, 1);
    assert_int_equal(lending->cpu, lending->affinity.cpu[0]);
    assert_int_equal(lending->cpu_after, lending->affinity.cpu[1]);
    assert_int_equal(lending->allowed_after, 1);
}

/* If it failed: a team would wait for the next tick, and the next, for one of its threads
 * whose processor somebody else has taken; or that thread would stay where it is in the
 * way of another. */
CASE(place__who_waits_lends_its_processor)
{
    static struct lending lending;
    lend_beside_burners(&lending);
}

/* If it failed: two threads would wait for each other until the next tick, one of which
 * has waited, and cannot see that it need not any more. */
CASE(place__who_waits_lends_to_one_that_cannot_look)
{
    static struct lending lending = {.is_waiting = true};
    lend_beside_burners(&lending);
}

/* If it failed: threads that wait, asleep, for a third one would be thrown together. The
 * clock stands at less than any wait sleeps. */
CASE(place__who_waits_itself_is_not_moved)
{
    static struct lending lending = {.is_waiting = true, .look_ns = 100};
    (void)usable(&lending.affinity);
    apart(lend, &lending);
    assert_int_equal(lending.moved, 0);
    assert_int_equal(lending.cpu, lending.affinity.cpu[1]);
}

/* ---- steps ------------------------------------------------------------------------- */

struct stepping {
    struct crew *crew;
    struct eng_affinity affinity;
    uint32_t threads;
    struct sight sight;
};

/* A step, then a region that places nobody: the team is still where the step put it. */
static void *step_with_places(void *data)
{
    struct stepping *stepping = data;
    struct eng_question settings = crew_alone(PCCD_MODE_ALL);
    struct eng_step_result result;
    settings.threads = stepping->threads;
    settings.team_always = true;
    settings.affinity = &stepping->affinity;
    eng_stage_begin(stepping->crew->scene);
    if (eng_step(stepping->crew->scene, &settings, &result) == PCCD_OK) {
        stepping->sight = look(NULL, stepping->threads);
    }
    return NULL;
}

/* If it failed: a step would leave its threads where the kernel put them, or bind those
 * of its process that it does not know. */
CASE_WITH(place__steps_bind_their_team_only, crew_setup, crew_teardown)
{
    static struct stepping stepping;
    stepping.crew = *state;
    stepping.threads = usable(&stepping.affinity);
    int before = allowed_count();
    apart(step_with_places, &stepping);
    assert_int_equal(stepping.sight.count, stepping.threads);
    for (uint32_t i = 0; i < stepping.sight.count; i++) {
        assert_int_equal(stepping.sight.allowed[i], 1); /* its own, or one lent to it */
    }
    assert_int_equal(allowed_count(), before);
}

/* test_srv_runners.c - several threads that compute from one queue. */
#include "cases.h"

#include <semaphore.h>
#include <time.h>

#include "compute.h"
#include "invariant.h"
#include "memory.h"
#include "now.h"

#define CAPACITY 64u
#define PLACES   4u
#define RUNNERS  9u /* five users more than there are places */
#define USERS    12
#define LISTS    6

/* Jobs that wait until they are let go. */
struct gate {
    struct srv_job job; /* first */
    sem_t open;
    _Atomic bool has_begun;
    _Atomic bool has_ended;
    uint32_t runner; /* [compute] that ran it */
    struct srv_claim *claim;
};

static struct srv_compute compute;
static struct srv_group users[USERS];
static struct srv_job_list lists[USERS][LISTS];
static struct gate gates[USERS * LISTS];
static uint32_t gate_count;

static void on_enter(void *context, uint32_t number)
{
    (void)context;
    eng_payer()->number = number;
}

static void on_notify(void *context)
{
    (void)context;
}

static void run(struct srv_job *job)
{
    struct gate *gate = (struct gate *)job;
    srv_assert_compute();
    gate->runner = eng_payer()->number;
    gate->has_begun = true;
    sem_wait(&gate->open);
}

static void done(struct srv_job *job)
{
    ((struct gate *)job)->has_ended = true;
}

static int set_up(void **state)
{
    (void)state;
    srv_thread_enter(SRV_THREAD_LOOP);
    gate_count = 0;
    for (int u = 0; u < USERS; u++) {
        users[u] = (struct srv_group){.running = 0};
        for (int l = 0; l < LISTS; l++) {
            lists[u][l] = (struct srv_job_list){.group = &users[u]};
        }
    }
    const struct srv_compute_settings settings = {CAPACITY, PLACES,    RUNNERS,
                                                  on_enter, on_notify, NULL};
    return srv_compute_start(&compute, &settings);
}

static int tear_down(void **state)
{
    (void)state;
    srv_compute_stop(&compute);
    return 0;
}

/* A job of that list, that uses *claim unless it is NULL. */
static struct gate *push(int user, int list, struct srv_claim *claim)
{
    struct gate *gate = &gates[gate_count++];
    *gate = (struct gate){.claim = claim};
    sem_init(&gate->open, 0, 0);
    srv_job_init(&gate->job, run, done);
    gate->job.claims = &gate->claim;
    gate->job.claim_count = claim != NULL;
    assert_int_equal(srv_compute_push(&compute, &lists[user][list], &gate->job), 0);
    return gate;
}

static void pause_ms(long ms)
{
    const struct timespec pause = {0, ms * 1000000};
    nanosleep(&pause, NULL);
}

/* As the loop does: look, and start what is wanted, until it is so, 10 s at most. */
static bool await(_Atomic bool *flag)
{
    for (int i = 0; i < 10000 && !*flag; i++) {
        bool wants_runner = false;
        (void)srv_compute_look(&compute, &wants_runner);
        if (wants_runner) {
            assert_int_equal(srv_compute_add_runner(&compute), 0);
        }
        srv_compute_drain(&compute);
        pause_ms(1);
    }
    return *flag;
}

/* Nothing of it happens for three times as long as a job is not long. */
static void expect_waiting(struct gate *gate)
{
    uint64_t end_ns = common_now_ns() + 3u * SRV_LONG_NS;
    while (common_now_ns() < end_ns) {
        bool wants_runner = false;
        (void)srv_compute_look(&compute, &wants_runner);
        if (wants_runner) {
            assert_int_equal(srv_compute_add_runner(&compute), 0);
        }
        pause_ms(1);
    }
    assert_false(gate->has_begun);
}

static void end(struct gate *gate)
{
    sem_post(&gate->open);
    assert_true(await(&gate->has_ended));
    sem_destroy(&gate->open);
}

/* If it failed, whoever asks for something would wait until a long job of another session
 * has ended; or two jobs of one session would run at once. */
CASE_WITH(runners__one_begins_beside_a_long_job, set_up, tear_down)
{
    struct gate *first = push(0, 0, NULL);
    assert_true(await(&first->has_begun));
    struct gate *same = push(0, 0, NULL);
    struct gate *other = push(0, 1, NULL);
    assert_true(await(&other->has_begun));
    assert_int_equal(first->runner, 0);
    assert_int_equal(other->runner, 1);
    end(other);
    expect_waiting(same);
    end(first);
    assert_true(await(&same->has_begun));
    end(same);
}

/* If it failed, threads would fight for the processors where one after the other would
 * end sooner, or one that has nothing to do would be woken for each job. */
CASE_WITH(runners__there_is_one_while_no_job_is_long, set_up, tear_down)
{
    for (int i = 0; i < 200; i++) {
        bool wants_runner = true;
        gate_count = 0;
        struct gate *a = push(0, 0, NULL);
        struct gate *b = push(1, 0, NULL);
        sem_post(&a->open);
        sem_post(&b->open);
        if (srv_compute_look(&compute, &wants_runner) > SRV_LONG_NS) {
            fail_msg("it is to look again later than a job can become long");
        }
        assert_true(await(&a->has_ended) && await(&b->has_ended));
    }
    /* Only a machine that took the thread off its processor for 10 ms makes one long. */
    assert_in_range(compute.runner_count, 1, RUNNERS);
    assert_int_equal(gates[0].runner, 0);
    assert_int_equal(compute.running, 0);
    assert_int_equal(compute.long_count, 0);
}

/* If it failed, a user with enough long jobs would stop all others. */
CASE_WITH(runners__a_user_leaves_some_for_others, set_up, tear_down)
{
    struct gate *mine[3];
    for (int i = 0; i < 2; i++) {
        mine[i] = push(0, i, NULL);
        assert_true(await(&mine[i]->has_begun));
    }
    mine[2] = push(0, 2, NULL);
    expect_waiting(mine[2]); /* two of four: as many as are left */
    struct gate *other = push(1, 0, NULL);
    struct gate *third = push(2, 0, NULL);
    assert_true(await(&other->has_begun));
    assert_true(await(&third->has_begun));
    assert_false(mine[2]->has_begun);
    end(other);
    end(third);
    end(mine[0]);
    assert_true(await(&mine[2]->has_begun));
    end(mine[1]);
    end(mine[2]);
}

/* If it failed, two threads would change a scene at once, or a session that must wait for
 * it would hold up others, or be forgotten. */
CASE_WITH(runners__what_is_claimed_is_used_by_one, set_up, tear_down)
{
    struct srv_claim scene = {.is_taken = false};
    struct gate *first = push(0, 0, &scene);
    assert_true(await(&first->has_begun));
    struct gate *second = push(0, 1, &scene);
    struct gate *third = push(1, 0, &scene);
    struct gate *behind = push(1, 0, NULL);
    struct gate *other = push(1, 1, NULL);
    assert_true(await(&other->has_begun));
    end(other);
    expect_waiting(second);
    assert_false(third->has_begun);
    assert_false(behind->has_begun);
    /* What waits for it can go, and what is behind that need not wait any more. */
    assert_true(srv_compute_remove(&compute, &third->job));
    assert_true(await(&behind->has_begun));
    end(behind);
    end(first);
    assert_true(await(&second->has_begun));
    end(second);
    assert_false(scene.is_taken);
    assert_null(compute.turns.aside);
}

/* A long job of each of the first users: as many as places. */
static void take_all_places(struct gate *jobs[PLACES])
{
    for (uint32_t i = 0; i < PLACES; i++) {
        jobs[i] = push((int)i, 0, NULL);
        assert_true(await(&jobs[i]->has_begun));
    }
}

/* If it failed, users with long jobs would shut all others out for as long as these last;
 * or one with many would have more than the others. */
CASE_WITH(runners__a_user_without_one_gets_one_whatever_others_have, set_up, tear_down)
{
    struct gate *jobs[PLACES];
    struct gate *more[RUNNERS - PLACES];
    take_all_places(jobs);
    struct gate *second = push(0, 1, NULL);
    for (uint32_t i = 0; i < RUNNERS - PLACES; i++) {
        more[i] = push((int)(PLACES + i), 0, NULL);
        assert_true(await(&more[i]->has_begun));
        assert_int_equal(more[i]->runner, PLACES + i);
    }
    struct gate *last = push(USERS - 1, 0, NULL);
    expect_waiting(last); /* there are no more threads than that */
    end(more[0]);
    assert_true(await(&last->has_begun));
    end(last);
    for (uint32_t i = 1; i < RUNNERS - PLACES; i++) {
        end(more[i]);
    }
    expect_waiting(second);
    end(jobs[1]);
    end(jobs[2]);
    assert_true(await(&second->has_begun));
    end(second);
    end(jobs[0]);
    end(jobs[3]);
}

/* If it failed, many users who come at once would wait for each other, 10 ms each. */
CASE_WITH(runners__many_who_wait_do_not_wait_long, set_up, tear_down)
{
    struct gate *jobs[PLACES];
    struct gate *more[3];
    bool wants_runner = false;
    for (int user = 0; user < 6; user++) {
        push(user, 0, NULL);
    }
    assert_in_range(srv_compute_look(&compute, &wants_runner), 0, SRV_LONG_NS / 2);
    for (uint32_t i = 0; i < gate_count; i++) {
        sem_post(&gates[i].open);
        assert_true(await(&gates[i].has_ended));
    }
    take_all_places(jobs);
    more[0] = push(6, 0, NULL);
    assert_true(await(&more[0]->has_begun));
    more[1] = push(7, 0, NULL);
    /* At once, though the other has only begun. */
    uint32_t before = compute.runner_count;
    (void)srv_compute_look(&compute, &wants_runner);
    assert_true(wants_runner || before > PLACES + 1);
    for (uint32_t i = 0; i < 2; i++) {
        end(more[i]);
    }
    for (uint32_t i = 0; i < PLACES; i++) {
        end(jobs[i]);
    }
}

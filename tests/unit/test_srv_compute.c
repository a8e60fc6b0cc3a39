/* test_srv_compute.c - the compute thread and its queue. */
#include "cases.h"

#include <semaphore.h>
#include <time.h>

#include "compute.h"
#include "invariant.h"
#include "now.h"
#include "pccd_types.h"

#define CAPACITY 64u
#define RUNS_MAX 256

struct fixture {
    struct srv_compute compute;
    struct srv_group group; /* of all lists but where a test says otherwise */
    sem_t notified;
    sem_t blocked; /* posted when the gate job runs */
    sem_t gate;    /* it waits for this */
    _Atomic int notify_count;
    bool entered; /* compute thread */
    int run
        [RUNS_MAX]; /* names in the order of running: compute thread, read after stop */
    int run_count;
    int done[RUNS_MAX];
    int done_count;
};

struct named_job {
    struct srv_job job; /* first */
    struct fixture *fixture;
    int name;
    bool saw_cancel;
    int parts;
};

static void on_enter(void *context, uint32_t number)
{
    struct fixture *fixture = context;
    srv_assert_compute();
    assert_int_equal(fixture->run_count, 0);
    assert_int_equal(number, 0);
    fixture->entered = true;
}

static void on_notify(void *context)
{
    struct fixture *fixture = context;
    atomic_fetch_add(&fixture->notify_count, 1);
    sem_post(&fixture->notified);
}

static void run_named(struct srv_job *job)
{
    struct named_job *named = (struct named_job *)job;
    srv_assert_compute();
    assert_true(named->fixture->entered);
    named->fixture->run[named->fixture->run_count++] = named->name;
}

static void done_named(struct srv_job *job)
{
    struct named_job *named = (struct named_job *)job;
    srv_assert_loop();
    named->fixture->done[named->fixture->done_count++] = named->name;
}

static void work(uint64_t ns)
{
    uint64_t begin_ns = srv_now_thread_ns();
    while (srv_now_thread_ns() - begin_ns < ns) {
    }
}

/* Works for 10 ms. */
static void run_long(struct srv_job *job)
{
    work(10000000);
    run_named(job);
}

/* Works for 1 ms. */
static void run_short(struct srv_job *job)
{
    work(1000000);
    run_named(job);
}

/* Runs in four parts of a millisecond. */
static void run_part(struct srv_job *job)
{
    struct named_job *named = (struct named_job *)job;
    run_short(job);
    job->goes_on = ++named->parts < 4;
}

/* Waits for 10 ms, as if another process had the processor. */
static void run_late(struct srv_job *job)
{
    const struct timespec pause = {0, 10000000};
    nanosleep(&pause, NULL);
    run_named(job);
}

/* Holds the thread until the gate opens. */
static void run_gate(struct srv_job *job)
{
    struct named_job *named = (struct named_job *)job;
    sem_post(&named->fixture->blocked);
    sem_wait(&named->fixture->gate);
}

/* Runs until it sees its flag, 10 s at most. */
static void run_until_cancelled(struct srv_job *job)
{
    struct named_job *named = (struct named_job *)job;
    sem_post(&named->fixture->blocked);
    for (int i = 0; i < 10000 && !named->saw_cancel; i++) {
        struct timespec millisecond = {0, 1000000};
        named->saw_cancel = atomic_load(&job->cancel);
        if (!named->saw_cancel) {
            nanosleep(&millisecond, NULL);
        }
    }
}

static void name_job(struct named_job *named, struct fixture *fixture, int name,
                     srv_job_fn run)
{
    srv_job_init(&named->job, run, done_named);
    named->fixture = fixture;
    named->name = name;
    named->saw_cancel = false;
    named->parts = 0;
}

/* Name a job and queue it. */
static void push(struct fixture *fixture, struct srv_job_list *list,
                 struct named_job *named, int name, srv_job_fn run)
{
    name_job(named, fixture, name, run);
    assert_int_equal(srv_compute_push(&fixture->compute, list, &named->job), 0);
}

static int set_up(void **state)
{
    static struct fixture fixture;
    fixture = (struct fixture){.run_count = 0};
    srv_thread_enter(SRV_THREAD_LOOP);
    sem_init(&fixture.notified, 0, 0);
    sem_init(&fixture.blocked, 0, 0);
    sem_init(&fixture.gate, 0, 0);
    *state = &fixture;
    const struct srv_compute_settings settings = {CAPACITY, 1,         1,
                                                  on_enter, on_notify, &fixture};
    return srv_compute_start(&fixture.compute, &settings);
}

static int tear_down(void **state)
{
    struct fixture *fixture = *state;
    sem_destroy(&fixture->notified);
    sem_destroy(&fixture->blocked);
    sem_destroy(&fixture->gate);
    return 0;
}

static void open_lists(struct srv_group *group, struct srv_job_list *lists, int count)
{
    for (int i = 0; i < count; i++) {
        lists[i] = (struct srv_job_list){.group = group};
    }
}

/* Wait until `count` jobs are done; each wait ends within 10 s. */
static void drain(struct fixture *fixture, int count)
{
    while (fixture->done_count < count) {
        const struct timespec pause = {.tv_nsec = 1000000};
        for (int i = 0; sem_trywait(&fixture->notified) != 0; i++) {
            assert_true(i < 10000);
            nanosleep(&pause, NULL);
        }
        srv_compute_drain(&fixture->compute);
    }
}

static void block(struct fixture *fixture, struct srv_job_list *list,
                  struct named_job *gate)
{
    push(fixture, list, gate, -1, run_gate);
    sem_wait(&fixture->blocked);
}

/* A session that pipelines mesh.data, mesh.commit and scene.add relies on this order. */
CASE_WITH(compute__jobs_of_a_lane_run_in_order, set_up, tear_down)
{
    struct fixture *fixture = *state;
    struct srv_job_list list = {.group = &fixture->group};
    struct named_job jobs[50];
    for (int i = 0; i < 50; i++) {
        push(fixture, &list, &jobs[i], i, run_named);
    }
    drain(fixture, 50);
    srv_compute_stop(&fixture->compute);
    for (int i = 0; i < 50; i++) {
        assert_int_equal(fixture->run[i], i);
        assert_int_equal(fixture->done[i], i);
    }
}

/* Return where in the order of running job `name` came. */
static int place_of(const struct fixture *fixture, int name)
{
    int at = 0;
    while (at < fixture->run_count && fixture->run[at] != name) {
        at++;
    }
    return at;
}

/* A session with many jobs must delay another by about as many, not by all, and so must
 * a user with many sessions delay another user. */
CASE_WITH(compute__users_and_their_sessions_take_turns, set_up, tear_down)
{
    struct fixture *fixture = *state;
    struct srv_group other = {.running = 0};
    struct srv_group none = {.running = 0};
    struct srv_job_list lists[4];
    struct named_job gate;
    struct named_job jobs[16];
    open_lists(&fixture->group, lists, 2); /* one user has two sessions with six each */
    open_lists(&other, lists + 2, 1);      /* one has a session with four */
    open_lists(&none, lists + 3, 1);
    block(fixture, &lists[3], &gate);
    for (int i = 0; i < 16; i++) {
        push(fixture, &lists[i / 6], &jobs[i], i, run_long);
    }
    assert_int_equal(srv_compute_queued(&fixture->compute), 16);
    sem_post(&fixture->gate);
    drain(fixture, 17);
    srv_compute_stop(&fixture->compute);
    /* Job by job it would be 7 or 8 for the last of the four, and 3 or 4 for the second
     * of each session of the other user; nobody sleeps for as long as he wants to. */
    assert_true(place_of(fixture, 15) <= 10);
    assert_true(place_of(fixture, 12) <= 2);
    assert_true(place_of(fixture, 1) <= 8 && place_of(fixture, 7) <= 8);
}

/* Queue `count` jobs, `each` of a session, of which the first runs as `first` says, and
 * check in which order they run. */
static void expect_order(struct fixture *fixture, int count, int each, srv_job_fn first,
                         srv_job_fn others, const int *expected, int run_count)
{
    struct srv_job_list lists[3];
    struct named_job gate;
    struct named_job jobs[6];
    open_lists(&fixture->group, lists, 3);
    block(fixture, &lists[2], &gate);
    for (int i = 0; i < count; i++) {
        push(fixture, &lists[i / each], &jobs[i], i, i == 0 ? first : others);
    }
    sem_post(&fixture->gate);
    drain(fixture, count + 1);
    srv_compute_stop(&fixture->compute);
    assert_int_equal(fixture->run_count, run_count);
    assert_memory_equal(fixture->run, expected, (size_t)run_count * sizeof *expected);
}

/* Without it a session whose jobs take long would keep the others waiting as often as it
 * has jobs, however little they ask for. */
CASE_WITH(compute__what_a_job_took_is_charged_to_its_lane, set_up, tear_down)
{
    static const int expected[6] = {0, 3, 4, 5, 1, 2};
    expect_order(*state, 6, 3, run_long, run_named, expected, 6);
}

/* Without it, where processors are short, a client would be made to wait because others
 * had the processor while its job ran. */
CASE_WITH(compute__what_a_job_waits_is_not_charged, set_up, tear_down)
{
    static const int expected[4] = {0, 2, 1, 3};
    expect_order(*state, 4, 2, run_late, run_short, expected, 4);
}

/* Without it a large upload would hold up everybody for as long as it takes to copy; a
 * part that ran before its turn, or after another job of its session, would be wrong,
 * too. */
CASE_WITH(compute__others_come_between_the_parts_of_a_job, set_up, tear_down)
{
    struct fixture *fixture = *state;
    static const int expected[6] = {0, 2, 0, 0, 0, 1};
    expect_order(fixture, 3, 2, run_part, run_named, expected, 6);
    assert_int_equal(fixture->done[1], 2); /* done once, when the last part is */
    assert_int_equal(fixture->done[2], 0);
}

/* If a job could not be taken back between its parts, a client that has gone would be
 * worked for until the end. */
CASE_WITH(compute__a_job_can_be_removed_between_its_parts, set_up, tear_down)
{
    struct fixture *fixture = *state;
    struct srv_job_list lists[2];
    struct named_job gate;
    struct named_job job;
    open_lists(&fixture->group, lists, 2);
    block(fixture, &lists[1], &gate);
    push(fixture, &lists[0], &job, 0, run_part);
    struct named_job second;
    push(fixture, &lists[1], &second, -1, run_gate);
    sem_post(&fixture->gate);
    sem_wait(&fixture->blocked); /* the second gate: behind the first part, by its cost */
    assert_int_equal(fixture->run_count, 1);
    assert_true(srv_compute_remove(&fixture->compute, &job.job));
    assert_int_equal(srv_compute_queued(&fixture->compute), 0);
    sem_post(&fixture->gate);
    drain(fixture, 2);
    srv_compute_stop(&fixture->compute);
    assert_int_equal(fixture->run_count, 1);
}

/* An unbounded queue would let clients fill the memory; freeing must never be refused. */
CASE_WITH(compute__queue_is_bounded_but_not_for_reaping, set_up, tear_down)
{
    struct fixture *fixture = *state;
    struct srv_job_list list = {.group = &fixture->group};
    struct named_job gate;
    static struct named_job jobs[CAPACITY + 2];
    block(fixture, &list, &gate);
    for (uint32_t i = 0; i < CAPACITY; i++) {
        push(fixture, &list, &jobs[i], (int)i, run_named);
    }
    name_job(&jobs[CAPACITY], fixture, 1000, run_named);
    assert_int_equal(srv_compute_push(&fixture->compute, &list, &jobs[CAPACITY].job),
                     PCCD_E_BUSY);
    srv_compute_push_reap(&fixture->compute, &list, &jobs[CAPACITY].job);
    sem_post(&fixture->gate);
    drain(fixture, (int)CAPACITY + 2);
    name_job(&jobs[CAPACITY + 1], fixture, 1001, run_named);
    assert_ok(srv_compute_push(&fixture->compute, &list, &jobs[CAPACITY + 1].job));
    drain(fixture, (int)CAPACITY + 3);
    srv_compute_stop(&fixture->compute);
    assert_int_equal(fixture->run[CAPACITY], 1000);
    assert_int_equal(fixture->run[CAPACITY + 1], 1001);
}

static void stop_counting(struct srv_job *job, void *context)
{
    (void)context;
    job->counts = false;
}

/* If it failed, a client that has its answer at a deadline, or whose meshes are being
 * freed, would be refused the next thing for what nobody waits for: where the queue is
 * short, in each of its tries. */
CASE_WITH(compute__what_nobody_waits_for_takes_no_room, set_up, tear_down)
{
    struct fixture *fixture = *state;
    struct srv_job_list list = {.group = &fixture->group};
    struct named_job gate;
    struct named_job jobs[5];
    block(fixture, &list, &gate);
    srv_compute_resize(&fixture->compute, 1);
    for (int i = 0; i < 5; i++) {
        name_job(&jobs[i], fixture, i, run_named);
    }
    srv_compute_push_reap(&fixture->compute, &list, &jobs[0].job);
    assert_int_equal(srv_compute_push(&fixture->compute, &list, &jobs[1].job), 0);
    assert_int_equal(srv_compute_push(&fixture->compute, &list, &jobs[2].job),
                     PCCD_E_BUSY);
    assert_true(srv_compute_amend(&fixture->compute, &jobs[1].job, stop_counting, NULL));
    assert_int_equal(srv_compute_push(&fixture->compute, &list, &jobs[2].job), 0);
    assert_int_equal(srv_compute_push(&fixture->compute, &list, &jobs[3].job),
                     PCCD_E_BUSY);
    assert_true(srv_compute_remove(&fixture->compute, &jobs[2].job));
    assert_int_equal(srv_compute_push(&fixture->compute, &list, &jobs[3].job), 0);
    assert_int_equal(srv_compute_queued(&fixture->compute), 3);
    sem_post(&fixture->gate);
    drain(fixture, 4);
    assert_int_equal(srv_compute_push(&fixture->compute, &list, &jobs[4].job), 0);
    drain(fixture, 5);
    srv_compute_stop(&fixture->compute);
    assert_int_equal(fixture->run_count, 4);
}

/* A job taken back must neither run nor be reported, and the others must stay in
 * order. */
CASE_WITH(compute__removed_jobs_do_not_run, set_up, tear_down)
{
    struct fixture *fixture = *state;
    struct srv_job_list lists[3];
    struct named_job gate;
    struct named_job jobs[6];
    static const int lane_of[6] = {0, 0, 0, 1, 2, 2};
    open_lists(&fixture->group, lists, 3);
    block(fixture, &lists[0], &gate);
    for (int i = 0; i < 6; i++) {
        push(fixture, &lists[lane_of[i]], &jobs[i], i, run_named);
    }
    assert_true(srv_compute_remove(&fixture->compute, &jobs[1].job));  /* in the middle */
    assert_true(srv_compute_remove(&fixture->compute, &jobs[3].job));  /* a whole list */
    assert_true(srv_compute_remove(&fixture->compute, &jobs[5].job));  /* the last */
    assert_false(srv_compute_remove(&fixture->compute, &jobs[5].job)); /* not twice */
    assert_false(srv_compute_remove(&fixture->compute, &gate.job));    /* it runs */
    assert_int_equal(srv_compute_queued(&fixture->compute), 3);
    assert_int_equal(srv_compute_push(&fixture->compute, &lists[1], &jobs[3].job), 0);
    sem_post(&fixture->gate);
    drain(fixture, 5);
    assert_false(srv_compute_remove(&fixture->compute, &jobs[0].job)); /* it is done */
    srv_compute_stop(&fixture->compute);
    assert_int_equal(fixture->run_count, 4);
    assert_true(place_of(fixture, 0) < place_of(fixture, 2));
    assert_true(place_of(fixture, 2) < 4 && place_of(fixture, 3) < 4 &&
                place_of(fixture, 4) < 4);
}

static void count_change(struct srv_job *job, void *context)
{
    (void)job;
    ++*(int *)context;
}

/* If it failed, a request would be answered at its deadline while it is computed, and
 * again when it is done. */
CASE_WITH(compute__only_queued_jobs_are_changed, set_up, tear_down)
{
    struct fixture *fixture = *state;
    struct srv_job_list list;
    struct named_job gate;
    struct named_job job;
    int changes = 0;
    open_lists(&fixture->group, &list, 1);
    block(fixture, &list, &gate);
    push(fixture, &list, &job, 0, run_named);
    assert_true(srv_compute_amend(&fixture->compute, &job.job, count_change, &changes));
    assert_false(srv_compute_amend(&fixture->compute, &gate.job, count_change, &changes));
    assert_int_equal(changes, 1);
    sem_post(&fixture->gate);
    drain(fixture, 2);
    assert_false(srv_compute_amend(&fixture->compute, &job.job, count_change, &changes));
    srv_compute_stop(&fixture->compute);
    assert_int_equal(changes, 1);
    assert_int_equal(fixture->run_count, 1);
}

/* A step that never sees its flag would hold up every other session. */
CASE_WITH(compute__running_job_sees_its_cancel_flag, set_up, tear_down)
{
    struct fixture *fixture = *state;
    struct srv_job_list list = {.group = &fixture->group};
    struct named_job job;
    push(fixture, &list, &job, 1, run_until_cancelled);
    sem_wait(&fixture->blocked);
    assert_false(srv_compute_remove(&fixture->compute, &job.job));
    atomic_store(&job.job.cancel, true);
    drain(fixture, 1);
    srv_compute_stop(&fixture->compute);
    assert_true(job.saw_cancel);
}

/* One notification a batch: a wake-up per job would cost more than a small job. */
CASE_WITH(compute__completions_are_batched, set_up, tear_down)
{
    struct fixture *fixture = *state;
    struct srv_job_list list = {.group = &fixture->group};
    struct named_job jobs[20];
    struct named_job gate;
    for (int i = 0; i < 20; i++) {
        push(fixture, &list, &jobs[i], i, run_named);
    }
    block(fixture, &list, &gate); /* now the 20 have finished and nobody has drained */
    assert_int_equal(atomic_load(&fixture->notify_count), 1);
    assert_int_equal(srv_compute_drain(&fixture->compute), 20);
    assert_int_equal(srv_compute_drain(&fixture->compute), 0);
    sem_post(&fixture->gate);
    drain(fixture, 21);
    assert_int_equal(atomic_load(&fixture->notify_count), 2);
    srv_compute_stop(&fixture->compute);
}

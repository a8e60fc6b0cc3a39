/* test_int_long.c - requests that take long, and those of others meanwhile. */
#include "cases.h"

#include <grp.h>
#include <signal.h>
#include <stdatomic.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include "fixture.h"
#include "grid.h"
#include "hog.h"
#include "must.h"

#define OTHER_USER 65534u
#define HOGS_MAX   9  /* one more than requests that have threads of their own */
#define STEPS      25 /* beside one request, at least */
#define STEPS_MAX  100000u

/* Shared with the process of a hog. */
struct sty {
    atomic_uint begun;  /* long requests that it has sent */
    atomic_uint ended;  /* of these, answered */
    atomic_bool failed; /* one of them, or what came before */
    atomic_bool stop;
    pid_t pid;
};

static struct sty *sties; /* [HOGS_MAX] */
static uint32_t steps;    /* LONG_STEPS; 0: no table */
/* A commit that has begun is not cancelled: it is to end before its daemon has to. */
#define HEAP (TEST_HAS_FOREIGN_THREAD ? 100000 : 400000)

static const uint32_t sizes_checked[HOG_KINDS] = {3000, 50000, HEAP};
static const uint32_t sizes_measured[HOG_KINDS] = {2000, 50000, 1000000};

static int start(void **state)
{
    const char *text = getenv("LONG_STEPS");

    (void)state;
    steps = text != NULL ? (uint32_t)strtoul(text, NULL, 10) : 0;
    steps = steps < STEPS_MAX ? steps : STEPS_MAX;
    sties = mmap(NULL, HOGS_MAX * sizeof *sties, PROT_READ | PROT_WRITE,
                 MAP_SHARED | MAP_ANONYMOUS, -1, 0);
    return sties != MAP_FAILED ? 0 : -1;
}

/* A daemon for each test: what hogs of another have left would be computed in it, too. */
static int open_daemon(void **state)
{
    static const char *const options[] = {"--contacts-max", "100000", NULL};

    (void)state;
    return test_shared_start_with(options) == 0 &&
                   chmod(test_shared.directory, 0755) == 0 &&
                   chmod(test_shared.socket, 0666) == 0
               ? 0
               : -1;
}

/* ---- hogs -------------------------------------------------------------------------- */

/* In a child: one long request after the other. */
static bool live(struct sty *sty, enum hog_kind kind, uint32_t triangles)
{
    static struct hog hog;

    if (!test_hog_open(&hog, test_shared.socket, kind, triangles)) {
        return false;
    }
    while (!atomic_load(&sty->stop)) {
        atomic_fetch_add(&sty->begun, 1);
        if (!test_hog_begin(&hog) || test_hog_end(&hog, NULL) != 0) {
            return false;
        }
        atomic_fetch_add(&sty->ended, 1);
        if (!test_hog_again(&hog)) {
            return false;
        }
    }
    test_hog_close(&hog);
    return true;
}

/* Let one in, of that user unless it is 0. It has asked when this returns. */
static void let_in(int number, enum hog_kind kind, uint32_t triangles, uid_t user)
{
    struct sty *sty = &sties[number];
    pid_t pid;

    memset(sty, 0, sizeof *sty);
    pid = fork();
    assert_true(pid >= 0);
    if (pid == 0) {
        bool is_right_user = user == 0 || (setgroups(0, NULL) == 0 && setgid(user) == 0 &&
                                           setuid(user) == 0);
        test_end_with_parent();
        atomic_store(&sty->failed, !is_right_user || !live(sty, kind, triangles));
        _exit(0);
    }
    sty->pid = pid;
    for (int i = 0; i < 6000 && atomic_load(&sty->begun) == 0; i++) {
        test_sleep_ms(10);
    }
    test_sleep_ms(50);
    assert_false(atomic_load(&sty->failed));
    assert_true(atomic_load(&sty->begun) > 0);
}

static bool is_busy(const struct sty *sty)
{
    return atomic_load(&sty->begun) > atomic_load(&sty->ended);
}

static void drive_out(struct sty *sty)
{
    pid_t pid = sty->pid;

    sty->pid = 0;
    assert_int_equal(kill(pid, SIGKILL), 0);
    assert_int_equal(waitpid(pid, NULL, 0), pid);
    assert_false(atomic_load(&sty->failed));
}

/* After a test, whatever it came to. */
static int close_daemon(void **state)
{
    for (int i = 0; i < HOGS_MAX; i++) {
        if (sties[i].pid != 0) {
            drive_out(&sties[i]);
        }
    }
    return test_shared_stop(state);
}

/* ---- beside ------------------------------------------------------------------------ */

/* Steps that are answered while the long request that is computed now goes on, up to
 * `most`. */
static uint32_t step_beside(struct test_crossing *crossing, const struct sty *sty,
                            uint32_t most)
{
    uint32_t count = 0;
    uint32_t ended;

    for (int i = 0; i < 60000 && !is_busy(sty); i++) {
        test_sleep_ms(1);
    }
    ended = atomic_load(&sty->ended);
    while (count < most) {
        assert_true(test_crossing_turn(crossing));
        if (atomic_load(&sty->ended) != ended || !is_busy(sty)) {
            break;
        }
        count++;
    }
    return count;
}

static void check_beside(enum hog_kind kind, bool is_other)
{
    struct test_crossing crossing;
    struct pccd_client *client = test_client_at(test_shared.url);
    uint32_t most = 0;

    assert_ok(test_crossing_make(client, &crossing));
    let_in(0, kind, sizes_checked[kind], is_other ? OTHER_USER : 0);
    /* What prepares it is over soon after, as a commit is: some rounds of these. */
    for (int i = 0; i < 5 && most < STEPS; i++) {
        uint32_t count = step_beside(&crossing, &sties[0], STEPS);
        most = count > most ? count : most;
    }
    print_message("# %s of %s: %u steps during one\n", test_hog_name(kind),
                  is_other ? "another user" : "the same user", most);
    assert_int_equal(most, STEPS);
    drive_out(&sties[0]);
    pccd_close(client);
}

/* If it failed, a client's request would have to wait until what another one has asked
 * for is computed, however long that takes. */
CASE_WITH(long__request_of_the_same_user_holds_up_nobody, open_daemon, close_daemon)
{
    for (enum hog_kind kind = 0; kind < HOG_KINDS; kind++) {
        check_beside(kind, false);
    }
}

/* The same of users who have nothing to do with each other. */
CASE_WITH(long__request_of_another_user_holds_up_nobody, open_daemon, close_daemon)
{
    if (geteuid() != 0) {
        test_skip(TEST_ONLY_ROOT);
    }
    for (enum hog_kind kind = 0; kind < HOG_KINDS; kind++) {
        check_beside(kind, true);
    }
}

/* If it failed, a user with three such requests would stop all sessions of this user, or
 * those of others, too. */
CASE_WITH(long__three_at_once_hold_up_nobody, open_daemon, close_daemon)
{
    bool is_other = geteuid() == 0;
    struct test_crossing crossing;
    struct pccd_client *client = test_client_at(test_shared.url);

    assert_ok(test_crossing_make(client, &crossing));
    for (int i = 0; i < 3; i++) {
        let_in(i, HOG_COINCIDENT, sizes_checked[HOG_COINCIDENT],
               is_other && i == 0 ? OTHER_USER : 0);
    }
    assert_int_equal(step_beside(&crossing, &sties[1], STEPS), STEPS);
    for (int i = 0; i < 3; i++) {
        assert_true(is_busy(&sties[i]));
        drive_out(&sties[i]);
    }
    pccd_close(client);
}

/* If it failed, as many users as have threads of their own, each with a step of seconds,
 * would shut everybody else out for as long as these last. */
CASE_WITH(long__nine_users_shut_nobody_out, open_daemon, close_daemon)
{
    struct test_crossing crossing;

    if (geteuid() != 0) {
        test_skip(TEST_ONLY_ROOT);
    }
    for (int i = 0; i < HOGS_MAX; i++) {
        let_in(i, HOG_COINCIDENT, sizes_checked[HOG_COINCIDENT], OTHER_USER - (uid_t)i);
    }
    struct pccd_client *client = test_client_at(test_shared.url);
    assert_ok(test_crossing_make(client, &crossing));
    assert_true(test_crossing_turn(&crossing));
    for (int i = 0; i < HOGS_MAX; i++) {
        assert_int_equal(atomic_load(&sties[i].ended), 0);
    }
    pccd_close(client);
}

/* One turn of the grid, down or up. */
static struct pccd_answer turn(struct test_grid *grid)
{
    struct pccd_answer answer = PCCD_ANSWER_INIT;
    uint64_t step = 0;

    assert_ok(test_grid_submit(grid, NULL, &step));
    assert_ok(pccd_wait(grid->client, step, 600000, &answer));
    assert_true(test_grid_is_right(grid, &answer));
    pccd_answer_release(grid->client, &answer);
    return answer;
}

/* If it failed, what a step finds would depend on which thread computes it, or on what is
 * computed meanwhile. */
CASE_WITH(long__answers_beside_it_are_the_same_bytes, open_daemon, close_daemon)
{
    struct pccd_client *client = test_client_at(test_shared.url);
    struct pccd_answer alone[2] = {PCCD_ANSWER_INIT, PCCD_ANSWER_INIT};
    struct test_grid grid;

    assert_ok(test_grid_make(client, 60, &grid));
    for (int i = 0; i < 2; i++) {
        alone[i] = turn(&grid);
    }
    let_in(0, HOG_COINCIDENT, sizes_checked[HOG_COINCIDENT], 0);
    for (int i = 0; i < 6; i++) {
        struct pccd_answer beside = turn(&grid);
        const struct pccd_answer *same = &alone[i % 2];
        assert_true(is_busy(&sties[0]));
        assert_memory_equal(beside.hash, same->hash, sizeof same->hash);
        assert_int_equal(beside.total, same->total);
    }
    drive_out(&sties[0]);
    test_grid_close(&grid);
}

/* ---- a scene that is used by both -------------------------------------------------- */

/* A client that takes part in the scene "stack". */
static struct pccd_client *take_part(uint32_t *scene)
{
    const struct pccd_scene_settings settings = {.name = "stack",
                                                 .share = PCCD_SHARE_OPEN};
    struct pccd_client *client = test_client_at(test_shared.url);

    assert_ok(pccd_scene_create(client, &settings, scene));
    return client;
}

/* Coincident triangles. */
static void add_stack(struct pccd_client *client, uint32_t scene, uint32_t triangles)
{
    static const float corners[3][3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    float(*x)[3] = malloc(3 * triangles * sizeof *x);
    uint32_t(*indices)[3] = malloc(triangles * sizeof *indices);

    assert_true(x != NULL && indices != NULL);
    for (uint32_t i = 0; i < 3 * triangles; i++) {
        memcpy(x[i], corners[i % 3], sizeof *x);
        indices[i / 3][i % 3] = i;
    }
    uint32_t mesh =
        test_mesh(client, x, PCCD_FORMAT_F32, 3 * triangles, indices, triangles);
    (void)test_object(client, scene, mesh);
    free(x);
    free(indices);
}

/* Ends early, as it is told to. */
static void cancel(struct pccd_client *client, uint64_t step)
{
    struct pccd_answer answer = PCCD_ANSWER_INIT;

    assert_ok(pccd_cancel(client, step));
    assert_ok(pccd_wait(client, step, 60000, &answer));
    assert_int_equal(answer.incomplete, PCCD_INCOMPLETE_CANCELLED);
    pccd_answer_release(client, &answer);
}

/* If it failed, two threads would work on one scene at once, or a member whose step waits
 * for that of another would hold up those who have nothing to do with the scene. */
CASE_WITH(long__step_of_a_shared_scene_holds_up_only_its_members, open_daemon,
          close_daemon)
{
    struct pccd_client *clients[2];
    struct test_crossing crossing;
    struct pccd_answer answer = PCCD_ANSWER_INIT;
    uint32_t scenes[2];
    uint64_t submitted[2];
    struct pccd_client *client = test_client_at(test_shared.url);

    assert_ok(test_crossing_make(client, &crossing));
    for (int i = 0; i < 2; i++) {
        clients[i] = take_part(&scenes[i]);
    }
    add_stack(clients[0], scenes[0], sizes_checked[HOG_COINCIDENT]);
    for (int i = 0; i < 2; i++) {
        assert_ok(pccd_submit_still(clients[i], scenes[i], NULL, &submitted[i]));
    }
    for (int i = 0; i < STEPS; i++) {
        assert_true(test_crossing_turn(&crossing));
    }
    for (int i = 0; i < 2; i++) {
        assert_int_equal(pccd_poll(clients[i], &answer), PCCD_E_AGAIN);
    }
    cancel(clients[0], submitted[0]);
    assert_int_equal(pccd_poll(clients[1], &answer), PCCD_E_AGAIN); /* its turn is now */
    cancel(clients[1], submitted[1]);
    for (int i = 0; i < 2; i++) {
        pccd_close(clients[i]);
    }
    pccd_close(client);
}

/* ---- a bound ----------------------------------------------------------------------- */

/* A step of coincident triangles, with a deadline unless that is 0. Returns how it ended;
 * *taken_ms: what it took. */
static enum pccd_incomplete step_stack(struct pccd_client *client, uint32_t scene,
                                       uint64_t deadline_ms, uint64_t *taken_ms)
{
    const struct pccd_step_settings settings = {.struct_bytes =
                                                    sizeof(struct pccd_step_settings),
                                                .deadline_ns = deadline_ms * 1000000};
    struct pccd_answer answer = PCCD_ANSWER_INIT;
    uint64_t begin_ms = test_now_ms();
    uint64_t step = 0;

    assert_ok(pccd_submit_still(client, scene, &settings, &step));
    assert_ok(pccd_wait(client, step, 600000, &answer));
    *taken_ms = test_now_ms() - begin_ms;
    pccd_answer_release(client, &answer);
    return answer.incomplete;
}

/* If it failed, an operator could not keep steps from computing for as long as they like,
 * or clients would be told something else than of a deadline of their own, or would have
 * that changed. */
CASE(long__step_ends_when_the_operator_says)
{
    static const char *const options[] = {"--step-max-ms", "300", NULL};
    struct test_crossing crossing;
    struct test_daemon daemon;
    struct pccd_client *client;
    uint64_t taken_ms = 0;

    assert_true(test_daemon_start(&daemon, options));
    client = test_client_at(daemon.url);
    uint32_t scene = test_scene(client);
    add_stack(client, scene, sizes_checked[HOG_COINCIDENT]);
    assert_int_equal(step_stack(client, scene, 0, &taken_ms), PCCD_INCOMPLETE_DEADLINE);
    assert_true(taken_ms >= 300);
    assert_int_equal(step_stack(client, scene, 60000, &taken_ms),
                     PCCD_INCOMPLETE_DEADLINE);
    assert_true(taken_ms >= 300 && taken_ms < 30000);
    /* The client's own one is sooner; then the operator's is later, and sooner again. */
    assert_ok(pccd_config_set(client, "step-max-ms", "60000"));
    assert_int_equal(step_stack(client, scene, 50, &taken_ms), PCCD_INCOMPLETE_DEADLINE);
    assert_true(taken_ms >= 50 && taken_ms < 30000);
    assert_ok(pccd_config_set(client, "step-max-ms", "20"));
    assert_int_equal(step_stack(client, scene, 0, &taken_ms), PCCD_INCOMPLETE_DEADLINE);
    assert_true(taken_ms >= 20 && taken_ms < 30000);
    assert_int_equal(pccd_config_set(client, "step-max-ms", "86400001"), PCCD_E_INVAL);
    /* Whatever it is, what needs less time is whole; 0 bounds nothing. */
    assert_ok(pccd_config_set(client, "step-max-ms", "5000"));
    assert_ok(test_crossing_make(client, &crossing));
    assert_true(test_crossing_turn(&crossing));
    assert_ok(pccd_config_set(client, "step-max-ms", "0"));
    assert_int_equal(step_stack(client, scene, 700, &taken_ms), PCCD_INCOMPLETE_DEADLINE);
    assert_true(taken_ms >= 700);
    pccd_close(client);
    assert_true(test_daemon_finish(&daemon));
}

/* ---- the table --------------------------------------------------------------------- */

struct times {
    double p50_ms;
    double p99_ms;
    uint32_t count;
};

static int by_value(const void *a, const void *b)
{
    uint64_t x = *(const uint64_t *)a;
    uint64_t y = *(const uint64_t *)b;

    return (x > y) - (x < y);
}

/* Steps of the grid, with pauses as of a program that draws: beside the hog only those
 * that were begun while its request was computed. */
static struct times measure(struct test_grid *grid, const struct sty *sty, uint32_t count)
{
    static uint64_t taken_us[STEPS_MAX];
    struct times times = {.count = 0};
    uint64_t end_ms = test_now_ms() + 120000;

    while (times.count < count && test_now_ms() < end_ms) {
        bool counts = sty == NULL || is_busy(sty);
        uint64_t begin_us = test_now_us();
        (void)turn(grid);
        taken_us[times.count] = test_now_us() - begin_us;
        times.count += counts;
        (void)usleep(1000);
    }
    assert_true(times.count > 0);
    qsort(taken_us, times.count, sizeof *taken_us, by_value);
    times.p50_ms = (double)taken_us[times.count / 2] / 1000;
    times.p99_ms = (double)taken_us[times.count - 1 - times.count / 100] / 1000;
    return times;
}

static void measure_kind(struct test_grid *grid, enum hog_kind kind, bool is_other)
{
    struct times alone = measure(grid, NULL, steps);
    struct times beside;

    let_in(0, kind, sizes_measured[kind], is_other ? OTHER_USER : 0);
    beside = measure(grid, &sties[0], steps);
    drive_out(&sties[0]);
    print_message("# %-20s %-7s %6u triangles: alone p50 %7.2f p99 %7.2f ms, beside p50 "
                  "%7.2f p99 %7.2f ms (%u steps); 2 x p99 alone + 20 ms: %s\n",
                  test_hog_name(kind), is_other ? "other" : "same",
                  2 * (grid->side - 1) * (grid->side - 1), alone.p50_ms, alone.p99_ms,
                  beside.p50_ms, beside.p99_ms, beside.count,
                  beside.p99_ms <= 2 * alone.p99_ms + 20 ? "within" : "beyond");
}

/* The figures, on a machine that is left alone. */
CASE_WITH(long__requests_leave_others_their_share, open_daemon, close_daemon)
{
    static const uint32_t sides[] = {3, 60, 250};

    if (steps == 0) {
        test_skip("LONG_STEPS is not set");
    }
    for (size_t i = 0; i < sizeof sides / sizeof sides[0]; i++) {
        struct pccd_client *client = test_client_at(test_shared.url);
        struct test_grid grid;

        assert_ok(test_grid_make(client, sides[i], &grid));
        for (enum hog_kind kind = 0; kind < HOG_KINDS; kind++) {
            measure_kind(&grid, kind, false);
            if (geteuid() == 0) {
                measure_kind(&grid, kind, true);
            }
        }
        pccd_close(client);
        test_grid_free(&grid);
    }
}

CASES_WITH(start, NULL);

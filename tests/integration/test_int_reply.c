/* test_int_reply.c - steps that are answered by the thread that has computed them. */
#include "cases.h"

#include <signal.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#include "crossing.h"
#include "daemon.h"
#include "fixture.h"
#include "grid.h"
#include "must.h"

#define TURNS  100
#define SIDE   12 /* of a grid that is no brief step */
#define KILLED 20

#define SIDE_SLOW 200 /* of one whose steps take longer than a client spins */
#define SPIN_US   300u

static uint64_t replied(const struct test_crossing *crossing)
{
    return test_stat(crossing->client, "steps_replied");
}

static void turn(struct test_grid *grid)
{
    uint64_t step;

    assert_ok(test_grid_submit(grid, NULL, &step));
    assert_ok(test_grid_await(grid, step));
}

/* If it failed: every step would wait for one more processor to wake; or a client that
 * has an answer would hear from the daemon that the step goes on. */
CASE_CROSSING(reply__comes_from_where_it_was_computed)
{
    struct test_crossing *crossing = *state;
    struct test_grid grid;
    uint64_t before;

    assert_ok(test_grid_make(test_connect(test_shared.url), SIDE, &grid));
    before = replied(crossing);
    for (int i = 0; i < TURNS; i++) {
        uint64_t steps = test_stat(crossing->client, "steps");

        turn(&grid);
        assert_int_equal(test_stat(crossing->client, "steps"), steps + 1);
    }
    if (test_is_direct()) {
        assert_int_equal(replied(crossing), before);
    } else {
        assert_int_equal(replied(crossing), before + TURNS);
    }
    pccd_close(grid.client);
    grid.client = NULL;
    test_grid_free(&grid);
}

/* If it failed: a step that was answered would count as one in flight, and the next one
 * be refused; or pages would come in another order than they go back. */
CASE_CROSSING(reply__leaves_room_for_the_next_step)
{
    struct test_crossing *crossing = *state;
    struct test_grid grid;
    uint64_t steps[4];

    (void)crossing;
    struct pccd_client *client = test_client(
        &(struct pccd_options){.url = test_shared.url, .slot_count = 4, .spin_us = 20});
    assert_ok(test_grid_make(client, SIDE, &grid));
    for (int i = 0; i < 4; i++) {
        assert_ok(test_grid_submit(&grid, NULL, &steps[i]));
    }
    for (int i = 0; i < 10 * TURNS; i++) {
        struct pccd_answer answer = PCCD_ANSWER_INIT;

        assert_ok(pccd_wait(client, steps[i % 4], -1, &answer));
        assert_true(test_grid_is_right(&grid, &answer));
        pccd_answer_release(client, &answer);
        assert_ok(test_grid_submit(&grid, NULL, &steps[i % 4]));
    }
    for (int i = 0; i < 4; i++) {
        assert_ok(test_grid_await(&grid, steps[i]));
    }
    pccd_close(client);
    grid.client = NULL;
    test_grid_free(&grid);
}

/* Return the processor time that this thread has had. */
static uint64_t own_us(void)
{
    struct timespec time;

    assert_int_equal(clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time), 0);
    return (uint64_t)time.tv_sec * 1000000u + (uint64_t)time.tv_nsec / 1000u;
}

/* If it failed: who waits for steps that take longer than it spins would take a processor
 * of the team for each, or keep the daemon from the only one. */
CASE_CROSSING(reply__is_not_spun_for_in_vain)
{
    struct pccd_client *client =
        test_client(&(struct pccd_options){.url = test_shared.url, .spin_us = SPIN_US});
    struct test_grid grid;
    uint64_t waited_us = 0;
    uint32_t longer = 0;

    (void)state;
    assert_ok(test_grid_make(client, SIDE_SLOW, &grid));
    for (int i = 0; i < TURNS; i++) {
        struct pccd_answer answer = PCCD_ANSWER_INIT;
        uint64_t begin_us;
        uint64_t step;

        assert_ok(test_grid_submit(&grid, NULL, &step));
        begin_us = own_us();
        assert_ok(pccd_wait(client, step, -1, &answer));
        waited_us += own_us() - begin_us;
        longer += answer.times.step > SPIN_US * 1000u;
        pccd_answer_release(client, &answer);
    }
    if (!test_is_direct()) {
        assert_true(longer > TURNS / 2);
        assert_true(waited_us < longer * SPIN_US / 2);
    }
    pccd_close(client);
    grid.client = NULL;
    test_grid_free(&grid);
}

/* If it failed: what is sent to a client that is gone could end the daemon, or reach the
 * next one, whose socket has the same number. */
CASE_CROSSING(reply__is_nobodys_when_the_client_is_killed)
{
    struct test_crossing *crossing = *state;

    if (test_is_direct()) {
        test_skip("with direct: there is nobody else");
    }
    for (int i = 0; i < KILLED; i++) {
        pid_t child = fork();

        if (child == 0) {
            struct test_grid grid;
            uint64_t step;
            struct pccd_client *client = test_connect(test_shared.url);

            if (client == NULL || test_grid_make(client, SIDE, &grid) != 0) {
                _exit(1);
            }
            while (test_grid_submit(&grid, NULL, &step) == 0 &&
                   test_grid_await(&grid, step) == 0) {
                ;
            }
            _exit(1);
        }
        assert_true(child > 0);
        test_sleep_ms(20 + (uint32_t)i % 7);
        assert_true(test_crossing_turn(crossing));
        assert_int_equal(kill(child, SIGKILL), 0);
        assert_int_equal(waitpid(child, NULL, 0), child);
        assert_true(test_crossing_turn(crossing));
    }
    assert_int_equal(test_stat_await(crossing->client, "sessions_now", 1), 1);
}

CASES_WITH(test_shared_start, test_shared_stop);

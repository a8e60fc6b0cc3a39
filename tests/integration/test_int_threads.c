/* test_int_threads.c - the daemon's threads, seen from outside. */
#include "cases.h"

#include <dirent.h>
#include <sched.h>

#include "crossing.h"
#include "daemon.h"
#include "grid.h"
#include "must.h"
#include "taken.h"

#define TASKS_MAX 256
#define SIDE      40u /* of a grid that a step shares among threads */
#define IDLE_MS   1500u
#define STEPS_MAX 100 /* times three, until no thread is away */
#define OTHERS    4   /* loop, compute, the one that makes pages, the one that closes */

/* A thread of the daemon. */
struct task {
    long id;
    int cpu_count; /* that it may run on */
    int cpu;       /* the first of them */
    uint64_t runs; /* times it was given a processor */
};

static void read_task(pid_t pid, struct task *task)
{
    char path[80];
    cpu_set_t cpus;
    unsigned long long busy = 0;
    unsigned long long waited = 0;
    unsigned long long runs = 0;
    FILE *file;

    (void)snprintf(path, sizeof path, "/proc/%ld/task/%ld/schedstat", (long)pid,
                   task->id);
    file = fopen(path, "r");
    assert_non_null(file);
    assert_int_equal(fscanf(file, "%llu %llu %llu", &busy, &waited, &runs), 3);
    (void)fclose(file);
    task->runs = runs;
    assert_int_equal(sched_getaffinity((pid_t)task->id, sizeof cpus, &cpus), 0);
    task->cpu_count = CPU_COUNT(&cpus);
    task->cpu = 0;
    while (!CPU_ISSET((size_t)task->cpu, &cpus)) {
        task->cpu++;
    }
}

/* Every thread of the daemon; returns how many. */
static int read_tasks(pid_t pid, struct task tasks[TASKS_MAX])
{
    char path[64];
    DIR *folder;
    struct dirent *entry;
    int count = 0;

    (void)snprintf(path, sizeof path, "/proc/%ld/task", (long)pid);
    folder = opendir(path);
    assert_non_null(folder);
    while ((entry = readdir(folder)) != NULL) {
        if (entry->d_name[0] != '.') {
            assert_true(count < TASKS_MAX);
            tasks[count].id = strtol(entry->d_name, NULL, 10);
            read_task(pid, &tasks[count]);
            count++;
        }
    }
    (void)closedir(folder);
    return count;
}

static int processors(void)
{
    cpu_set_t cpus;

    assert_int_equal(sched_getaffinity(0, sizeof cpus, &cpus), 0);
    return CPU_COUNT(&cpus);
}

/* A daemon with these options, and a client of it. */
static struct pccd_client *start(struct test_daemon *daemon, const char *pin, int threads)
{
    char number[16];
    const char *const options[] = {"--pin", pin, "--threads", number, NULL};

    (void)snprintf(number, sizeof number, "%d", threads);
    assert_true(test_daemon_start(daemon, options));
    return test_client_at(daemon->url);
}

static void step(struct pccd_client *client, int threads)
{
    struct pccd_answer answer = PCCD_ANSWER_INIT;
    struct test_grid grid;

    assert_ok(test_grid_make(client, SIDE, &grid));
    for (int i = 0; i < 3; i++) {
        assert_ok(test_grid_turn(&grid, NULL, &answer));
        assert_true(test_grid_is_right(&grid, &answer));
        assert_int_equal(answer.threads, threads);
        pccd_answer_release(client, &answer);
    }
    test_grid_free(&grid);
}

/* Threads with one processor. The loop's thread has all. -1: two have the same. */
static int count_bound(pid_t pid)
{
    struct task tasks[TASKS_MAX];
    int count = read_tasks(pid, tasks);
    int bound = 0;
    uint64_t seen = 0;

    for (int i = 0; i < count; i++) {
        if (tasks[i].id == (long)pid) {
            assert_int_equal(tasks[i].cpu_count, processors());
        } else if (tasks[i].cpu_count == 1) {
            assert_true(tasks[i].cpu < 64);
            if ((seen >> tasks[i].cpu & 1) != 0) {
                return -1;
            }
            seen |= (uint64_t)1 << tasks[i].cpu;
            bound++;
        }
    }
    return bound;
}

/* The same after as many steps as it takes: a thread whose processor somebody else kept
 * was lent another's (member.h), which it has until the next step. */
static int count_bound_in_calm(pid_t pid, struct pccd_client *client, int threads)
{
    int bound = -1;

    for (int i = 0; i < STEPS_MAX && bound < 0; i++) {
        step(client, threads);
        bound = count_bound(pid);
    }
    return bound;
}

/* If it failed, the kernel could leave two threads of a step on one processor, or threads
 * would be bound that nobody wanted bound. */
CASE(threads__are_bound_where_asked)
{
    int all = processors();
    const struct {
        const char *pin;
        int threads;
        int bound;
    } cases[] = {{"auto", all, all}, {"auto", all + 1, 0}, {"auto", 1, 0},
                 {"on", all, all},   {"on", 2, 2},         {"on", all + 1, 0},
                 {"off", all, 0}};

    if (all < 2 || all > 63) {
        test_skip("it takes 2 to 63 processors");
    }
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        struct test_daemon daemon;
        struct pccd_client *client = start(&daemon, cases[i].pin, cases[i].threads);
        int bound = count_bound_in_calm(daemon.pid, client, cases[i].threads);

        if (bound != cases[i].bound) {
            fail_msg("--pin %s --threads %d: %d threads are bound, not %d", cases[i].pin,
                     cases[i].threads, bound, cases[i].bound);
        }
        assert_int_equal(test_stat(client, "threads_bound"),
                         cases[i].bound > 0 || strcmp(cases[i].pin, "on") == 0);
        pccd_close(client);
        assert_true(test_daemon_finish(&daemon));
    }
}

/* If it failed, the first step of a daemon's life would pay for the making of threads. */
CASE(threads__are_there_before_the_first_step)
{
    struct task tasks[TASKS_MAX];
    struct test_daemon daemon;
    struct pccd_client *client;
    int count = 0;

    if (TEST_HAS_FOREIGN_THREAD) {
        test_skip("a sanitizer has a thread of its own");
    }
    client = start(&daemon, "off", 3);
    for (int i = 0; i < 10000 && count < OTHERS + 2; i++) { /* made beside its start */
        count = read_tasks(daemon.pid, tasks);
        test_sleep_ms(2);
    }
    assert_int_equal(count, OTHERS + 2); /* two more of the team */
    step(client, 3);
    assert_int_equal(read_tasks(daemon.pid, tasks), count);
    pccd_close(client);
    assert_true(test_daemon_finish(&daemon));
}

/* If it failed, a daemon that nobody asks anything would keep a processor from sleeping.
 * It may wake up twice, half a second apart, to give back the memory that the answers
 * have taken (reclaim.c), and not once more after that. */
CASE(threads__sleep_while_there_is_nothing_to_do)
{
    struct task before[TASKS_MAX];
    struct task after[TASKS_MAX];
    struct test_daemon daemon;
    struct pccd_client *client;
    int count;

    if (TEST_HAS_FOREIGN_THREAD) {
        test_skip("a sanitizer has a thread of its own");
    }
    client = start(&daemon, "auto", processors());
    step(client, processors());
    uint64_t taken = test_taken_bytes();
    assert_true(test_taken_await(taken - 1) < taken);
    test_sleep_ms(300); /* whoever spins after a step does it no longer than that */
    count = read_tasks(daemon.pid, before);
    test_sleep_ms(IDLE_MS);
    assert_int_equal(read_tasks(daemon.pid, after), count);
    for (int i = 0; i < count; i++) {
        assert_int_equal(after[i].id, before[i].id);
        if (after[i].runs != before[i].runs) {
            fail_msg("thread %ld ran %llu times in %u ms of idleness", after[i].id,
                     (unsigned long long)(after[i].runs - before[i].runs), IDLE_MS);
        }
    }
    pccd_close(client);
    assert_true(test_daemon_finish(&daemon));
}

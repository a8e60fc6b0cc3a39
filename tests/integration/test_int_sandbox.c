/* test_int_sandbox.c - what a serving daemon may still do.
 *
 * Room:     tests/integration. May include: pccd.h, tests/support.
 * Does:     look at every thread of a daemon in the sandbox, and use all that a client
 *           can: rings, meshes, steps by a team, recordings, the orderly end.
 * Does not: try forbidden calls from inside.
 * Threads:  one.
 */
#include <dirent.h>
#include <setjmp.h>
#include <signal.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cmocka.h>

#include "daemon.h"
#include "grid.h"

static const char *const boxed[] = {"--sandbox", "on", "--threads", "4", NULL};

static int setup(void **state)
{
    struct test_daemon *daemon = calloc(1, sizeof *daemon);
    *state = daemon;
    return daemon != NULL && test_daemon_start(daemon, boxed) ? 0 : -1;
}

static int teardown(void **state)
{
    struct test_daemon *daemon = *state;
    bool in_order = test_daemon_finish(daemon);
    free(daemon);
    return in_order ? 0 : -1;
}

/* The number after `name` in the status of a thread; -1: there is none. */
static int status_of(pid_t process, const char *thread, const char *name)
{
    char path[320];
    char line[256];
    int value = -1;
    snprintf(path, sizeof path, "/proc/%ld/task/%s/status", (long)process, thread);
    FILE *file = fopen(path, "r");
    while (file != NULL && fgets(line, sizeof line, file) != NULL) {
        if (strncmp(line, name, strlen(name)) == 0) {
            value = atoi(line + strlen(name));
        }
    }
    if (file != NULL) {
        fclose(file);
    }
    return value;
}

/* If one thread were left out, whoever takes it over could open any file. */
static void sandbox__holds_every_thread(void **state)
{
    const struct test_daemon *daemon = *state;
    char path[64];
    int count = 0;
    snprintf(path, sizeof path, "/proc/%ld/task", (long)daemon->pid);
    DIR *threads = opendir(path);
    assert_non_null(threads);
    for (const struct dirent *entry = readdir(threads); entry != NULL;
         entry = readdir(threads)) {
        if (entry->d_name[0] != '.') {
            assert_int_equal(status_of(daemon->pid, entry->d_name, "Seccomp:"), 2);
            assert_int_equal(status_of(daemon->pid, entry->d_name, "NoNewPrivs:"), 1);
            count++;
        }
    }
    closedir(threads);
    assert_in_range(count, 2, 16); /* the loop, the compute thread, its team */
}

/* If a call were missing in the list, a client would see a step or an attach fail. */
static void sandbox__leaves_all_that_clients_use(void **state)
{
    const struct test_daemon *daemon = *state;
    struct pccd_options options;
    struct pccd_client *client = NULL;
    struct test_grid grid;
    struct pccd_answer answer;
    uint64_t step = 0;
    pccd_options_init(&options);
    options.url = daemon->url;
    assert_int_equal(pccd_connect(&options, &client), 0);
    assert_int_equal(test_grid_make(client, 60, &grid), 0);
    for (int i = 0; i < 20; i++) {
        assert_int_equal(test_grid_submit(&grid, NULL, &step), 0);
        assert_int_equal(pccd_wait(client, step, -1, &answer), 0);
        pccd_answer_release(client, &answer);
        assert_int_equal(test_grid_replace(&grid), 0);
    }
    test_grid_free(&grid);
    pccd_close(client);
}

#if defined HAVE_SECCOMP && !defined PCCD_SANITIZED
#define HAS_SANDBOX true
#else
#define HAS_SANDBOX false
#endif

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(sandbox__holds_every_thread),
        cmocka_unit_test(sandbox__leaves_all_that_clients_use),
    };
    if (!HAS_SANDBOX) {
        puts("1..2\nok 1 - sandbox__holds_every_thread # SKIP no sandbox in this build\n"
             "ok 2 - sandbox__leaves_all_that_clients_use # SKIP no sandbox in this "
             "build");
        return 0;
    }
    return cmocka_run_group_tests_name("int_sandbox", tests, setup, teardown);
}

/* test_int_allow.c - who may be a client. */
#include "cases.h"

#include <grp.h>
#include <signal.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include "daemon.h"
#include "raw.h"
#include "run_ctl.h"

#define USER  65534u
#define GROUP 54321u

/* In a child: say hello as this user with these groups. Returns the negated status. */
static int hello_as(const struct test_daemon *daemon, uid_t uid, gid_t gid, gid_t further)
{
    static struct test_raw raw;
    int status;

    if (setgroups(1, &further) != 0 || setgid(gid) != 0 || setuid(uid) != 0 ||
        !test_raw_open(&raw, daemon->socket)) {
        return 100;
    }
    status = test_raw_hello(&raw);
    if (status != 0 &&
        (!raw.error.fatal || strstr(raw.error.text, "--allow-uid") == NULL ||
         test_raw_receive(&raw) != PCCD_E_DISCONNECTED)) {
        return 101;
    }
    return -status;
}

/* The status that a client of that user and these groups hears. */
static int ask(const struct test_daemon *daemon, uid_t uid, gid_t gid, gid_t further)
{
    int status = 0;
    pid_t child = fork();

    assert_true(child >= 0);
    if (child == 0) {
        _exit(hello_as(daemon, uid, gid, further));
    }
    assert_int_equal(waitpid(child, &status, 0), child);
    assert_true(WIFEXITED(status));
    return -WEXITSTATUS(status);
}

static void start(struct test_daemon *daemon, const char *const *options)
{
    assert_true(test_daemon_start(daemon, options));
    assert_int_equal(chmod(daemon->directory, 0755), 0);
}

/* If it failed, a list would let others in, or keep those out whom it names. */
CASE(allow__lists_of_users_and_groups_are_kept)
{
    static const char *const by_user[] = {"--allow-uid", "65534", NULL};
    static const char *const by_group[] = {"--allow-gid", "54321", "--allow-gid", "54322",
                                           NULL};
    struct test_daemon daemon;

    if (geteuid() != 0) {
        test_skip(TEST_ONLY_ROOT);
    }
    start(&daemon, by_user);
    assert_int_equal(ask(&daemon, USER, 7, 7), 0);
    assert_int_equal(ask(&daemon, USER - 1, 7, GROUP), PCCD_E_ACCESS);
    assert_int_equal(ask(&daemon, 0, 0, 0), 0);
    assert_true(test_daemon_finish(&daemon));
    start(&daemon, by_group);
    assert_int_equal(ask(&daemon, USER, GROUP, 7), 0);
    assert_int_equal(ask(&daemon, USER, 7, GROUP), 0);
    assert_int_equal(ask(&daemon, USER, 7, GROUP + 1), 0);
    assert_int_equal(ask(&daemon, USER, 7, 7), PCCD_E_ACCESS);
    assert_int_equal(ask(&daemon, 0, 0, 0), 0);
    assert_true(test_daemon_finish(&daemon));
}

/* If it failed, strangers could take the places of those who may be clients: more of them
 * than hear why are turned away at once. */
CASE(allow__strangers_take_no_places)
{
    static const char *const options[] = {"--allow-gid", "54321", "--connections-max",
                                          "24", NULL};
    static struct test_raw raws[20];
    struct test_daemon daemon;
    int status = 0;
    pid_t child;

    if (geteuid() != 0) {
        test_skip(TEST_ONLY_ROOT);
    }
    start(&daemon, options);
    child = fork();
    assert_true(child >= 0);
    if (child == 0) {
        bool connected = setgroups(0, NULL) == 0 && setgid(7) == 0 && setuid(USER) == 0;

        test_end_with_parent();
        for (int i = 0; i < 20 && connected; i++) {
            connected = test_raw_open(&raws[i], daemon.socket);
        }
        _exit(connected && pause() != 0 ? 0 : 1);
    }
    for (int i = 0; i < 20; i++) {
        assert_int_equal(ask(&daemon, USER, GROUP, 7), 0);
    }
    assert_int_equal(kill(child, SIGKILL), 0);
    assert_int_equal(waitpid(child, &status, 0), child);
    assert_true(WIFSIGNALED(status)); /* it was connected all the time */
    assert_true(test_daemon_finish(&daemon));
}

#define REFUSED 1500u

/* The log's lines that hold `text`. */
static unsigned lines_with(const struct test_daemon *daemon, const char *text)
{
    char line[1024];
    unsigned count = 0;
    FILE *file = fopen(daemon->log, "r");

    assert_non_null(file);
    while (fgets(line, sizeof line, file) != NULL) {
        count += strstr(line, text) != NULL;
    }
    (void)fclose(file);
    return count;
}

/* If it failed, whoever may not be a client could fill the disk with lines that say so:
 * 56 404 in three seconds. */
CASE(allow__strangers_do_not_fill_the_log)
{
    static const char *const options[] = {"--allow-gid", "54321", NULL};
    static struct test_raw raw;
    struct test_daemon daemon;
    uint64_t begin_ms = test_now_ms();
    uint64_t seconds;
    int status = 0;
    pid_t child;

    if (geteuid() != 0) {
        test_skip(TEST_ONLY_ROOT);
    }
    start(&daemon, options);
    child = fork();
    assert_true(child >= 0);
    if (child == 0) {
        bool is_refused = setgroups(0, NULL) == 0 && setgid(7) == 0 && setuid(USER) == 0;

        for (unsigned i = 0; i < REFUSED && is_refused; i++) {
            is_refused = test_raw_open(&raw, daemon.socket) &&
                         test_raw_hello(&raw) == PCCD_E_ACCESS;
            test_raw_close(&raw);
        }
        _exit(is_refused ? 0 : 1);
    }
    assert_int_equal(waitpid(child, &status, 0), child);
    assert_int_equal(status, 0);
    for (int i = 0; i < 30 && lines_with(&daemon, "were left out") == 0; i++) {
        test_sleep_ms(100); /* said by itself, though nobody comes any more */
    }
    assert_true(lines_with(&daemon, "were left out") > 0);
    seconds = (test_now_ms() - begin_ms) / 1000 + 1;
    assert_in_range(lines_with(&daemon, "refused: "), 100, 100 + 10 * seconds + seconds);
    assert_true(test_daemon_finish(&daemon));
}

/* If it failed, who looks at a daemon that refuses strangers would be told to let them
 * take more places. */
CASE(allow__status_says_who_was_refused)
{
    static const char *const options[] = {"--allow-gid", "54321", NULL};
    struct test_daemon daemon;
    char said[4096];

    if (geteuid() != 0) {
        test_skip(TEST_ONLY_ROOT);
    }
    start(&daemon, options);
    assert_int_equal(ask(&daemon, USER, 7, 7), PCCD_E_ACCESS);
    assert_int_equal(test_ctl("status", "--socket", daemon.socket, said, sizeof said), 0);
    assert_non_null(strstr(said, "1 connection was of users whom pccdd --allow-uid"));
    assert_null(strstr(said, "clients-max"));
    assert_true(test_daemon_finish(&daemon));
}

/* If it failed, a socket without a list could be reached by others. */
CASE(allow__without_a_list_only_our_own_user_gets_there)
{
    struct test_daemon daemon;
    struct stat info;

    assert_true(test_daemon_start(&daemon, NULL));
    assert_int_equal(stat(daemon.socket, &info), 0);
    assert_int_equal(info.st_mode & 0777, 0600);
    if (geteuid() == 0) {
        assert_int_equal(chmod(daemon.directory, 0755), 0);
        assert_int_equal(ask(&daemon, USER, 7, 7), -100);
        assert_int_equal(ask(&daemon, 0, 0, 0), 0);
    }
    assert_true(test_daemon_finish(&daemon));
}

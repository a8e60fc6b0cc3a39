/* daemon.h - starts and stops a real pccdd for a test. */
#ifndef TEST_DAEMON_H
#define TEST_DAEMON_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <sys/types.h>

/* The thread sanitizer has a thread of its own in the daemon, which does not sleep. */
#if defined(__SANITIZE_THREAD__)
#define TEST_HAS_FOREIGN_THREAD 1
#elif defined(__has_feature)
#if __has_feature(thread_sanitizer)
#define TEST_HAS_FOREIGN_THREAD 1
#endif
#endif
#ifndef TEST_HAS_FOREIGN_THREAD
#define TEST_HAS_FOREIGN_THREAD 0
#endif

struct test_daemon {
    pid_t pid;   /* 0: not running */
    pid_t group; /* of it and its workers; 0: never started */
    pid_t guard; /* ends the group with the test; 0: none */
    char directory[64];
    char socket[80];
    char url[88];
    char log[80]; /* its standard error */
};

#define TEST_DIRECT_URL "direct:"

/* Return whether the program's subject is run without a daemon: $PCCD_TEST_URL is
 * direct: */
bool test_is_direct(void);

/* No daemon: its url is direct:, and `--threads N` of the options is $OMP_NUM_THREADS. */
void test_daemon_direct(struct test_daemon *daemon, const char *const *options);

/* Start with `options` (NULL-terminated, may be NULL). False with a message on stderr
 * when it does not listen within 20 s or $PCCDD is not set. */
bool test_daemon_start(struct test_daemon *daemon, const char *const *options);

/* Start again, after test_daemon_end, with the same socket. */
bool test_daemon_restart(struct test_daemon *daemon, const char *const *options);

/* Start another daemon with the same socket. Returns its exit status, or -1 when it
 * has not ended within 10 s (it is killed then). What it logged is appended to
 * daemon->log. */
int test_daemon_start_second(const struct test_daemon *daemon);

/* Signal it, and wait until it has ended. Returns the status of waitpid, or -1 when that
 * takes longer than timeout_ms: then it is killed. */
int test_daemon_end(struct test_daemon *daemon, int signal, int timeout_ms);

/* End it with SIGTERM if it runs, and remove its folder. Returns whether it exited with
 * 0. */
bool test_daemon_finish(struct test_daemon *daemon);

/* Return whether the log holds `text`. */
bool test_daemon_logged(const struct test_daemon *daemon, const char *text);

/* In a forked child: end when the test does, instead of keeping its output open. To be
 * said again after a change of user, which takes it back. */
void test_end_with_parent(void);

/* Stop a process until it is sent SIGCONT, and wait until it stands still: 10 s at most,
 * else false. */
bool test_stop(pid_t pid);

/* CLOCK_MONOTONIC, milliseconds and microseconds. */
uint64_t test_now_ms(void);
uint64_t test_now_us(void);
void test_sleep_ms(unsigned ms);

#endif

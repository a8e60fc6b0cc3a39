/* test_srv_log.c - what the daemon says about itself. */
#include "cases.h"

#include <fcntl.h>
#include <signal.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include "log.h"

#define LINES     2000 /* more than a pipe holds */
#define TEXT      "a line of some length, so that they are soon too many for the pipe"
#define PATIENCE  20 /* seconds, until a log that waits is ended by SIGALRM */
#define PIPE_READ (1u << 20)

/* A daemon whose messages go to a program that has stopped reading would stop with it. */
CASE(log__does_not_wait_for_a_reader)
{
    static char text[PIPE_READ];
    size_t length = 0;
    int status = 0;
    int fds[2];
    assert_int_equal(pipe(fds), 0);
    pid_t child = fork();
    assert_true(child >= 0);
    if (child == 0) {
        alarm(PATIENCE);
        if (dup2(fds[1], STDERR_FILENO) != STDERR_FILENO) {
            _exit(1);
        }
        for (uint64_t line = 1; line <= LINES; line++) {
            srv_log(SRV_LOG_ERROR, line, TEXT);
        }
        _exit(0);
    }
    close(fds[1]);
    assert_int_equal(waitpid(child, &status, 0), child);
    assert_true(WIFEXITED(status) && WEXITSTATUS(status) == 0);

    for (ssize_t got; length < sizeof text &&
                      (got = read(fds[0], text + length, sizeof text - length)) > 0;) {
        length += (size_t)got;
    }
    close(fds[0]);
    assert_true(length > 0);
    for (size_t at = 0; at < length;) { /* what arrived are whole lines */
        const char *end = memchr(text + at, '\n', length - at);
        assert_non_null(end);
        size_t bytes = (size_t)(end - text) - at;
        assert_true(bytes > strlen(TEXT));
        assert_memory_equal(end - strlen(TEXT), TEXT, strlen(TEXT));
        at += bytes + 1;
    }
}

/* Lines of stderr, which is the pipe's end for writing, that end with `end`. */
static unsigned count_lines(const char *text, const char *end)
{
    unsigned count = 0;
    for (const char *at = strstr(text, end); at != NULL; at = strstr(at + 1, end)) {
        count += at[strlen(end)] == '\n';
    }
    return count;
}

/* If it failed, lines that a full disk has taken would be missing without a word, or what
 * it took half of one would spoil the next one, too. */
CASE(log__tells_of_lines_that_were_lost)
{
    static char text[PIPE_READ];
    char name[] = "/tmp/pccd-log-XXXXXX";
    int status = 0, fd = mkstemp(name);
    assert_true(fd >= 0);
    assert_int_equal(unlink(name), 0);
    assert_int_equal(fcntl(fd, F_SETFL, O_APPEND), 0);
    pid_t child = fork();
    assert_true(child >= 0);
    if (child == 0) {
        struct rlimit limit = {.rlim_cur = 50,
                               .rlim_max = RLIM_INFINITY}; /* half a line */
        signal(SIGXFSZ, SIG_IGN);
        if (dup2(fd, STDERR_FILENO) != STDERR_FILENO ||
            setrlimit(RLIMIT_FSIZE, &limit) != 0) {
            _exit(1);
        }
        srv_log(SRV_LOG_ERROR, 0, TEXT);
        srv_log(SRV_LOG_ERROR, 0, TEXT);
        limit.rlim_cur = RLIM_INFINITY;
        if (setrlimit(RLIMIT_FSIZE, &limit) != 0 || srv_log_lost() != 2) {
            _exit(2);
        }
        srv_log(SRV_LOG_ERROR, 0, "there is room");
        srv_log(SRV_LOG_ERROR, 0, "still");
        _exit(srv_log_lost() == 2 ? 0 : 3);
    }
    assert_int_equal(waitpid(child, &status, 0), child);
    assert_int_equal(status, 0);
    ssize_t length = pread(fd, text, sizeof text - 1, 0);
    assert_true(length > 50);
    (void)close(fd);
    assert_int_equal(text[50], '\n');
    assert_int_equal(
        count_lines(text, "- 2 lines could not be written here: File too large"), 1);
    assert_int_equal(count_lines(text, "- there is room"), 1);
    assert_int_equal(count_lines(text, "- still"), 1);
}

/* If it failed, whoever connects again and again could fill the disk with lines, or hide
 * what the daemon says of others. */
CASE(log__of_a_kind_is_bounded)
{
    static char text[PIPE_READ];
    int fds[2];
    assert_int_equal(pipe(fds), 0);
    int kept = dup(STDERR_FILENO);
    assert_int_equal(dup2(fds[1], STDERR_FILENO), STDERR_FILENO);
    close(fds[1]);
    for (unsigned i = 0; i < 3 * SRV_LOG_BURST; i++) {
        srv_log(SRV_LOG_WARN, 7, "a client was %s", "refused");
    }
    srv_log(SRV_LOG_WARN, 0, "something else");
    bool owes = srv_log_owes_report();
    srv_log_report();
    bool owes_still = srv_log_owes_report();
    srv_log_report();
    assert_int_equal(dup2(kept, STDERR_FILENO), STDERR_FILENO); /* the last writer */
    close(kept);
    ssize_t length = 0;
    for (ssize_t got;
         (got = read(fds[0], text + length, sizeof text - 1 - (size_t)length)) > 0;) {
        length += got;
    }
    close(fds[0]);
    assert_true(owes && !owes_still);
    unsigned count = count_lines(text, "s7 a client was refused");
    assert_in_range(count, SRV_LOG_BURST, SRV_LOG_BURST + 2 * SRV_LOG_PER_S);
    assert_int_equal(count_lines(text, "something else"), 1);
    char report[96];
    (void)snprintf(report, sizeof report,
                   "%u lines of the kind \"a client was %%s\" were left out",
                   3 * SRV_LOG_BURST - count);
    assert_int_equal(count_lines(text, report), 1);
}

/* Return how long a file is to which so many lines went; the last one must be there. */
static off_t bytes_of_lines(uint32_t own_bytes_max)
{
    char name[] = "/tmp/pccd-log-XXXXXX", last[sizeof TEXT];
    struct stat found;
    int status = 0, fd = mkstemp(name);
    pid_t child;
    assert_true(fd >= 0);
    assert_int_equal(unlink(name), 0);
    assert_int_equal(fcntl(fd, F_SETFL, O_APPEND), 0);
    child = fork();
    assert_true(child >= 0);
    if (child == 0) {
        if (dup2(fd, STDERR_FILENO) != STDERR_FILENO) {
            _exit(1);
        }
        srv_log_own_file(own_bytes_max);
        for (uint64_t line = 1; line <= LINES; line++) {
            srv_log(SRV_LOG_ERROR, line, TEXT);
        }
        _exit(0);
    }
    assert_int_equal(waitpid(child, &status, 0), child);
    assert_int_equal(status, 0);
    assert_int_equal(fstat(fd, &found), 0);
    assert_int_equal(pread(fd, last, sizeof last, found.st_size - (off_t)sizeof last),
                     sizeof last);
    assert_memory_equal(last, TEXT "\n", sizeof last);
    (void)close(fd);
    return found.st_size;
}

/* If it failed, the log of a daemon that a program has started would fill the memory that
 * it lies in; or a log that somebody keeps would lose lines. */
CASE(log__own_file_stays_short)
{
    assert_in_range(bytes_of_lines(4096), 100, 4096 + 200);
    assert_true(bytes_of_lines(0) > LINES * (off_t)sizeof TEXT);
}

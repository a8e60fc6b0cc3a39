/* log.c - what the daemon says about itself.
 *
 * Room:     service. See log.h.
 * Does:     formats into a buffer on the stack and writes it with one call.
 * Does not: allocate or lock.
 * Threads:  [any].
 */
#include "log.h"

#include <poll.h>
#include <stdarg.h>
#include <stdatomic.h>
#include <stdio.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

#define LINE_BYTES 1024u

static const char *const level_names[SRV_LOG_COUNT] = {"error", "warn", "info", "debug"};

/* Relaxed: set once at start, read by both threads; order with other data is not
 * needed. */
static _Atomic int level_max = SRV_LOG_INFO;

void srv_log_set_level(enum srv_level level)
{
    atomic_store_explicit(&level_max, (int)level, memory_order_relaxed);
}

int srv_log_level_by_name(const char *name)
{
    for (int level = 0; level < SRV_LOG_COUNT; level++) {
        if (strcmp(name, level_names[level]) == 0) {
            return level;
        }
    }
    return -1;
}

/* Time, level and session into line[capacity]; returns the length. */
static size_t write_prefix(char *line, size_t capacity, enum srv_level level,
                           uint64_t session)
{
    struct timespec now;
    clock_gettime(CLOCK_REALTIME, &now);
    struct tm utc;
    gmtime_r(&now.tv_sec, &utc);
    size_t length = strftime(line, capacity, "%Y-%m-%dT%H:%M:%S", &utc);
    int more = session == 0
                   ? snprintf(line + length, capacity - length, ".%03ldZ %-5s - ",
                              now.tv_nsec / 1000000, level_names[level])
                   : snprintf(line + length, capacity - length, ".%03ldZ %-5s s%llu ",
                              now.tv_nsec / 1000000, level_names[level],
                              (unsigned long long)session);
    return length + (size_t)more;
}

void srv_log(enum srv_level level, uint64_t session, const char *format, ...)
{
    if ((int)level > atomic_load_explicit(&level_max, memory_order_relaxed)) {
        return;
    }
    char line[LINE_BYTES];
    size_t start = write_prefix(line, sizeof line, level, session);
    va_list arguments;
    va_start(arguments, format);
    int written = vsnprintf(line + start, sizeof line - start, format, arguments);
    va_end(arguments);
    size_t room = sizeof line - start - 1;
    size_t length = start + (written < 0              ? 0
                             : (size_t)written < room ? (size_t)written
                                                      : room);
    for (size_t i = start; i < length; i++) {
        if ((unsigned char)line[i] < 0x20 || line[i] == 0x7f) {
            line[i] = '?';
        }
    }
    line[length] = '\n'; /* over the terminating NUL */
    /* A pipe that nobody reads must not stop the daemon. One with room has it for at
     * least PIPE_BUF bytes, enough for a line of each of the two threads. */
    struct pollfd out = {.fd = STDERR_FILENO, .events = POLLOUT};
    if (poll(&out, 1, 0) > 0) {
        ssize_t ignored = write(STDERR_FILENO, line, length + 1);
        (void)ignored; /* nobody is left to tell */
    }
}

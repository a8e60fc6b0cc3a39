/* log.c - what the daemon says about itself. */
#include "log.h"

#include <poll.h>
#include <stdarg.h>
#include <stdatomic.h>
#include <stdio.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

#include "now.h"
#include "printable.h"

#define LINE_BYTES 1024u

static const char *const level_names[SRV_LOG_COUNT] = {"error", "warn", "info", "debug"};

/* Relaxed: set once at start, read by both threads; order with other data is not
 * needed. */
static _Atomic int level_max = SRV_LOG_INFO;

void srv_log_set_level(enum srv_level level)
{
    atomic_store_explicit(&level_max, (int)level, memory_order_relaxed);
}

/* Relaxed, like the level. 0: it is not ours. */
static _Atomic uint32_t own_bytes_max;

void srv_log_own_file(uint32_t bytes_max)
{
    atomic_store_explicit(&own_bytes_max, bytes_max, memory_order_relaxed);
}

/* Whoever opened it appends, so that the next line stands at its begin. */
static void keep_short(void)
{
    uint32_t bytes_max = atomic_load_explicit(&own_bytes_max, memory_order_relaxed);
    if (bytes_max > 0 && lseek(STDERR_FILENO, 0, SEEK_END) > (off_t)bytes_max) {
        int ignored = ftruncate(STDERR_FILENO, 0);
        (void)ignored; /* nobody is left to tell */
    }
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

/* ---- how often --------------------------------------------------------------------- */

#define KINDS_MAX   64u /* those beyond share the last place */
#define INTERVAL_NS (1000000000u / SRV_LOG_PER_S)

/* Relaxed: each number by itself; a line more or less does not matter. */
static struct kind {
    _Atomic(const char *) format; /* NULL: none yet */
    _Atomic uint64_t due_ns;      /* until then all lines are used up, INTERVAL_NS each */
    _Atomic uint64_t left_out;    /* since the last report */
} kinds[KINDS_MAX];

static atomic_bool owes_report;

static struct kind *kind_of(const char *format)
{
    for (uint32_t i = 0; i < KINDS_MAX; i++) {
        const char *known = NULL;
        if (atomic_compare_exchange_strong(&kinds[i].format, &known, format) ||
            known == format) {
            return &kinds[i];
        }
    }
    return &kinds[KINDS_MAX - 1];
}

/* Return whether a line of that kind may be written now; it is counted either way. */
static bool is_in_time(struct kind *kind)
{
    uint64_t now_ns = common_now_ns();
    uint64_t due_ns = atomic_load_explicit(&kind->due_ns, memory_order_relaxed);
    uint64_t next_ns;
    do {
        next_ns = (due_ns > now_ns ? due_ns : now_ns) + INTERVAL_NS;
        if (next_ns > now_ns + (uint64_t)SRV_LOG_BURST * INTERVAL_NS) {
            atomic_fetch_add_explicit(&kind->left_out, 1, memory_order_relaxed);
            atomic_store(&owes_report, true);
            return false;
        }
    } while (!atomic_compare_exchange_weak_explicit(
        &kind->due_ns, &due_ns, next_ns, memory_order_relaxed, memory_order_relaxed));
    return true;
}

/* ---- lines ------------------------------------------------------------------------- */

static void write_line(enum srv_level level, uint64_t session, const char *format,
                       va_list arguments) __attribute__((format(printf, 3, 0)));
static void write_line(enum srv_level level, uint64_t session, const char *format,
                       va_list arguments)
{
    char line[LINE_BYTES], text[LINE_BYTES];
    size_t start = write_prefix(line, sizeof line, level, session);
    vsnprintf(text, sizeof text, format, arguments);
    /* Whatever a client has called itself, a line stays one. */
    (void)proto_printable(text, strlen(text), line + start, sizeof line - start);
    size_t length = start + strlen(line + start);
    line[length] = '\n'; /* over the terminating NUL */
    /* A pipe that nobody reads must not stop the daemon. One with room has it for at
     * least PIPE_BUF bytes, enough for a line of each of the two threads. */
    struct pollfd out = {.fd = STDERR_FILENO, .events = POLLOUT};
    keep_short();
    if (poll(&out, 1, 0) > 0) {
        ssize_t ignored = write(STDERR_FILENO, line, length + 1);
        (void)ignored; /* nobody is left to tell */
    }
}

void srv_log(enum srv_level level, uint64_t session, const char *format, ...)
{
    bool is_limited = level == SRV_LOG_WARN || level == SRV_LOG_INFO;
    if ((int)level > atomic_load_explicit(&level_max, memory_order_relaxed) ||
        (is_limited && !is_in_time(kind_of(format)))) {
        return;
    }
    va_list arguments;
    va_start(arguments, format);
    write_line(level, session, format, arguments);
    va_end(arguments);
}

static void say(const char *format, ...) __attribute__((format(printf, 1, 2)));
static void say(const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    write_line(SRV_LOG_WARN, 0, format, arguments);
    va_end(arguments);
}

bool srv_log_owes_report(void)
{
    return atomic_load_explicit(&owes_report, memory_order_relaxed);
}

void srv_log_report(void)
{
    atomic_store(&owes_report, false);
    for (uint32_t i = 0; i < KINDS_MAX; i++) {
        const char *format = atomic_load(&kinds[i].format);
        uint64_t count = atomic_exchange(&kinds[i].left_out, 0);
        if (count > 0) {
            say("%llu %s of the kind \"%s\" %s left out", (unsigned long long)count,
                proto_plural(count, "line", "lines"), format,
                proto_plural(count, "was", "were"));
        }
    }
}

/* log.c - what the daemon says about itself. */
#include "log.h"

#include <errno.h>
#include <poll.h>
#include <stdarg.h>
#include <stdatomic.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

#include "now.h"
#include "printable.h"

#define MESSAGE_BYTES 896u                       /* and a NUL; the rest is left out */
#define LINE_BYTES    (2 * MESSAGE_BYTES + 160u) /* room for a message in quotes */

static const char *const level_names[SRV_LOG_COUNT] = {"error", "warn", "info", "debug"};

/* Relaxed: set once at start, read by both threads; order with other data is not
 * needed. */
static _Atomic int level_max = SRV_LOG_INFO;

void srv_log_set_level(enum srv_level level)
{
    atomic_store_explicit(&level_max, (int)level, memory_order_relaxed);
}

/* Relaxed, like the level. */
static _Atomic int format_now = SRV_LOG_TEXT;

void srv_log_set_format(enum srv_log_format format)
{
    atomic_store_explicit(&format_now, (int)format, memory_order_relaxed);
}

static const char *file_path; /* set once at start; NULL: what stderr was */

int srv_log_open(const char *path)
{
    struct stat found;
    file_path = path;
    if (stat(path, &found) == 0 && S_ISFIFO(found.st_mode)) {
        return EOPNOTSUPP; /* to open it would keep us waiting for a reader */
    }
    FILE *file = fopen(path, "ae"); /* with the flags that the sandbox allows */
    bool is_open = file != NULL && dup3(fileno(file), STDERR_FILENO, 0) >= 0;
    int failed = is_open ? 0 : errno;
    if (file != NULL) {
        fclose(file);
    }
    return failed;
}

void srv_log_reopen(void)
{
    int failed = file_path != NULL ? srv_log_open(file_path) : 0;
    if (failed != 0) {
        srv_log(SRV_LOG_ERROR, 0, "%s: %s; messages go where they went", file_path,
                strerror(failed));
    }
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

/* The time now as ISO 8601 has it, in UTC, up to the millisecond. */
static void write_time(char text[32])
{
    struct timespec now;
    struct tm utc;
    clock_gettime(CLOCK_REALTIME, &now);
    gmtime_r(&now.tv_sec, &utc);
    size_t length = strftime(text, 32, "%Y-%m-%dT%H:%M:%S", &utc);
    snprintf(text + length, 32 - length, ".%03ldZ", now.tv_nsec / 1000000);
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

/* Write `text`, which holds no control characters, within a JSON string: at most twice as
 * many bytes. Returns how many. */
static size_t write_quoted(const char *text, char *to)
{
    size_t length = 0;
    for (; *text != '\0'; text++) {
        if (*text == '"' || *text == '\\') {
            to[length++] = '\\';
        }
        to[length++] = *text;
    }
    return length;
}

/* Return the length of the line, without its end; `time` is write_time's. */
static size_t write_text(char *line, size_t capacity, const char *time,
                         enum srv_level level, uint64_t session, const char *message)
{
    char about[24] = "-";
    if (session != 0) {
        snprintf(about, sizeof about, "s%llu", (unsigned long long)session);
    }
    int length = snprintf(line, capacity, "%s %-5s %s %s", time, level_names[level],
                          about, message);
    return (size_t)length < capacity ? (size_t)length : capacity - 1;
}

/* Return the same of a JSON object. */
static size_t write_json(char *line, size_t capacity, const char *time,
                         enum srv_level level, uint64_t session, const char *message)
{
    char about[48] = "";
    if (session != 0) {
        snprintf(about, sizeof about, "\"session\":%llu,", (unsigned long long)session);
    }
    size_t length = (size_t)snprintf(line, capacity,
                                     "{\"time\":\"%s\",\"level\":\"%s\",%s\"message\":\"",
                                     time, level_names[level], about);
    length += write_quoted(message, line + length);
    line[length] = '"';
    line[length + 1] = '}';
    return length + 2;
}

/* Relaxed, like the level. */
static _Atomic uint64_t lost_count;  /* lines that could not be written */
static _Atomic uint64_t lost_logged; /* of these, those that the log tells of */
static _Atomic int lost_errno;       /* why the last one could not */
static atomic_bool is_cut;           /* the last one stands there in part */

uint64_t srv_log_lost(void)
{
    return atomic_load_explicit(&lost_count, memory_order_relaxed);
}

bool srv_log_is_json(void)
{
    return atomic_load_explicit(&format_now, memory_order_relaxed) == SRV_LOG_JSON;
}

/* Write a line with its end. False: not all of it, for want of room on the disk or of
 * somebody who reads. */
static bool put(const char *line, size_t length)
{
    /* A pipe that nobody reads must not stop the daemon. One with room has it for at
     * least PIPE_BUF bytes, enough for a line of each of the two threads. */
    struct pollfd out = {.fd = STDERR_FILENO, .events = POLLOUT};
    ssize_t written = -1;
    keep_short();
    errno = EAGAIN;
    if (poll(&out, 1, 0) > 0 &&
        (!atomic_load(&is_cut) || write(STDERR_FILENO, "\n", 1) == 1)) {
        atomic_store(&is_cut, false);
        errno = ENOSPC; /* of a line that is written in part */
        written = write(STDERR_FILENO, line, length);
    }
    if (written != (ssize_t)length) {
        atomic_store_explicit(&lost_errno, errno, memory_order_relaxed);
        atomic_store(&is_cut, written > 0 || atomic_load(&is_cut));
    }
    return written == (ssize_t)length;
}

static bool write_message(enum srv_level level, uint64_t session, const char *said)
{
    char line[LINE_BYTES], time[32], message[MESSAGE_BYTES];
    /* Whatever a client has called itself, a line stays one. */
    (void)proto_printable(said, strlen(said), message, sizeof message);
    write_time(time);
    size_t length =
        srv_log_is_json()
            ? write_json(line, sizeof line - 1, time, level, session, message)
            : write_text(line, sizeof line - 1, time, level, session, message);
    line[length] = '\n';
    return put(line, length + 1);
}

/* Say once how many lines are missing, as soon as it can be said. */
static void log_lost(void)
{
    uint64_t count = srv_log_lost();
    uint64_t logged = atomic_load_explicit(&lost_logged, memory_order_relaxed);
    char said[128];
    if (count == logged ||
        !atomic_compare_exchange_strong(&lost_logged, &logged, count)) {
        return;
    }
    snprintf(said, sizeof said, "%llu %s could not be written here: %s",
             (unsigned long long)(count - logged),
             proto_plural(count - logged, "line", "lines"),
             strerror(atomic_load_explicit(&lost_errno, memory_order_relaxed)));
    if (!write_message(SRV_LOG_ERROR, 0, said)) {
        atomic_fetch_sub_explicit(&lost_logged, count - logged, memory_order_relaxed);
    }
}

static void write_line(enum srv_level level, uint64_t session, const char *format,
                       va_list arguments) __attribute__((format(printf, 3, 0)));
static void write_line(enum srv_level level, uint64_t session, const char *format,
                       va_list arguments)
{
    char said[1024];
    vsnprintf(said, sizeof said, format, arguments);
    log_lost();
    if (!write_message(level, session, said)) {
        atomic_fetch_add_explicit(&lost_count, 1, memory_order_relaxed);
    }
}

bool srv_log_last_words(const char *said)
{
    return srv_log_is_json() && write_message(SRV_LOG_ERROR, 0, said);
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

/* crash.c - what is said before we die of our own fault. */
#include "crash.h"

#include <execinfo.h>
#include <fcntl.h>
#include <signal.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "crash_context.h"
#include "invariant.h"
#include "log.h"

#define FRAMES_MAX  64
#define STACK_BYTES 65536u
#define TRACE_BYTES 16384u /* of a backtrace that becomes JSON */

/* Through it a backtrace becomes lines of JSON; -1: the log is text. */
static int trace_pipe[2] = {-1, -1};

static _Thread_local unsigned char handler_stack[STACK_BYTES];
static atomic_flag reporting = ATOMIC_FLAG_INIT;

/* A line of text that is put together without a lock. */
struct line {
    char text[512];
    size_t length;
};

static void add_text(struct line *line, const char *text)
{
    while (*text != '\0' && line->length < sizeof line->text) {
        line->text[line->length++] = *text++;
    }
}

static void add_number(struct line *line, uint64_t number)
{
    char digits[20];
    size_t count = 0;
    do {
        digits[count++] = (char)('0' + number % 10);
        number /= 10;
    } while (number > 0);
    while (count > 0 && line->length < sizeof line->text) {
        line->text[line->length++] = digits[--count];
    }
}

static const char *name_of(int signal)
{
    switch (signal) {
    case SIGSEGV:
        return "SIGSEGV";
    case SIGBUS:
        return "SIGBUS";
    case SIGFPE:
        return "SIGFPE";
    case SIGILL:
        return "SIGILL";
    case SIGSYS:
        return "SIGSYS";
    default:
        return "SIGABRT";
    }
}

/* Write a line in the form of the log; one of text has no time. */
static void say(struct line *line)
{
    size_t last = sizeof line->text - 1;
    line->length = line->length < last ? line->length : last;
    line->text[line->length] = '\0';
    if (trace_pipe[1] < 0 || !srv_log_last_words(line->text)) {
        line->text[line->length] = '\n';
        (void)!write(STDERR_FILENO, line->text, line->length + 1);
    }
}

/* Say what is in the pipe, line by line. */
static void say_trace(void)
{
    static char text[TRACE_BYTES];
    ssize_t bytes = read(trace_pipe[0], text, sizeof text - 1);
    for (char *begin = text, *end = text + (bytes > 0 ? bytes : 0); begin < end;) {
        struct line line = {.length = 0};
        size_t length = strcspn(begin, "\n");
        begin[length] = '\0';
        add_text(&line, begin);
        say(&line);
        begin += length + 1;
    }
}

static void report(const char *what)
{
    struct line line = {.length = 0};
    void *frames[FRAMES_MAX];
    const struct srv_crash_context *current = srv_crash_context_of_thread();
    add_text(&line, "pccdd " PACKAGE_VERSION ": ");
    add_text(&line, what);
    add_text(&line, " in process ");
    add_number(&line, (uint64_t)getpid());
    add_text(&line, ", thread ");
    add_number(&line, (uint64_t)gettid());
    add_text(&line, " (");
    add_text(&line, srv_thread_name());
    add_text(&line, "), request ");
    if (current->method != NULL) {
        add_number(&line, current->id);
        add_text(&line, " ");
        add_text(&line, current->method);
        add_text(&line, " of session ");
        add_number(&line, current->session);
    } else {
        add_text(&line, "none");
    }
    say(&line);
    int count = backtrace(frames, FRAMES_MAX);
    if (trace_pipe[1] < 0) {
        backtrace_symbols_fd(frames, count, STDERR_FILENO);
        return;
    }
    backtrace_symbols_fd(frames, count, trace_pipe[1]);
    say_trace();
}

/* SA_RESETHAND has put the default action back: the signal is fatal now. */
static void on_fatal(int signal)
{
    if (!atomic_flag_test_and_set(&reporting)) {
        report(name_of(signal));
    }
    raise(signal);
}

/* We exit by the main thread. What called this from another one has said why; to go on
 * with exit would take everything away under the threads that still run. */
static void on_exit_called(void)
{
    if (gettid() != getpid()) {
        if (!atomic_flag_test_and_set(&reporting)) {
            report("exit, called by a library,");
        }
        _exit(1);
    }
}

void srv_crash_thread(void)
{
    const stack_t stack = {.ss_sp = handler_stack, .ss_size = sizeof handler_stack};
    stack_t present;
    /* A sanitizer gives each thread a stack of its own, which it wants back. */
    if (sigaltstack(NULL, &present) == 0 && (present.ss_flags & SS_DISABLE) != 0) {
        sigaltstack(&stack, NULL);
    }
}

void srv_crash_install(void)
{
    static const int fatal[] = {SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT, SIGSYS};
    struct sigaction action = {.sa_handler = on_fatal,
                               .sa_flags = (int)(SA_RESETHAND | SA_ONSTACK | SA_NODEFER)};
    void *frame[1];
    (void)backtrace(frame, 1); /* loads what it needs */
    if (srv_log_is_json()) {
        (void)!pipe2(trace_pipe, O_CLOEXEC | O_NONBLOCK);
    }
    srv_crash_thread();
    sigemptyset(&action.sa_mask);
    for (size_t i = 0; i < sizeof fatal / sizeof fatal[0]; i++) {
        sigaction(fatal[i], &action, NULL);
    }
    (void)atexit(on_exit_called);
}

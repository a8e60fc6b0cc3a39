/* terminal.c - colours, live screens and interrupts. */
#include "terminal.h"

#include <poll.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/ioctl.h>
#include <termios.h>
#include <time.h>
#include <unistd.h>

#include "clock.h"

static bool is_forbidden;
static volatile sig_atomic_t is_interrupted;
static struct termios found; /* how the terminal was, while has_keys */
static bool has_keys;

void terminal_forbid_colours(void)
{
    is_forbidden = true;
}

static bool is_live(int fd)
{
    const char *kind = getenv("TERM");
    return isatty(fd) == 1 && kind != NULL && strcmp(kind, "dumb") != 0;
}

bool terminal_is_live(void)
{
    return is_live(STDOUT_FILENO);
}

bool terminal_has_live_errors(void)
{
    return is_live(STDERR_FILENO);
}

static bool has_colours(void)
{
    const char *told = getenv("NO_COLOR");
    return !is_forbidden && (told == NULL || told[0] == '\0') && terminal_is_live();
}

const char *terminal_begin(enum terminal_colour colour)
{
    static const char *const codes[] = {[TERMINAL_GREEN] = "\033[32m",
                                        [TERMINAL_YELLOW] = "\033[33m",
                                        [TERMINAL_RED] = "\033[31m",
                                        [TERMINAL_BOLD] = "\033[1m"};
    return has_colours() ? codes[colour] : "";
}

const char *terminal_end(void)
{
    return has_colours() ? "\033[0m" : "";
}

void terminal_size(int fd, uint32_t *columns, uint32_t *rows)
{
    struct winsize size = {.ws_col = 0};
    bool is_told = ioctl(fd, TIOCGWINSZ, &size) == 0;
    *columns = is_told && size.ws_col > 0 ? size.ws_col : 80;
    *rows = is_told && size.ws_row > 0 ? size.ws_row : 24;
}

bool terminal_has_size(int fd)
{
    struct winsize size = {.ws_col = 0};
    return isatty(fd) == 1 && ioctl(fd, TIOCGWINSZ, &size) == 0 && size.ws_col > 0;
}

void terminal_redraw(void)
{
    fputs("\033[H\033[J", stdout);
}

static void on_signal(int number)
{
    (void)number;
    is_interrupted = 1;
}

void terminal_catch_interrupts(void)
{
    struct sigaction action = {.sa_handler = on_signal};
    sigemptyset(&action.sa_mask);
    sigaction(SIGINT, &action, NULL);
    sigaction(SIGTERM, &action, NULL);
    action.sa_handler = SIG_IGN;
    sigaction(SIGPIPE, &action, NULL);
}

bool terminal_was_interrupted(void)
{
    return is_interrupted != 0;
}

bool terminal_has_no_reader(void)
{
    struct pollfd output = {.fd = STDOUT_FILENO, .events = POLLOUT};
    return poll(&output, 1, 0) == 1 && (output.revents & POLLERR) != 0;
}

void terminal_sleep(double seconds)
{
    struct timespec left = {.tv_sec = (time_t)seconds};
    left.tv_nsec = (long)((seconds - (double)left.tv_sec) * 1e9);
    while (!is_interrupted && nanosleep(&left, &left) != 0) {
        continue;
    }
}

void terminal_take_keys(void)
{
    bool is_ours = tcgetpgrp(STDIN_FILENO) == getpgrp(); /* or to set it would stop us */
    if (is_ours && tcgetattr(STDIN_FILENO, &found) == 0) {
        struct termios wanted = found;
        wanted.c_lflag &= ~(tcflag_t)(ICANON | ECHO);
        has_keys = tcsetattr(STDIN_FILENO, TCSANOW, &wanted) == 0;
    }
}

void terminal_free_keys(void)
{
    if (has_keys) {
        (void)tcsetattr(STDIN_FILENO, TCSANOW, &found);
        has_keys = false;
    }
}

void terminal_wait(double seconds)
{
    double end = terminal_now_s() + seconds, left = seconds;
    char key = 0;
    for (; has_keys && left > 0 && !is_interrupted; left = end - terminal_now_s()) {
        struct pollfd keys = {.fd = STDIN_FILENO, .events = POLLIN};
        if (poll(&keys, 1, (int)(left * 1e3) + 1) == 1) {
            if (read(STDIN_FILENO, &key, 1) != 1) {
                break; /* it has gone */
            }
            is_interrupted = is_interrupted || key == 'q' || key == 'Q';
        }
    }
    if (left > 0) {
        terminal_sleep(left);
    }
}

double terminal_now_s(void)
{
    return (double)common_now_ns() / 1e9;
}

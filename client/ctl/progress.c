/* progress.c - a progress bar. */
#include "terminal.h"

#include <inttypes.h>
#include <signal.h>
#include <stdio.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

#include "clock.h"

#define BAR_CHARS 40u /* at most */
#define REDRAW_NS 50000000u
#define LEFT_NS   2000000000u /* until then nobody knows how long it takes */

static volatile sig_atomic_t is_drawn; /* a bar, on the row of the cursor */

/* Take the bar away, and end as if nobody had caught the signal. */
static void on_end(int number)
{
    static const char clear[] = "\r\033[K";
    if (is_drawn) {
        ssize_t written = write(STDERR_FILENO, clear, sizeof clear - 1);
        (void)written;
    }
    (void)raise(number); /* which SA_RESETHAND lets end the program */
}

/* Catch what ends the program, unless that is caught or ignored already. */
static void catch_end(int number)
{
    const struct sigaction action = {.sa_handler = on_end, .sa_flags = (int)SA_RESETHAND};
    struct sigaction now;
    if (sigaction(number, NULL, &now) == 0 && now.sa_handler == SIG_DFL) {
        (void)sigaction(number, &action, NULL);
    }
}

void progress_begin(struct progress *progress, const char *label, uint64_t total)
{
    progress->label = label;
    progress->total = total;
    progress->drawn_ns = 0;
    progress->begin_ns = 0;
    progress->is_on = total > 0 && terminal_has_live_errors();
    if (progress->is_on) {
        catch_end(SIGINT);
        catch_end(SIGTERM);
    }
}

/* Return how much of a row is left for the bar: a row that wraps would stay behind at
 * each drawing. The last column stays free. */
static uint32_t bar_chars(uint32_t other_chars)
{
    uint32_t columns, rows;
    terminal_size(STDERR_FILENO, &columns, &rows);
    uint32_t left = columns > other_chars ? columns - other_chars : 0;
    return left < BAR_CHARS ? left : BAR_CHARS;
}

/* ", 1:05 left", as long as the rest takes at the speed so far; "" while that is not
 * known. */
static void tell_left(const struct progress *progress, uint64_t now, uint64_t done,
                      char *text, size_t bytes)
{
    uint64_t made = done - progress->begun, taken = now - progress->begin_ns;
    text[0] = '\0';
    if (done > progress->begun && done < progress->total && taken > LEFT_NS) {
        double left = (double)taken / (double)made * (double)(progress->total - done);
        uint64_t seconds = (uint64_t)(left / 1e9 + 0.5);
        snprintf(text, bytes, ", %" PRIu64 ":%02" PRIu64 " left", seconds / 60,
                 seconds % 60);
    }
}

void progress_update(struct progress *progress, uint64_t done)
{
    if (!progress->is_on) {
        return;
    }
    uint64_t now = common_now_ns();
    done = done < progress->total ? done : progress->total; /* time goes on */
    if (progress->begin_ns == 0) {
        progress->begin_ns = now;
        progress->begun = done;
    }
    if (progress->drawn_ns != 0 && now - progress->drawn_ns < REDRAW_NS &&
        done < progress->total) {
        return;
    }
    char bar[BAR_CHARS + 1], left[40], count[96];
    tell_left(progress, now, done, left, sizeof left);
    int count_chars = snprintf(count, sizeof count, "%" PRIu64 "/%" PRIu64 "%s", done,
                               progress->total, left);
    uint32_t chars =
        bar_chars((uint32_t)strlen(progress->label) + (uint32_t)count_chars + 5);
    uint64_t filled = done * chars / progress->total;
    for (uint32_t i = 0; i < chars; i++) {
        bar[i] = i < filled ? '#' : '.';
    }
    bar[chars] = '\0';
    is_drawn = 1;
    fprintf(stderr, "\r%s [%s] %s\033[K", progress->label, bar, count);
    progress->drawn_ns = now;
}

bool progress_is_drawn(void)
{
    return is_drawn != 0;
}

void progress_clear(struct progress *progress)
{
    if (progress->is_on && progress->drawn_ns != 0) {
        fputs("\r\033[K", stderr);
        is_drawn = 0;
    }
    progress->drawn_ns = 0;
}

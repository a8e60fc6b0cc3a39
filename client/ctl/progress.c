/* progress.c - a progress bar. */
#include "terminal.h"

#include <inttypes.h>
#include <stdio.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

#include "clock.h"

#define BAR_CHARS 40u /* at most */
#define REDRAW_NS 50000000u

void progress_begin(struct progress *progress, const char *label, uint64_t total)
{
    progress->label = label;
    progress->total = total;
    progress->drawn_ns = 0;
    progress->is_on = total > 0 && terminal_has_live_errors();
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

void progress_update(struct progress *progress, uint64_t done)
{
    if (!progress->is_on) {
        return;
    }
    uint64_t now = common_now_ns();
    if (progress->drawn_ns != 0 && now - progress->drawn_ns < REDRAW_NS &&
        done < progress->total) {
        return;
    }
    char bar[BAR_CHARS + 1], count[48];
    done = done < progress->total ? done : progress->total; /* time goes on */
    int count_chars =
        snprintf(count, sizeof count, "%" PRIu64 "/%" PRIu64, done, progress->total);
    uint32_t chars =
        bar_chars((uint32_t)strlen(progress->label) + (uint32_t)count_chars + 5);
    uint64_t filled = done * chars / progress->total;
    for (uint32_t i = 0; i < chars; i++) {
        bar[i] = i < filled ? '#' : '.';
    }
    bar[chars] = '\0';
    fprintf(stderr, "\r%s [%s] %s\033[K", progress->label, bar, count);
    progress->drawn_ns = now;
}

void progress_clear(struct progress *progress)
{
    if (progress->is_on && progress->drawn_ns != 0) {
        fputs("\r\033[K", stderr);
    }
    progress->drawn_ns = 0;
}

/* client/ctl/progress.c - a progress bar.
 *
 * Room:     client/ctl.
 * Does:     draws on stderr when that is a terminal.
 * Does not: print anything otherwise.
 * Threads:  one.
 * Source:   progress.h.
 */
#include "progress.h"

#include <inttypes.h>
#include <stdio.h>
#include <time.h>

#include "terminal.h"

#define BAR_CHARS 40
#define REDRAW_NS 50000000u

static uint64_t now_ns(void)
{
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return (uint64_t)now.tv_sec * 1000000000u + (uint64_t)now.tv_nsec;
}

void progress_begin(struct progress *progress, const char *label, uint64_t total)
{
    progress->label = label;
    progress->total = total;
    progress->drawn_ns = 0;
    progress->is_on = total > 0 && terminal_has_live_errors();
}

void progress_update(struct progress *progress, uint64_t done)
{
    if (!progress->is_on) {
        return;
    }
    uint64_t now = now_ns();
    if (progress->drawn_ns != 0 && now - progress->drawn_ns < REDRAW_NS &&
        done < progress->total) {
        return;
    }
    char bar[BAR_CHARS + 1];
    done = done < progress->total ? done : progress->total; /* time goes on */
    uint64_t filled = done * BAR_CHARS / progress->total;
    for (uint64_t i = 0; i < BAR_CHARS; i++) {
        bar[i] = i < filled ? '#' : '.';
    }
    bar[BAR_CHARS] = '\0';
    fprintf(stderr, "\r%s [%s] %" PRIu64 "/%" PRIu64 "\033[K", progress->label, bar, done,
            progress->total);
    progress->drawn_ns = now;
}

void progress_clear(struct progress *progress)
{
    if (progress->is_on && progress->drawn_ns != 0) {
        fputs("\r\033[K", stderr);
    }
    progress->drawn_ns = 0;
}

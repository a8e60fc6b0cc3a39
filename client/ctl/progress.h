/* progress.h - a progress bar on stderr.
 *
 * Threads: one.
 */
#ifndef CTL_PROGRESS_H
#define CTL_PROGRESS_H

#include <stdbool.h>
#include <stdint.h>

struct progress {
    const char *label;
    uint64_t total;
    uint64_t drawn_ns; /* when; 0 = never */
    bool is_on;
};

void progress_begin(struct progress *progress, const char *label, uint64_t total);
/* `done` of the total are done. */
void progress_update(struct progress *progress, uint64_t done);
/* Take the bar away, to print lines or at the end; the next update draws it again. */
void progress_clear(struct progress *progress);

#endif

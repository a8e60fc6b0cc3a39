/* terminal.h - colours, screens that update, and interrupts, for programs on a terminal.
 */
#ifndef CTL_TERMINAL_H
#define CTL_TERMINAL_H

#include <stdbool.h>
#include <stdint.h>

enum terminal_colour { TERMINAL_GREEN, TERMINAL_YELLOW, TERMINAL_RED, TERMINAL_BOLD };

/* Forbid colours from now on: --no-color was given. */
void terminal_forbid_colours(void);
/* Return the text that begins a colour on the standard output, or ends it; "" where there
 * are none. */
const char *terminal_begin(enum terminal_colour colour);
const char *terminal_end(void);

/* Return whether the standard output is a terminal, on which a screen may be drawn anew;
 * then the same of the standard error. */
bool terminal_is_live(void);
bool terminal_has_live_errors(void);
/* Tell the columns and rows of the terminal behind a descriptor; 80 and 24 if it does
 * not. */
void terminal_size(int fd, uint32_t *columns, uint32_t *rows);
/* Return whether it is a terminal whose size is known; that of mpirun's ranks is not. */
bool terminal_has_size(int fd);
/* Begin to draw it anew, from the top; what was below goes. */
void terminal_redraw(void);

/* Note SIGINT and SIGTERM from now on, instead of ending the program; a pipe that nobody
 * reads becomes an error of writing. */
void terminal_catch_interrupts(void);
bool terminal_was_interrupted(void);
/* Return whether the standard output is a pipe that nobody reads any more. */
bool terminal_has_no_reader(void);
/* Sleep, or until an interrupt. */
void terminal_sleep(double seconds);
/* Let terminal_wait see keys as they are pressed, if the standard input is a terminal of
 * ours; until terminal_free_keys. */
void terminal_take_keys(void);
void terminal_free_keys(void);
/* Sleep, or until an interrupt or the key q, which counts as one. */
void terminal_wait(double seconds);
/* Return the time of CLOCK_MONOTONIC, in seconds. */
double terminal_now_s(void);

/* ---- A progress bar on stderr. */

struct progress {
    const char *label;
    uint64_t total;
    uint64_t drawn_ns; /* when; 0 = never */
    uint64_t begin_ns; /* when `begun` were done, from which the time left is estimated */
    uint64_t begun;
    bool is_on;
};

void progress_begin(struct progress *progress, const char *label, uint64_t total);
/* Draw that `done` of the total are done, unless the bar was drawn a moment ago. */
void progress_update(struct progress *progress, uint64_t done);
/* Return whether a bar stands there, which another one would overwrite. */
bool progress_is_drawn(void);
/* Take the bar away, to print lines or at the end; the next update draws it again. */
void progress_clear(struct progress *progress);

#endif

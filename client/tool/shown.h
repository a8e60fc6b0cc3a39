/* shown.h - makes names that others chose (files, processes) safe to print on a terminal.
 *
 * Threads: one.
 */
#ifndef TOOL_SHOWN_H
#define TOOL_SHOWN_H

#include <stddef.h>
#include <stdint.h>

/* Each of these lives until seven more have been made, and is cut after 4095 bytes. What
 * could control a terminal is written as \xNN. */
const char *tool_shown(const char *text);
/* The same of a field of at most `bytes` bytes, which a NUL may end earlier. */
const char *tool_shown_field(const char *text, size_t bytes);
/* The same, cut to so many columns of a table; then a + says so. */
const char *tool_shown_cut(const char *text, uint32_t columns);
/* The same, filled with blanks to that many columns, too. */
const char *tool_shown_column(const char *text, uint32_t columns);

#endif

/* shown.h - makes names that others chose (files, processes) safe to print on a terminal.
 *
 * Threads: one.
 */
#ifndef TOOL_SHOWN_H
#define TOOL_SHOWN_H

#include <stddef.h>
#include <stdint.h>

/* Return text that is safe to print: what could control a terminal is written as \xNN.
 * Each of these lives until seven more have been made, and is cut after 4095 bytes. */
const char *tool_shown(const char *text);
/* Show a field of at most `bytes` bytes so, which a NUL may end earlier. */
const char *tool_shown_field(const char *text, size_t bytes);
/* Show text so, cut to so many columns of a table; then a + says so. */
const char *tool_shown_cut(const char *text, uint32_t columns);
/* Show text so, cut to that many columns, and filled with blanks to as many. */
const char *tool_shown_column(const char *text, uint32_t columns);

/* Return a number as people read it, with four significant digits: 0.5, 7.492e-06; below
 * 1 with so many that it is not read as 1. So are all in text of ours that are measured
 * or computed; JSON and CSV have all digits. It lives as long as the above. */
const char *tool_shown_number(double number);
/* Return an interval so: "0.5 to 0.75", or "0.5" where both ends are read as that. */
const char *tool_shown_interval(double low, double high);

#endif

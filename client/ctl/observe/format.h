/* format.h - formats counts, bytes and times for people: "1.5 MiB".
 *
 * Threads: one.
 */
#ifndef CTL_FORMAT_H
#define CTL_FORMAT_H

#include <stdint.h>

/* Each of these lives until seven more have been made. "1.2 M", "3.4 MiB", "1 h 02 min",
 * "1.25 ms". */
const char *format_count(double count);
const char *format_bytes(double bytes);
const char *format_span(uint64_t nanoseconds);
const char *format_ms(double milliseconds);
/* The name of a user, or the number. */
const char *format_user(uint32_t uid);

#endif

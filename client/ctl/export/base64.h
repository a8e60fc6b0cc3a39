/* client/ctl/export/base64.h - writes bytes as text (base64).
 *
 * Room:     client/ctl. May include: the C library.
 * Does:     follow RFC 4648, with padding, without line ends.
 * Does not: decode.
 * Threads:  [any].
 */
#ifndef CTL_BASE64_H
#define CTL_BASE64_H

#include <stdbool.h>
#include <stddef.h>
#include <stdio.h>

/* False when the file cannot be written. */
bool base64_write(const void *bytes, size_t count, FILE *to);

#endif

/* printable.h - makes text from elsewhere safe to print on a terminal.
 *
 * Write bytes that could control a terminal or its reader as \xNN: control characters of
 * seven and eight bits, those that turn the direction of text or are not seen (Unicode's
 * format characters), and whatever is not UTF-8.
 */
#ifndef PROTO_PRINTABLE_H
#define PROTO_PRINTABLE_H

#include <stddef.h>

/* "a\033[2J" becomes "a\x1b[2J". At most room - 1 bytes and a NUL are written to `to`,
 * never a part of an \xNN or of a character. Returns how many bytes all of it takes
 * without the NUL, as snprintf does. `bytes` may include NULs: they become \x00. */
size_t proto_printable(const char *text, size_t bytes, char *to, size_t room);

#endif

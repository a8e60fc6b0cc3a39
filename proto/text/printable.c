/* printable.c - text that was not written by us, before a person reads it on a terminal.
 *
 * Room:     proto/text. See printable.h.
 * Does:     walks over sequences of UTF-8.
 * Threads:  [any].
 */
#include "printable.h"

#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

#include "utf8.h"

#define ESCAPE_BYTES 4u /* of \xNN */

/* C0, DEL, and C1 as UTF-8 has it. */
static bool is_control(const uint8_t *text, size_t length)
{
    return text[0] < 0x20 || text[0] == 0x7f ||
           (length == 2 && text[0] == 0xc2 && text[1] < 0xa0);
}

size_t proto_printable(const char *text, size_t bytes, char *to, size_t room)
{
    const uint8_t *from = (const uint8_t *)text;
    size_t all = 0, written = 0;
    bool is_cut = false;
    for (size_t at = 0; at < bytes;) {
        char escape[ESCAPE_BYTES + 1];
        size_t length = proto_utf8_sequence(from + at, bytes - at);
        bool is_kept = length > 0 && !is_control(from + at, length);
        size_t taken = is_kept ? length : 1;
        size_t made = is_kept ? length : ESCAPE_BYTES;
        is_cut = is_cut || written + made >= room;
        if (!is_cut && is_kept) {
            memcpy(to + written, text + at, made);
            written += made;
        } else if (!is_cut) {
            snprintf(escape, sizeof escape, "\\x%02x", from[at]);
            memcpy(to + written, escape, made);
            written += made;
        }
        at += taken;
        all += made;
    }
    if (room > 0) {
        to[written] = '\0';
    }
    return all;
}

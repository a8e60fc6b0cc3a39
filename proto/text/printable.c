/* printable.c - text that was not written by us, before a person reads it on a
 * terminal.
 */
#include "printable.h"

#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

#include "utf8.h"

#define ESCAPE_BYTES 4u /* of \xNN */

/* Characters that show nothing and say how others are shown: controls (Unicode's Cc),
 * format characters (Cf), which turn the direction of what follows, join or hide, and
 * separators of lines and paragraphs (Zl, Zp). First and last of each run. */
static const uint32_t unseen[][2] = {
    {0x0, 0x1f},        {0x7f, 0x9f},       {0xad, 0xad},       {0x600, 0x605},
    {0x61c, 0x61c},     {0x6dd, 0x6dd},     {0x70f, 0x70f},     {0x890, 0x891},
    {0x8e2, 0x8e2},     {0x180e, 0x180e},   {0x200b, 0x200f},   {0x2028, 0x202e},
    {0x2060, 0x206f},   {0xfeff, 0xfeff},   {0xfff9, 0xfffb},   {0x110bd, 0x110bd},
    {0x110cd, 0x110cd}, {0x13430, 0x1343f}, {0x1bca0, 0x1bca3}, {0x1d173, 0x1d17a},
    {0xe0000, 0xe0fff}}; /* of which most are none yet, and none is to be seen */

/* The character of a well-formed sequence. */
static uint32_t character(const uint8_t *text, size_t length)
{
    uint32_t at = length == 1 ? text[0] : text[0] & (0x7fu >> length);
    for (size_t i = 1; i < length; i++) {
        at = at << 6 | (text[i] & 0x3fu);
    }
    return at;
}

static bool is_unseen(const uint8_t *text, size_t length)
{
    uint32_t at = character(text, length);
    bool is_one = false;
    for (size_t i = 0; i < sizeof unseen / sizeof unseen[0]; i++) {
        is_one = is_one || (at >= unseen[i][0] && at <= unseen[i][1]);
    }
    return is_one;
}

size_t proto_printable(const char *text, size_t bytes, char *to, size_t room)
{
    const uint8_t *from = (const uint8_t *)text;
    size_t all = 0, written = 0;
    bool is_cut = false;
    for (size_t at = 0; at < bytes;) {
        char escape[ESCAPE_BYTES + 1];
        size_t length = proto_utf8_sequence(from + at, bytes - at);
        bool is_kept = length > 0 && !is_unseen(from + at, length);
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

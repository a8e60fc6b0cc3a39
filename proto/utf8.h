/* utf8.h - checks that text is well-formed UTF-8. */
#ifndef PROTO_UTF8_H
#define PROTO_UTF8_H

#include <stddef.h>
#include <stdint.h>

/* Return how many bytes the well-formed sequence at text[left] has, left >= 1; 0: there
 * is none, or it is a NUL. */
static inline size_t proto_utf8_sequence(const uint8_t *text, size_t left)
{
    uint8_t first = text[0];
    size_t bytes = first < 0x80 ? 1 : first < 0xe0 ? 2 : first < 0xf0 ? 3 : 4;
    uint8_t low = 0x80, high = 0xbf; /* of the second byte */

    if (first == 0 || (first >= 0x80 && first < 0xc2) || first > 0xf4 || bytes > left) {
        return 0;
    }
    if (first == 0xe0) {
        low = 0xa0;
    } else if (first == 0xed) {
        high = 0x9f;
    } else if (first == 0xf0) {
        low = 0x90;
    } else if (first == 0xf4) {
        high = 0x8f;
    }
    if (bytes > 1 && (text[1] < low || text[1] > high)) {
        return 0;
    }
    for (size_t i = 2; i < bytes; i++) {
        if (text[i] < 0x80 || text[i] > 0xbf) {
            return 0;
        }
    }
    return bytes;
}

#endif

/* client/ctl/export/base64.c - bytes as text.
 *
 * Room:     client/ctl.
 * Does:     three bytes become four characters.
 * Does not: decode.
 * Threads:  [any].
 * Source:   base64.h.
 */
#include "base64.h"

#include <stdint.h>

#define GROUPS 1024 /* written at once */

static const char digits[] =
    "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";

bool base64_write(const void *bytes, size_t count, FILE *to)
{
    const uint8_t *at = bytes;
    char text[4 * GROUPS];
    size_t used = 0;
    for (size_t i = 0; i < count; i += 3) {
        uint32_t word = (uint32_t)at[i] << 16;
        word |= i + 1 < count ? (uint32_t)at[i + 1] << 8 : 0;
        word |= i + 2 < count ? at[i + 2] : 0;
        text[used++] = digits[word >> 18];
        text[used++] = digits[word >> 12 & 63];
        text[used++] = i + 1 < count ? digits[word >> 6 & 63] : '=';
        text[used++] = i + 2 < count ? digits[word & 63] : '=';
        if (used == sizeof text) {
            if (fwrite(text, 1, used, to) != used) {
                return false;
            }
            used = 0;
        }
    }
    return fwrite(text, 1, used, to) == used;
}

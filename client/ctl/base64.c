/* base64.c - bytes as text. */
#include "base64.h"

#include <stdint.h>
#include <string.h>

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

bool base64_read(const char *text, size_t count, void *bytes, size_t *byte_count)
{
    int8_t value_of[256];
    uint8_t *to = bytes;
    uint32_t word = 0;
    memset(value_of, -1, sizeof value_of);
    for (int8_t i = 0; i < 64; i++) {
        value_of[(uint8_t)digits[i]] = i;
    }
    for (int pad = 0; pad < 2 && count > 0 && text[count - 1] == '='; pad++) {
        count--;
    }
    if (count % 4 == 1) {
        return false;
    }
    for (size_t i = 0; i < count; i++) {
        int value = value_of[(uint8_t)text[i]];
        if (value < 0) {
            return false;
        }
        word = word << 6 | (uint32_t)value;
        if (i % 4 > 0) {
            *to++ = (uint8_t)(word >> (6 - 2 * (i % 4)));
        }
    }
    *byte_count = (size_t)(to - (uint8_t *)bytes);
    return true;
}

/* bytes.c - a growing array of bytes, divided into sections. */
#include "bytes.h"

#include <stdlib.h>
#include <string.h>

#define FIRST_ROOM 65536u

void *bytes_section(struct bytes *bytes, size_t count, size_t *offset)
{
    size_t begin = (bytes->used + BYTES_ALIGN - 1) / BYTES_ALIGN * BYTES_ALIGN;
    size_t room = bytes->room == 0 ? FIRST_ROOM : bytes->room;
    while (room < begin + count) {
        room *= 2;
    }
    if (room > bytes->room) {
        uint8_t *grown = realloc(bytes->at, room);
        if (grown == NULL) {
            bytes->is_short = true;
            return NULL;
        }
        bytes->at = grown;
        bytes->room = room;
    }
    memset(bytes->at + bytes->used, 0, begin + count - bytes->used);
    bytes->used = begin + count;
    *offset = begin;
    return bytes->at + begin;
}

void bytes_empty(struct bytes *bytes)
{
    bytes->used = 0;
    bytes->is_short = false;
}

void bytes_deinit(struct bytes *bytes)
{
    free(bytes->at);
    memset(bytes, 0, sizeof *bytes);
}

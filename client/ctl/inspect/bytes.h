/* bytes.h - a growing array of bytes, divided into sections.
 *
 * Threads: one.
 */
#ifndef CTL_BYTES_H
#define CTL_BYTES_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* Sections begin at multiples of it: of 4, for the arrays of a script, and of 3, so that
 * a section can be taken out of base64 text without what is before it. */
#define BYTES_ALIGN 12u

struct bytes {
    uint8_t *at; /* ours */
    size_t used, room;
    bool is_short; /* there was no memory: what is here is not all */
};

/* Begin a section of `count` bytes, zeros; its memory, valid until the next call, or NULL
 * without memory. *offset: where it begins. */
void *bytes_section(struct bytes *bytes, size_t count, size_t *offset);
void bytes_empty(struct bytes *bytes);
void bytes_deinit(struct bytes *bytes);

#endif

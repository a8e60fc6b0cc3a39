/* base64.h - bytes as text (base64), and text as bytes. */
#ifndef CTL_BASE64_H
#define CTL_BASE64_H

#include <stdbool.h>
#include <stddef.h>
#include <stdio.h>

/* Write bytes as base64. False when the file cannot be written. */
bool base64_write(const void *bytes, size_t count, FILE *to);
/* Fill `bytes`, which has room for count / 4 * 3 + 2, from `count` characters. False when
 * one of them is none of base64, or there is one too few or too many. */
bool base64_read(const char *text, size_t count, void *bytes, size_t *byte_count);

#endif

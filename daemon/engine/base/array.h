/* array.h - arrays that grow: chooses the next capacity.
 *
 * Threads: [any]; one thread for one array.
 */
#ifndef ENG_ARRAY_H
#define ENG_ARRAY_H

#include <stddef.h>
#include <stdint.h>

#include "pccd_types.h"

/* A capacity for `end` items: grown by an eighth, which is what may lie idle, so that
 * adding objects one by one copies each array a logarithmic number of times. */
uint32_t eng_array_grown(uint32_t capacity, uint32_t end);

/* Grow one array of items of `bytes`; `array` is the address of the pointer to it, which
 * is unchanged on failure (PCCD_E_NOMEM). */
int eng_array_grow(void *array, uint32_t capacity, size_t bytes);

#endif

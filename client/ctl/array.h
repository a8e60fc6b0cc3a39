/* array.h - arrays that grow by doubling.
 *
 * Threads: any, one for each array.
 */
#ifndef CTL_ARRAY_H
#define CTL_ARRAY_H

#include <stdbool.h>
#include <stddef.h>
#include <stdlib.h>

#define ARRAY_FIRST_ROOM 64u

/* Make room in *items for one more element of `bytes`. *items is of malloc (NULL: none
 * yet), and has `count` elements and room for *room. False: no memory, and all is as it
 * was. */
static inline bool array_reserve(void **items, size_t count, size_t *room, size_t bytes)
{
    if (count < *room) {
        return true;
    }
    size_t larger = *room == 0 ? ARRAY_FIRST_ROOM : *room * 2;
    void *grown = realloc(*items, larger * bytes);
    if (grown == NULL) {
        return false;
    }
    *items = grown;
    *room = larger;
    return true;
}

#endif

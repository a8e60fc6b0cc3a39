/* array.c - arrays that grow. */
#include "array.h"

#include <stdlib.h>

#define FIRST_ROOM 64u

bool array_reserve(void **items, size_t count, size_t *room, size_t bytes)
{
    if (count < *room) {
        return true;
    }
    size_t larger = *room == 0 ? FIRST_ROOM : *room * 2;
    void *grown = realloc(*items, larger * bytes);
    if (grown == NULL) {
        return false;
    }
    *items = grown;
    *room = larger;
    return true;
}

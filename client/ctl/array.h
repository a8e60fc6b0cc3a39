/* array.h - arrays that grow by doubling.
 *
 * Threads: any, one for each array.
 */
#ifndef CTL_ARRAY_H
#define CTL_ARRAY_H

#include <stdbool.h>
#include <stddef.h>

/* Room for one more element of `bytes` each in *items, of malloc (NULL: none yet), which
 * has `count` and room for *room. False: no memory, and all is as it was. */
bool array_reserve(void **items, size_t count, size_t *room, size_t bytes);

#endif

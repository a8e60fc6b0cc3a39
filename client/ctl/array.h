/* client/ctl/array.h - arrays that grow by doubling.
 *
 * Room:     client/ctl. May include: the C library.
 * Does:     make room for one element more, and allocate twice as much as before when
 *           there is none.
 * Threads:  any, one for each array.
 * Source:   used wherever something is read whose length is not known before.
 */
#ifndef CTL_ARRAY_H
#define CTL_ARRAY_H

#include <stdbool.h>
#include <stddef.h>

/* Room for one more element of `bytes` each in *items, of malloc (NULL: none yet), which
 * has `count` and room for *room. False: no memory, and all is as it was. */
bool array_reserve(void **items, size_t count, size_t *room, size_t bytes);

#endif

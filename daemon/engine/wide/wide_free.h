/* wide_free.h - which features of the wide trees are free: points and edges that no
 * triangle has (mesh.h).
 *
 * Say of pairs which are of two such, by the marks in the trees. Features of all sorts
 * are in one tree, so pairs of kinds that ask for free ones alone are sifted by these
 * marks at each level.
 *
 * Threads: [any]: the trees are only read.
 */
#ifndef ENG_WIDE_FREE_H
#define ENG_WIDE_FREE_H

#include <stdbool.h>
#include <stdint.h>

#include "wide.h"

/* Bits of the kinds that are asked for where features keep a distance (`thick`), or where
 * they do not: those of free points are left out then, and where there are none. */
uint32_t eng_wide_kinds(const struct eng_wide *wide, bool thick);

/* Does a kind ask for free points and edges alone? */
static inline bool eng_wide_is_of_free(enum pccd_kind kind)
{
    return kind == PCCD_VE || kind == PCCD_VV;
}

/* Of pairs a[count], b[count] of children of nodes of `level`, or of slots if that is 0,
 * those stay, in their order, of which both are free or have below them what is. Returns
 * how many. */
uint32_t eng_wide_free_keep(const struct eng_wide *wide, enum pccd_kind kind,
                            uint32_t level, uint32_t *a, uint32_t *b, uint32_t count);

#endif

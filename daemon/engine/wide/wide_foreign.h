/* daemon/engine/wide/wide_foreign.h - which features of the wide trees are foreign: pairs
 * in which they come first are somebody else's (mesh.h).
 *
 * Room:     engine. May include: wide.h, the C library.
 * Does:     say of pairs which are left out, by the marks in the trees of what is not
 *           foreign, `own`. A join leaves out what has no own feature on a side where it
 *           may come first (join.h). Of two features of one tree that is either side, so
 *           a pair of an own and a foreign one is left, and goes here if the foreign one
 *           comes first.
 * Threads:  [any]: the trees are only read.
 */
#ifndef ENG_WIDE_FOREIGN_H
#define ENG_WIDE_FOREIGN_H

#include <stdint.h>

#include "wide.h"

/* The marks of a level on a side of a kind, as a join asks for them; NULL: there are
 * none, or the features of that side are first in no pair. */
const uint16_t *eng_wide_foreign_marks(const struct eng_wide *wide, enum pccd_kind kind,
                                       int side, uint32_t level);

/* Of pairs of slots a[count], b[count] those stay, in their order, whose first feature is
 * not foreign. Returns how many. */
uint32_t eng_wide_foreign_keep(const struct eng_wide *wide, enum pccd_kind kind,
                               uint32_t *a, uint32_t *b, uint32_t count);

#endif

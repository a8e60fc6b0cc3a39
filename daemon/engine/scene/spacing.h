/* spacing.h - finds out which features of a mesh lie near each other as registered, bit
 * by bit over several steps.
 *
 * Source: elementary/BOUNDS.md, "Objects that move by poses".
 *
 * A mesh has a *spacing*, a length far below the size of its triangles. Two features of
 * it without a common vertex are farther apart than that, unless both are *near*: some
 * other feature may be within the spacing. Most meshes have no near features; parts that
 * touch, slivers and places where the mesh cuts itself have.
 *
 * All of it takes some 2 us a triangle and, while it lasts, 70 bytes a triangle. It is
 * done once for each mesh, however many objects and scenes use it.
 */
#ifndef ENG_SPACING_H
#define ENG_SPACING_H

#include "mesh.h"
#include "pccd_trace.h"

/* The mesh goes. */
void eng_spacing_deinit(struct eng_mesh *mesh);

/* Go on with the search for about `budget` tests of boxes or features, some 20 ns each,
 * unless another thread is at it. Returns how many it took; 0: nothing to do, now or at
 * all. Without memory everything counts as near. One thread for a mesh at a time does it,
 * any may try. [team] */
uint64_t eng_spacing_advance(struct eng_mesh *mesh, uint64_t budget);

/* Is the search over? What is said here stays so. [any] */
bool eng_spacing_is_known(const struct eng_mesh *mesh);

/* The spacing; 0: not known yet, or of no use. [any] */
double eng_spacing_of(const struct eng_mesh *mesh);

/* Of a mesh whose spacing is known: is anything near? Is that feature? [any] */
bool eng_spacing_has_near(const struct eng_mesh *mesh);
bool eng_spacing_is_near(const struct eng_mesh *mesh, enum pccd_tree tree,
                         uint32_t feature);

#endif

/* wide_crowded.h - finds out which features of a mesh are crowded: close to others of it
 * as registered; bit by bit over several steps.
 *
 * Source: elementary/BOUNDS.md, "Objects that move by poses".
 *
 * A mesh has a *clearance*, a length far below the size of its triangles. Two features of
 * it without a common vertex are farther apart than that, unless both are *crowded*: some
 * other feature may be within the clearance. Most meshes have no crowded features; parts
 * that touch, slivers and places where the mesh cuts itself have.
 *
 * This is the question for near pairs, asked of one mesh. It is not asked as that, of a
 * scene: all at once it takes as long as two steps of the mesh, and thirty times the
 * memory. This takes some 0.5 us and 10 bytes a triangle, in shares. It is done once for
 * each mesh, however many objects and scenes use it.
 */
#ifndef ENG_WIDE_CROWDED_H
#define ENG_WIDE_CROWDED_H

#include <stdint.h>

struct eng_mesh;
struct eng_scene;

/* Go on with the search for about `budget` tests of boxes or features, some 20 ns each,
 * unless another thread is at it. Returns how many it took; 0: nothing to do, now or at
 * all. Without memory, or without an order (eng_mesh_sort_features), everything counts as
 * crowded. One thread for a mesh at a time does it, any may try. [team] */
uint64_t eng_wide_crowded_advance(struct eng_mesh *mesh, uint64_t budget);

/* Do a step's share of the search for a clearance that was missed (rigid.h), while others
 * traverse. By one thread; later steps have what it finds. [team] */
void eng_wide_crowded_share(struct eng_scene *scene);

#endif

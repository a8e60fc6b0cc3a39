/* body_tree.h - the tree of a mesh: boxes around its leaves, each of which owns features.
 *
 * Make one tree per mesh in the mesh's own frame, once, when it is first needed; all
 * objects that turn and have the mesh share it, and it goes with the mesh. Fit the boxes
 * of the same tree to an object that goes straight, for a step: at both of its ends.
 *
 * Threads: eng_body_tree_prepare [any]; a tree that is there is only read. A fit belongs
 * to one thread while it is made.
 *
 * A node has up to four children, whose boxes lie beside each other, for four lanes. A
 * child is a leaf of the mesh (topology.h), or another node. Boxes are floats: centre and
 * half of each side, measured from an origin near the middle, rounded outward.
 */
#ifndef ENG_BODY_TREE_H
#define ENG_BODY_TREE_H

#include "aabb.h"
#include "path.h"
#include "rotation.h"
#include "topology.h"

#define ENG_BODY_LEAF 0x80000000u /* of a child: the rest is the number of a leaf */
#define ENG_BODY_NONE UINT32_MAX  /* there is no such child; its box holds nothing */

struct eng_body_boxes {
    eng_f4 centre[3]; /* by axis, of each child */
    eng_f4 half[3];
};

struct eng_body_tree {
    uint32_t node_count; /* >= 1; the first is the root, a child comes after its node */
    double origin[3];
    struct eng_path_box box;      /* around all, exactly */
    struct eng_body_boxes *boxes; /* [node_count] at the registered positions */
    uint32_t (*children)[4];      /* [node_count] */
};

/* Return a place from an origin, rounded: x, y, z, 0. */
static inline eng_f4 eng_body_place(const double x[3], const double origin[3])
{
    const eng_d2 xy = eng_d2_load(x) - eng_d2_load(origin);
    return (eng_f4){(float)xy[0], (float)xy[1], (float)(x[2] - origin[2]), 0};
}

/* Set to[k] to coordinate k of each of four places. */
static inline void eng_body_transpose(eng_f4 x0, eng_f4 x1, eng_f4 x2, eng_f4 x3,
                                      eng_f4 to[3])
{
    eng_f4 low[2] = {__builtin_shufflevector(x0, x1, 0, 4, 1, 5),
                     __builtin_shufflevector(x2, x3, 0, 4, 1, 5)};
    eng_f4 high[2] = {__builtin_shufflevector(x0, x1, 2, 6, 2, 6),
                      __builtin_shufflevector(x2, x3, 2, 6, 2, 6)};
    to[0] = __builtin_shufflevector(low[0], low[1], 0, 1, 4, 5);
    to[1] = __builtin_shufflevector(low[0], low[1], 2, 3, 6, 7);
    to[2] = __builtin_shufflevector(high[0], high[1], 0, 1, 4, 5);
}

/* Have the tree of a committed mesh, whose account is charged. should_stop is asked every
 * 0.2 ms or so; NULL: never. PCCD_E_AGAIN: it was stopped, or another thread is at it;
 * what was done stays with the mesh, and the next call goes on. PCCD_E_NOMEM. O(n log n)
 * in all the first time, some 0.5 us a leaf. [any] */
int eng_body_tree_prepare(struct eng_mesh *mesh, bool (*should_stop)(void *owner),
                          void *owner);

/* Return the tree, which is there. [any] */
const struct eng_body_tree *eng_body_tree_of(const struct eng_mesh *mesh);

/* The boxes of an object in a step: its mesh's own, if it turns, or stands where it was
 * registered; else a fit. Zeros: there are none yet. */
struct eng_body {
    const struct eng_mesh *mesh;
    const double (*x[2])[3]; /* its vertices in the frame of its link: at both ends the
                              * registered ones; or in the world, at both ends */
    const struct eng_body_boxes *boxes[2]; /* at either end; the same if they are equal */
    double origin[3];
    struct eng_path_box box;    /* around all, at both ends */
    struct eng_body_boxes *fit; /* what it has made itself; NULL: nothing */
    uint32_t fit_capacity;      /* in nodes: of both ends, and of corners */
    eng_f4 *corners[2];         /* of a fit: x from the origin, rounded */
    bool lacks_lowest; /* a fit at two ends has no boxes of nodes with leaves alone */
    /* Set by the caller: whether a fit may lack these, which take most of its time. */
    bool may_lack_lowest;
    /* Set by the caller: asked every 0.2 ms or so of a fit; NULL: never. */
    bool (*should_stop)(void *owner);
    void *owner;
};

/* Take the registered positions: those of a body that turns. The mesh has its tree. */
void eng_body_set(struct eng_body *body, const struct eng_mesh *mesh);

/* Take positions in the world, x0 == x1 if it stands, which must stay while the body is
 * used; `bounds`: of its leaves, at both ends. The mesh has its tree. PCCD_E_NOMEM;
 * PCCD_E_AGAIN: it was stopped, and has no boxes. O(leaves). [any] */
int eng_body_fit(struct eng_body *body, const struct eng_mesh *mesh,
                 const double (*x0)[3], const double (*x1)[3],
                 const struct eng_bounds *bounds);

/* Make boxes of a node that a fit lacks. */
void eng_body_bound_lowest(const struct eng_body *body, int end, uint32_t node,
                           struct eng_body_boxes *boxes);

/* Take positions in the world as eng_body_fit does, but without boxes: for what goes by
 * the boxes of the mesh, where poses take it (straight.h). */
void eng_body_put(struct eng_body *body, const struct eng_mesh *mesh,
                  const double (*x0)[3], const double (*x1)[3],
                  const struct eng_bounds *bounds);

/* Divide work on two trees into at most `most` >= 1 tasks; the first, 0, is all of it.
 * `part` writes what a task divides into, at most four, and returns how many: itself
 * alone, if it cannot be divided. Returns how many tasks there are. */
uint32_t eng_body_split(uint32_t most, uint64_t *tasks,
                        uint32_t (*part)(void *owner, uint64_t task, uint64_t parts[4]),
                        void *owner);

void eng_body_deinit(struct eng_body *body);
uint64_t eng_body_bytes(const struct eng_body *body);

#endif

/* kernel.h - the inner loops of the engine, one version for every instruction set.
 *
 * Every file of this folder but choose.c is compiled once for each instruction set, with
 * its flags and with ENG_ISA and ENG_VECTOR_BYTES set (local.mk). lanes.h hides how wide
 * a vector is. Lanes are independent and perform the same operations in the same order
 * at every width, each rounded once, none contracted: so the set called `scalar`, one
 * lane wide, is the reference that the others equal bit for bit.
 */
#ifndef ENG_KERNEL_H
#define ENG_KERNEL_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "box_frame.h"
#include "boxes.h"
#include "isa.h"
#include "kinds.h"
#include "query.h"
#include "sort.h"

/* One vertex at both ends of the step, one cache line. The words are free for the owner;
 * kernels do not look at them. */
struct eng_point {
    _Alignas(64) double x0[3];
    uint64_t word0;
    double x1[3];
    uint64_t word1;
};

/* ---- the sieve ------------------------------------------------------------------- */

/* Marks are points rounded to a grid of whole numbers, by which most pairs are rejected
 * before doubles are read. They take half the bytes of the points themselves, so a vector
 * holds twice as many. Differences of whole numbers are exact, so what the sieve may
 * reject depends on the size of a pair and not on its distance from the origin. */

/* The number of a coordinate is the whole one that is nearest to (x - origin) scale: of
 * |x - origin| scale <= ENG_GRID_REACH. Differences of two numbers, and 8 more, fit. */
struct eng_grid {
    double origin[3];
    double scale; /* a power of two */
};

#define ENG_GRID_REACH (0x1p30 - 8)

/* A point at both ends of the step. How near another feature is to it there, at most, as
 * is known by now: so much is to be taken from the reach of sift_near, both being bits of
 * floats; 0: nothing is known. Any thread may write one while others read it. */
struct eng_mark {
    _Alignas(32) int32_t q0[3];
    _Atomic int32_t less0;
    int32_t q1[3];
    _Atomic int32_t less1;
};

/* Pairs are named by a number of each feature; VF: the vertex's is its point, a_corner is
 * not looked at. EE: b_corner[2] is not. */
struct eng_sieve {
    const struct eng_mark *marks;
    const uint32_t *a_corner[2];
    const uint32_t *b_corner[3];
    float t_end;      /* <= 1: pairs that certainly do not meet up to then go, too */
    bool swept;       /* the boxes around the pairs' whole motions overlap, no more */
    bool in_time;     /* the pairs share a time on all axes: eng_join.in_time */
    bool cubic_first; /* which of two tests goes first; the sieve's own, false before */
    bool prunes;      /* sift_near: what is known of a pair's points counts, that of which
                       * least is */
    uint32_t end;     /* sift_near: of the step, 0 or 1 */
};

/* Places behind the last pair that the sieve may write to. */
#define ENG_SIEVE_SPARE 16u

/* ---- a chunk, and what kernels say of it ------------------------------------------ */

/* The pairs of a chunk, of one kind: points[quads[i][0 .. 3]] are those of pair i, in the
 * order of query.h. A kind of fewer points has the last one repeated. */
struct eng_quads {
    uint32_t kind; /* enum pccd_kind */
    const struct eng_point *points;
    const uint32_t (*quads)[4];
};

/* The decisions of the certified solver about a chunk. */
struct eng_bracketed {
    uint32_t hit_count;
    uint32_t unsure_count;
    uint32_t *index;      /* of the pairs with a contact, in no order */
    struct eng_hit *hits; /* proved, not initial */
    uint32_t *unsure;     /* pairs that are not decided */
};

/* The answer of `measure` about a chunk; each array has room for all its pairs. Pairs
 * that are not named are farther apart than d. */
struct eng_measured {
    enum eng_distance_wanted wanted;
    uint32_t near_count;
    uint32_t imprecise_count;
    uint32_t undecided_count;
    uint32_t *index;            /* of pairs within d, in their order */
    struct eng_distance *found; /* of these, what is wanted */
    uint32_t *imprecise;        /* within d, but some number is not known */
    uint32_t *undecided;        /* nobody knows whether they are within d */
};

/* The answer of `cross_faces` about a chunk. Edges that are not named do not pass
 * through. */
struct eng_crossed {
    uint32_t count;
    uint32_t undecided_count;
    uint32_t *index;     /* of those that do, in no order */
    uint32_t *undecided; /* nobody knows of these */
};

/* The answer of `advance` about a pair of thick features (elementary/thick.h). */
enum eng_advanced {
    ENG_ADVANCE_UNDECIDED, /* there is no contact before `until` */
    ENG_ADVANCE_MISSES,    /* no contact, or none that begins before or at t_end */
    ENG_ADVANCE_INITIALLY, /* d(0) <= r, and no approach is asked for */
    ENG_ADVANCE_MEETS      /* in `cell` */
};

struct eng_advance {
    double until;      /* 0 at first; before that time the pair is farther apart than r */
    double lo, hi;     /* before: lo is r, rounded. Then the kernel's own */
    double looked;     /* its own, too */
    double cell;       /* its number (thick_exact.h) */
    uint8_t now;       /* enum eng_advanced */
    uint8_t is_inside; /* d(0) <= r; 0 at first */
};

struct eng_advance_limits {
    double approach; /* thick.h */
    double t_end;
    int depth; /* of cells */
};

#define ENG_ADVANCE_MAX 1024u

/* Where blocks in whole numbers go, the boxes around them, and how far one grows. */
struct eng_quantised_to {
    struct eng_quantised_block *blocks;
    struct eng_quantised_box *around;
    uint32_t *farthest;
};

/* ---- the kernels ----------------------------------------------------------------- */

struct eng_kernels {
    enum eng_isa isa;
    const char *name; /* as in PCCD_CPU */

    /* Return whether each of the `count` values is within +-`limit`. NaN is not. */
    bool (*all_within)(const double *x, size_t count, double limit);
    /* Write floats to `out` as doubles. Return whether they are within +-`limit`, too. */
    bool (*widen_within)(double *out, const float *x, size_t count, double limit);

    /* Widen the bounds so that they hold x[count]. */
    void (*bound_positions)(const double (*x)[3], size_t count,
                            struct eng_bounds *bounds);

    /* Make the box of each point in a frame, rounded outward; `swept`: at both ends the
     * one around both. |x| <= 1e18. `frame` NULL, here and below: the coordinates as they
     * are. */
    void (*box_points)(const struct eng_point *points, uint32_t count,
                       const struct eng_box_frame *frame, bool swept,
                       struct eng_extents *boxes);
    /* Make the marks of points, on a grid that lies in the frame. False: one was beyond
     * the grid; then no sieve may use them. */
    bool (*place_points)(const struct eng_point *points, uint32_t count,
                         const struct eng_box_frame *frame, const struct eng_grid *grid,
                         struct eng_mark *marks);
    /* Make blocks of boxes[block_count][ENG_WIDE], and the box around each block;
     * `swept`: the boxes are the same at both ends, and the rows at t = 1 are left as
     * they are. */
    void (*box_fold)(const struct eng_extents *boxes, uint32_t block_count, bool swept,
                     struct eng_wide_block *blocks, struct eng_extents *around);
    /* Make the same of features, each the union of points[corner[0 .. 2][feature]];
     * corner[2] NULL: of two. */
    void (*box_unite)(const struct eng_extents *points, const uint32_t *const corner[3],
                      uint32_t block_count, bool swept, struct eng_wide_block *blocks,
                      struct eng_extents *around);

    /* Make blocks, and the boxes around them, in whole numbers; *to->farthest is raised
     * to the most that one grows by from t = 0 to t = 1. False: one of them is beyond
     * what the numbers hold; then none may be used. */
    bool (*quantised_blocks)(const struct eng_wide_block *blocks,
                             const struct eng_extents *around, uint32_t count,
                             const struct eng_quantising *quantising,
                             const struct eng_quantised_to *to);
    /* Make features in whole numbers, each the union of v = corner[0 .. 2][feature], in
     * lanes v % ENG_WIDE of points[v / ENG_WIDE], and the boxes around them; corner[2]
     * NULL: of two. The larger number is of the larger float: rounding keeps order. */
    void (*quantised_unite)(const struct eng_quantised_block *points,
                            const uint32_t *const corner[3], uint32_t count,
                            struct eng_quantised_block *quantised,
                            struct eng_quantised_box *quantised_around);

    /* Return a bit for each of 64 items that comes before the pivot along `axis`, 0, 1
     * or 2: it is less there, or as far and its id is less. No coordinate is NaN. */
    eng_come_before_fn *come_before;

    /* Set square[..] to the squares of the distances of sixteen boxes at one end, rows
     * low[axis] and high[axis] of a block, from one box, box[0] below and box[1] above;
     * up to 2^-21 of themselves more. Return a bit for each that is less than `limit`. No
     * box is at INFINITY. */
    uint32_t (*box_gaps)(const float (*low)[ENG_WIDE], const float (*high)[ENG_WIDE],
                         const float box[2][4], float limit, float square[ENG_WIDE]);

    /* Write the pairs that the boxes of blocks of job->a and of job->b make, which may
     * meet in the step: of the round's pairs of blocks, as many as there is room for in
     * out_a[room] and out_b[room]; returns how many. Call it again, with room for
     * ENG_WIDE or more, until eng_join_has_ended. A block with itself makes no pair twice
     * or turned round. Nodes: self-pairs too, unless there is no box; features: none, and
     * none that share a vertex. */
    uint32_t (*join_nodes)(struct eng_join *job, struct eng_join_round *round,
                           uint32_t *out_a, uint32_t *out_b, uint32_t room);
    /* Write the same of the features of a kind: of contacts, or EF. */
    uint32_t (*join_features[COMMON_KIND_COUNT])(struct eng_join *job,
                                                 struct eng_join_round *round,
                                                 uint32_t *out_a, uint32_t *out_b,
                                                 uint32_t room);

    /* Elementary tests of the chunk's pairs. `reject_axes` knows every kind; sift, filter
     * and bracket know those with has_kernels in eng_solvers: VF and EE, which the cubic
     * of query.h decides. */

    /* Move the pairs a[count + ENG_SIEVE_SPARE], b[..] that neither axes and time nor the
     * cubic nor face diagonals reject, from their marks, to the front in the same order;
     * returns how many. */
    uint32_t (*sift)(enum pccd_kind kind, struct eng_sieve *sieve, uint32_t *a,
                     uint32_t *b, uint32_t count);

    /* Write the pairs 0 .. count-1 that no axis separates over the whole step to
     * kept[count]; returns how many. */
    uint32_t (*reject_axes)(struct eng_quads chunk, uint32_t count, uint32_t *kept);
    /* Write the same by face diagonals and by the cubic, of the pairs pairs[count]; kept
     * may be `pairs`. */
    uint32_t (*filter)(struct eng_quads chunk, const uint32_t *pairs, uint32_t count,
                       uint32_t *kept);
    /* Decide pairs[count], which is changed: append the contacts that begin before or at
     * t_end and what is unsure to `out`, whose arrays have room for `count` more; the
     * rest are misses. */
    void (*bracket)(struct eng_quads chunk, uint32_t *pairs, uint32_t count,
                    double tolerance, double t_end, struct eng_bracketed *out);

    /* Distances of pairs at one end of the step, 0 or 1: VF and EE. */

    /* Sift pairs of marks as `sift`: those stay that are not certainly farther apart than
     * `reach`, in cells of the grid, 0 .. 2^31; of PCCD_EF, those whose edge is not
     * certainly on one side of the plane of the face. */
    uint32_t (*sift_near)(uint32_t kind, const struct eng_sieve *sieve, float reach,
                          uint32_t *a, uint32_t *b, uint32_t count);

    /* Write the pairs 0 .. count-1 that are not certainly farther apart than d, by their
     * boxes and by the planes across both, to kept[count]; returns how many. */
    uint32_t (*reject_at_end)(struct eng_quads chunk, uint32_t count, uint32_t end,
                              double d, uint32_t *kept);
    /* Compare pairs[count] with d, and append to `out`. What is said is what distance.h
     * would say. */
    void (*measure)(struct eng_quads chunk, const uint32_t *pairs, uint32_t count,
                    uint32_t end, double d, struct eng_measured *out);
    /* Write the pairs 0 .. count-1 of thick features that are not certainly farther apart
     * than reach[..], all over the step, to kept[count]; returns how many. reach: 0 or
     * more, and not below the pair's r. */
    uint32_t (*reject_thick)(struct eng_quads chunk, uint32_t count, const double *reach,
                             uint32_t *kept);

    /* Sift pairs of marks as `sift`: those of VF and EE stay that are not certainly
     * farther apart than `reach`, in cells of the grid, all over the step. What goes,
     * `reject_thick` would reject with any reach that is not more. */
    uint32_t (*sift_thick)(enum pccd_kind kind, struct eng_sieve *sieve, float reach,
                           uint32_t *a, uint32_t *b, uint32_t count);

    /* Tell what becomes of pairs[count], at most ENG_ADVANCE_MAX, of VF, EE, VE or VV, in
     * advance[count], where `lo` and what its comment asks for are set by the caller.
     * What is said of a pair does not depend on the others. */
    void (*advance)(struct eng_quads chunk, const uint32_t *pairs, uint32_t count,
                    const struct eng_advance_limits *limits, struct eng_advance *advance);
    /* Set param and normal of contacts of these kinds, at their toi: hits[i] is of
     * pairs[i]. */
    void (*describe)(struct eng_quads chunk, const uint32_t *pairs, uint32_t count,
                     struct eng_hit *hits);

    /* Append to `out` which edges pass through which faces, indices as the points of
     * eng_distance_crosses. */
    void (*cross_faces)(const struct eng_point *points, const uint32_t (*pairs)[5],
                        uint32_t count, uint32_t end, struct eng_crossed *out);
};

/* ---- one pair, by the scalar set alone --------------------------------------------- */

/* Return whether one feature is above the other, certainly, along x, y or z, or along x
 * +- y, y +- z or z +- x, at both ends of the step, and so all the time. Most queries go
 * here. */
bool eng_query_separates(const struct eng_query *query);

/* The answer of `bracket` about one pair, which is a chunk of its own. */
enum eng_decision { ENG_MISSES, ENG_MEETS, ENG_UNDECIDED };

/* Decide one pair as `bracket` of the scalar set does, bit for bit, in half the time.
 * ENG_MEETS: *hit is set; a contact that begins after t_end is a miss. */
enum eng_decision eng_decide(const struct eng_query *query, double tolerance,
                             double t_end, struct eng_hit *hit);

#endif

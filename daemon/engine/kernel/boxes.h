/* boxes.h - moving boxes stored sixteen at a time, a row for each bound, ready for vector
 * instructions.
 *
 * A bound is stored as its distance outward: minus the lower bound, plus the upper. So a
 * union is a maximum everywhere. Two boxes are apart along an axis, one below the other,
 * where -lower(a) + upper(b) < 0. The sign of such a sum is exact, however it was
 * rounded.
 */
#ifndef ENG_BOXES_H
#define ENG_BOXES_H

#include <stdbool.h>
#include <stdint.h>

/* Boxes of a block, for every instruction set: 2^ENG_WIDE_BITS. */
#define ENG_WIDE      16u
#define ENG_WIDE_BITS 4u

/* The sides of a moving box. */
enum eng_side { ENG_LOW0, ENG_LOW1, ENG_HIGH0, ENG_HIGH1, ENG_SIDES };

/* Outward distances of no box: |x| <= 1e18 < 2^60. It meets none, itself included, and is
 * neutral to unions. */
#define ENG_NOWHERE (-0x1p100f)

/* One box: [side][axis], the fourth of each side is not looked at. A cache line. */
struct eng_extents {
    _Alignas(64) float side[ENG_SIDES][4];
};

/* Sixteen boxes: [side][axis][lane]. */
struct eng_wide_block {
    _Alignas(64) float row[ENG_SIDES][3][ENG_WIDE];
};

/* Boxes in whole numbers of 16 bits, two to a lane: [end][axis][lane], each an outward
 * distance below (bits 0 .. 15) and one above (bits 16 .. 31), in cells of a grid. Larger
 * than the boxes by a cell or so, and compared by half as many operations. */
struct eng_quantised_block {
    _Alignas(64) uint32_t row[2][3][ENG_WIDE];
};

/* One of them: [end][2 axis]: above, [end][2 axis + 1]: below; the last two are 0. */
struct eng_quantised_box {
    _Alignas(32) int16_t half[2][8];
};

/* From the distances in a float box to cells: x scale[axis] + below or above[axis]. The
 * two, which are the origin and its opposite, add up to ENG_QUANTISED_ROUND or more. */
struct eng_quantising {
    float scale[4]; /* powers of two; the fourth of all is 0 */
    float below[4];
    float above[4];
};

/* Makes up for what two conversions are off by (make_quantised.c). */
#define ENG_QUANTISED_ROUND 0x1.08p0f

/* The most cells that a bound may be away from the origin: so that the numbers of no box,
 * INT16_MIN, meet none, with what quantised.h adds. */
#define ENG_QUANTISED_REACH 32700

/* ---- joins: the overlapping pairs between blocks --------------------------------- */

/* Parameters and results of that inner loop. Many pairs of blocks are joined in one loop
 * over all of them. So each pair costs as few mispredicted branches as a single one: the
 * end of its loop.
 *
 * Threads: one thread for one round; the blocks are only read. */

/* The ways to compare two boxes. */
enum eng_join_boxes {
    ENG_JOIN_MOVING, /* can each axis bring them together before or at t_end? */
    ENG_JOIN_NEAR,   /* does what they cover up to t_end, which is near, overlap? Weaker,
                      * and half the work. */
    ENG_JOIN_SWEPT,  /* do they overlap? Both ends are the same. */
    ENG_JOIN_AT      /* are they within a distance along each axis, at one end? */
};

/* Two lists of blocks whose boxes are tested against each other; one list where a and b
 * are the same, which faces do not ask for. Pairs of boxes are named by ENG_WIDE times
 * the block plus the lane. */
struct eng_join {
    const struct eng_wide_block *a;
    const struct eng_wide_block *b;
    const struct eng_extents *b_boxes; /* around each block of b */
    /* The same in whole numbers, which are compared then; or NULL: of swept boxes. */
    const struct eng_quantised_block *a_quantised;
    const struct eng_quantised_block *b_quantised;
    const struct eng_quantised_box *b_quantised_boxes;
    /* Of features: three (faces) or two (edges) arrays of the vertices of each; vertices
     * stand for themselves: NULL. Pairs that share one are left out. */
    const uint32_t *a_corner[3];
    const uint32_t *b_corner[3];
    /* Masks, by block: bit k is set if the box in lane k moves. Pairs of boxes of which
     * neither does are left out. NULL: none are; so for ENG_JOIN_SWEPT. */
    const uint16_t *a_moving;
    const uint16_t *b_moving;
    /* Bit k is set if something in the box in lane k is not foreign (mesh.h). Where
     * features of b are first in no pair there is no b_own. */
    const uint16_t *a_own;
    const uint16_t *b_own;
    /* Of features, where both have it: keys[key_stride * slot]. Of two the one with the
     * lower key comes first; if it is foreign they are left out. NULL: as boxes. */
    const uint64_t *keys;
    uint32_t key_stride;
    enum eng_join_boxes boxes;
    uint32_t farthest;      /* the most that a whole number grows by (quantised_blocks) */
    float t_end;            /* 0 .. 1; swept boxes: not looked at */
    uint32_t end;           /* ENG_JOIN_AT: 0 or 1, .. */
    float growth;           /* .. and the distance: 0 .. 2^80, .. */
    int32_t cells[3];       /* .. in whole numbers, rounded up: 0 .. 2^17 */
    bool in_time;           /* of moving boxes, those that no time brings together on all
                             * axes are left out, too */
    uint64_t tests;         /* counts: one box against a block */
    uint64_t apart_in_time; /* counts: pairs left out for in_time */
    uint64_t still;         /* counts: pairs left out as neither moves; a box that has
                             * none but such with a block is one */
};

/* Pairs that the boxes of two blocks make at most. */
#define ENG_JOIN_MAX (ENG_WIDE * ENG_WIDE)

/* Pairs of blocks in a round: of two nodes that have little to do with each other all. */
#define ENG_JOIN_ROUND 64u
#define ENG_JOIN_TESTS (ENG_JOIN_ROUND * ENG_WIDE)

/* Boxes up to a time that is near, as if they stood still: lows, then highs. */
struct eng_near_block {
    _Alignas(64) float row[2][3][ENG_WIDE];
};

/* A block as it is compared, if that is not as it lies there. */
union eng_join_ready {
    struct eng_near_block near;
    struct eng_quantised_block quantised;
};

union eng_join_around {
    struct eng_extents box;
    struct eng_quantised_box quantised;
};

/* Pairs of blocks that wait, and what those before them have found. */
struct eng_join_round {
    const uint32_t *a; /* all in one run of ENG_WIDE that begins at a multiple of it */
    const uint32_t *b; /* the same */
    uint32_t count;    /* the last ones are taken first: plain swept pairs of dense scenes
                        * take 3 ms of 25 less so than from the beginning on */
    uint32_t next;     /* of the boxes below, not yet written */
    uint32_t end;
    uint32_t first_a; /* of the runs that they are in */
    uint32_t first_b;
    /* Scratch: boxes that meet blocks, and the lanes of those. ENG_WIDE places behind the
     * last one are written, not read. */
    uint32_t place[ENG_JOIN_TESTS + ENG_WIDE];
    uint32_t box[ENG_JOIN_TESTS + ENG_WIDE]; /* block of b << 8 | slot of a, in a run */
    uint32_t lanes[ENG_JOIN_TESTS + ENG_WIDE];
    union eng_join_ready ready_a[ENG_WIDE];
    union eng_join_ready ready_b[ENG_WIDE];
    union eng_join_around ready_around[ENG_WIDE];
};

/* Begin a round with `count` pairs a[i], b[i], which stay where they are until they have
 * been joined. */
static inline void eng_join_begin(struct eng_join_round *round, const uint32_t *a,
                                  const uint32_t *b, uint32_t count)
{
    round->a = a;
    round->b = b;
    round->count = count;
    round->next = 0;
    round->end = 0;
}

static inline bool eng_join_has_ended(const struct eng_join_round *round)
{
    return round->count == 0 && round->next == round->end;
}

#endif

/* parts.h - the parts of a step that `roofline` compares with the limits of the machine.
 *
 * Threads: any.
 */
#ifndef BENCH_PARTS_H
#define BENCH_PARTS_H

#include "floor.h"
#include "kernel.h"

enum part {
    PART_POINTS, /* a vertex: its box */
    PART_MARKS,  /* a vertex: its mark on the grid */
    PART_EDGES,  /* an edge: its box, from two vertices, and the block's */
    PART_FACES,
    PART_FOLD,    /* a vertex: its box to the block */
    PART_JOIN,    /* a box against a block of 16 */
    PART_SIFT_VF, /* a candidate that no axis separates */
    PART_SIFT_EE,
    PART_APART_VF, /* a candidate */
    PART_APART_EE,
    PART_FILTER_VF, /* the same */
    PART_FILTER_EE,
    PART_BRACKET_VF, /* a candidate that the sieve leaves */
    PART_BRACKET_EE,
    PART_TESTS_VF, /* a candidate: sieve, its axes first; solver */
    PART_TESTS_EE,
    PART_WITHIN, /* a double */
    PART_WIDEN,  /* a float, to a double */
    PART_COUNT
};

const char *bench_part_name(enum part part);

/* Of a part's item. Bytes: what has to come from or go to where it is kept, once: a point
 * and its box are 64, its mark is 32, a box in a block is 48, a pair has 16 of indices; a
 * vertex has some 3 edges and 2 faces. Operations: those that the comments name, by all
 * lanes at a time; loads, turning points round and what is done once a group are not
 * among them. */
struct bench_cost bench_part_cost(enum part part, enum eng_isa isa);

/* Of the axes of a pair of marks, which the sieve looks at first where boxes around whole
 * motions are all that is known. */
struct bench_cost bench_axes_cost(enum eng_isa isa);

#endif

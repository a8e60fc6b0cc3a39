/* floor.h - the speed limits of this machine, and the parts of a step beside them.
 *
 * Threads: one.
 */
#ifndef BENCH_FLOOR_H
#define BENCH_FLOOR_H

#include <stddef.h>

#include "kernel.h"

/* Of one item. */
struct bench_cost {
    double bytes;      /* read and written, each once */
    double operations; /* vector instructions; loads, stores and addresses not counted */
};

/* Cycles a nanosecond: a chain of multiplications of integers, three cycles each on x86
 * processors since 2011 and on 64-bit Arm. The fastest of several. */
double bench_clock_ghz(void);

/* Bytes a nanosecond, read and written together, of memcpy from one half of so many bytes
 * to the other: whatever cache they fit. The fastest of several. */
double bench_copy_gbps(size_t bytes);

/* The same of memchr, which only reads. */
double bench_read_gbps(size_t bytes);

/* Two operations a cycle, or the bytes at a speed: whatever is longer. */
double bench_floor_ns(struct bench_cost cost, double ghz, double gbps);

/* ---- The parts of a step that `roofline` compares with the limits of the machine. */

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

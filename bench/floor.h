/* floor.h - the speed limits of this machine, for comparison with measured times.
 *
 * Threads: one.
 */
#ifndef BENCH_FLOOR_H
#define BENCH_FLOOR_H

#include <stddef.h>

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

#endif

/* bareend.h - measures how long it takes at least until a client notices that a process
 * was killed, and another one answers.
 *
 * Measure the cost of a kill without pccd: a process of one thread that has touched 16
 * MiB, and holds one end of a socketpair for each watching process, is killed with -9,
 * and the watchers see the end of file. In a second form each watcher then connects to a
 * standby process of one thread, sends it one message, and gets one back: the least that
 * a reconnection takes.
 *
 * Threads: one a process; times are handed over in shared memory.
 */
#ifndef BENCH_BAREEND_H
#define BENCH_BAREEND_H

#include <stdbool.h>
#include <stdint.h>

#define BAREEND_WATCHERS_MAX 4096u

/* Do it once. us[watchers]: microseconds from the kill to each one's end of file, or with
 * `asks` to its answer. False: processes or descriptors could not be had. */
bool bareend_turn(unsigned watchers, bool asks, uint64_t *us);

#endif

/* bareend.h - how long until the end of a bare process is seen, and another answers.
 *
 * Room:     bench. May include: the C library.
 * Does:     what killing a daemon costs the machine at least: a process of one thread
 *           that has touched 16 MiB and holds one end of a socketpair for each of those
 *           who watch, a process each, is killed with -9, and they see the end of file.
 *           Or they go on: each connects to a process of one thread that has stood by,
 *           sends it one message, and gets one back: what coming back takes at least.
 * Threads:  one a process; times are handed over in shared memory.
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

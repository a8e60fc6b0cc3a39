/* fuzz_jobs.h - one random search in several processes. */
#ifndef FUZZ_JOBS_H
#define FUZZ_JOBS_H

#include <stdbool.h>
#include <stdint.h>

#define FUZZ_JOBS_MAX 64

/* Work of one process: returns 0 if nothing is wrong. `job`: 0 .. the number of jobs -
 * 1. */
typedef int (*fuzz_work_fn)(uint64_t seed, uint64_t count, long job);

/* Return whether a process that ended with this status of wait() counts as failed. Print
 * by which signal, if by one. */
bool fuzz_jobs_failed(int status);

/* Process `job` works on seed + job. Waits for all; 0 if nothing is wrong in any. */
int fuzz_jobs_run(fuzz_work_fn work, uint64_t seed, uint64_t count, long jobs);

#endif

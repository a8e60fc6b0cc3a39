/* fuzz_jobs.h - one random search in several processes. */
#ifndef FUZZ_JOBS_H
#define FUZZ_JOBS_H

#include <stdbool.h>
#include <stdint.h>

#define FUZZ_JOBS_MAX 64

/* Work of one process: returns 0 if nothing is wrong. `job`: 0 .. the number of jobs -
 * 1. */
typedef int (*fuzz_work_fn)(uint64_t seed, uint64_t count, long job);

/* The options that all searches have. */
struct fuzz_jobs {
    uint64_t seed;  /* --seed; else prng_seed() */
    uint64_t count; /* --cases, or --queries; else 100 000 */
    long jobs;      /* --jobs 1 .. FUZZ_JOBS_MAX, processes; else 1 */
};

struct fuzz_jobs fuzz_jobs_begin(void);

/* Take argv[*i], and the value behind it, if it is one of these. */
bool fuzz_jobs_take(struct fuzz_jobs *jobs, int argc, char **argv, int *i);

/* Return whether the number of processes is one that may be. */
bool fuzz_jobs_are_right(const struct fuzz_jobs *jobs);

/* Process `job` works on seed + job. Waits for all, and prints by which signal one ended;
 * 0 if nothing is wrong in any. */
int fuzz_jobs_run(fuzz_work_fn work, const struct fuzz_jobs *jobs);

#endif

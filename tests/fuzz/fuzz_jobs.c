/* fuzz_jobs.c - one random search in several processes. */
#include "fuzz_jobs.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

#include "prng.h"

struct fuzz_jobs fuzz_jobs_begin(void)
{
    return (struct fuzz_jobs){.seed = prng_seed(), .count = 100000, .jobs = 1};
}

bool fuzz_jobs_take(struct fuzz_jobs *jobs, int argc, char **argv, int *i)
{
    const char *name = argv[*i];
    if (*i + 1 >= argc) {
        return false;
    }
    const char *value = argv[*i + 1];
    if (strcmp(name, "--cases") == 0 || strcmp(name, "--queries") == 0) {
        jobs->count = (uint64_t)strtod(value, NULL);
    } else if (strcmp(name, "--seed") == 0) {
        jobs->seed = strtoull(value, NULL, 0);
    } else if (strcmp(name, "--jobs") == 0) {
        jobs->jobs = strtol(value, NULL, 10);
    } else {
        return false;
    }
    ++*i;
    return true;
}

bool fuzz_jobs_are_right(const struct fuzz_jobs *jobs)
{
    return jobs->jobs >= 1 && jobs->jobs <= FUZZ_JOBS_MAX;
}

static bool has_failed(int status)
{
    if (WIFSIGNALED(status)) {
        printf("a process was ended by a signal: %s\n", strsignal(WTERMSIG(status)));
        fflush(stdout);
    }
    return status != 0;
}

int fuzz_jobs_run(fuzz_work_fn work, const struct fuzz_jobs *jobs)
{
    uint64_t each = (jobs->count + (uint64_t)jobs->jobs - 1) / (uint64_t)jobs->jobs;
    int failed = 0;
    long started = 0;
    fflush(stdout); /* else each process would print it again */
    for (; started < jobs->jobs; started++) {
        pid_t pid = fork();
        if (pid < 0) {
            perror("fork");
            failed = 1;
            break;
        }
        if (pid == 0) {
            _exit(work(jobs->seed + (uint64_t)started, each, started));
        }
    }
    for (; started > 0; started--) {
        int status;
        failed |= wait(&status) < 0 || has_failed(status);
    }
    return failed;
}

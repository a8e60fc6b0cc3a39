/* fuzz_jobs.c - one random search in several processes. */
#include "fuzz_jobs.h"

#include <stdio.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

bool fuzz_jobs_failed(int status)
{
    if (WIFSIGNALED(status)) {
        printf("a process was ended by a signal: %s\n", strsignal(WTERMSIG(status)));
        fflush(stdout);
    }
    return status != 0;
}

int fuzz_jobs_run(fuzz_work_fn work, uint64_t seed, uint64_t count, long jobs)
{
    uint64_t each = (count + (uint64_t)jobs - 1) / (uint64_t)jobs;
    int failed = 0;
    long started = 0;
    fflush(stdout); /* else each process would print it again */
    for (; started < jobs; started++) {
        pid_t pid = fork();
        if (pid < 0) {
            perror("fork");
            failed = 1;
            break;
        }
        if (pid == 0) {
            _exit(work(seed + (uint64_t)started, each, started));
        }
    }
    for (; started > 0; started--) {
        int status;
        failed |= wait(&status) < 0 || fuzz_jobs_failed(status);
    }
    return failed;
}

/* rest.c - what ranks are preloaded with that share processors: who waits sleeps.
 *
 * Open MPI 4 asks for messages in a loop, with sched_yield() at most in between: ranks
 * that wait keep each other, and whatever runs beside them, from the processors. */
#include <sched.h>
#include <time.h>

#define REST_NS 20000

__attribute__((visibility("default"))) int sched_yield(void)
{
    const struct timespec rest = {.tv_nsec = REST_NS};
    (void)nanosleep(&rest, NULL);
    return 0;
}

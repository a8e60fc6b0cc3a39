/* openmp.h - the environment variables that OpenMP's runtime must find in a daemon.
 *
 * Name the variables. The runtime reads them before main, so the program that starts a
 * daemon sets them; a daemon that finds others executes itself again with the right ones.
 */
#ifndef COMMON_OPENMP_H
#define COMMON_OPENMP_H

#include <stddef.h>

/* Waiting threads look so many times, then sleep: more burns a processor and collapses
 * when another process is busy, none costs the speed-up. What the user has set stays. */
#define COMMON_OPENMP_SPIN_NAME  "GOMP_SPINCOUNT"
#define COMMON_OPENMP_SPIN_VALUE "2000"

/* Binding by the runtime would pin the thread that talks to clients, too. */
static const char *const common_openmp_unwanted[] = {"OMP_PROC_BIND", "OMP_PLACES"};

#define COMMON_OPENMP_UNWANTED                                                           \
    (sizeof common_openmp_unwanted / sizeof common_openmp_unwanted[0])

#endif

/* machine.h - measures what it costs on this machine when threads meet: locks, wake-ups,
 * barriers.
 *
 * Measure deque, lock, wake-up, sleep, barrier, start of a region and shared cache lines
 * with at most two threads at a time, each on a processor of its own; give medians.
 *
 * Threads: starts and ends its own.
 *
 * All in nanoseconds. With one processor the costs between two are those of one.
 */
#ifndef MODEL_MACHINE_H
#define MODEL_MACHINE_H

#include <stdio.h>

#include "affinity.h"

/* How long a thread sleeps that finds nobody with a node to spare: about as long as a
 * task unit near the front, after which somebody calls it. */
struct model_machine {
    double clock;
    double local;    /* atomic read-modify-write of a line that is ours */
    double transfer; /* the same of a line that another processor wrote last */
    double push;     /* eng_deque_push; with an atomic counter apart */
    double pop;
    double probe;         /* eng_deque_steal on an empty deque, its lines shared */
    double steal;         /* eng_deque_steal of a task that its owner has just pushed */
    double lock;          /* mutex, lock and unlock, ours */
    double lock_transfer; /* the same after another processor held it */
    double lock_fought;   /* lock and unlock, two threads taking turns without pause */
    double signal;        /* pthread_cond_signal with a sleeper: the caller's time */
    double wake;          /* from that call's begin to the sleeper running */
    double unit;          /* a turn of the paper's main loop besides the task unit */
    double barrier;       /* of an OpenMP team of two that arrive together */
    double relax;         /* eng_relax */
    double spin;          /* how long the runtime spins before it sleeps */
    double region;        /* from the start of a region to the second thread running */
    double futex_each;    /* the waker's time for each sleeper of a common futex */
};

/* Measure all, on the first two of `places`. Takes about a second. */
void model_machine_measure(struct model_machine *machine,
                           const struct eng_affinity *affinity);

/* A turn of the paper's main loop less one of the serial scheduler's. */
double model_loop_ns(void);

/* One line a cost, in CSV: name, nanoseconds. */
void model_machine_print(const struct model_machine *machine, FILE *out);

#endif

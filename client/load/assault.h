/* assault.h - kills clients and the daemon's worker at random moments, to see whether the
 * rest goes on.
 *
 * Threads: one.
 */
#ifndef LOAD_ASSAULT_H
#define LOAD_ASSAULT_H

#include <sys/types.h>

#include "load.h"

struct load_assault {
    struct load *load;
    uint64_t luck;     /* of the next random number */
    uint64_t begin_ns; /* of the load: of a run that takes a set time, kills are spread */
    struct load_victim {
        pid_t pid;       /* 0: none */
        uint64_t end_ns; /* when it is killed */
    } victims[LOAD_VICTIM_MAX];
    uint64_t kills;
    uint64_t strays; /* clients that ended by themselves */
    uint64_t crashes;
    uint64_t crash_ns; /* when the worker is killed next */
    pid_t worker;      /* the last one killed */
};

/* When the load begins. */
void load_assault_begin(struct load_assault *assault, struct load *load);

/* What is due. Returns whether there is something left to kill. */
bool load_assault_turn(struct load_assault *assault);

/* End the victims that are left; they do not count. */
void load_assault_end(struct load_assault *assault);

#endif

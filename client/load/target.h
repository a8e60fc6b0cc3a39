/* target.h - the daemon under load: starts, asks and kills it. */
#ifndef LOAD_TARGET_H
#define LOAD_TARGET_H

#include <stdint.h>
#include <sys/types.h>

#include "load.h"

#define LOAD_HOLDINGS_MAX 16u

struct load_target {
    pid_t supervisor; /* 0: not ours */
    char folder[64];
    char socket[96];
    char log[96]; /* its standard error */
};

/* The things that the daemon holds now: counters of pccd_stats whose names end in "_now",
 * and its descriptors. */
struct load_holdings {
    uint32_t count;
    char name[LOAD_HOLDINGS_MAX][32];
    uint64_t value[LOAD_HOLDINGS_MAX];
};

/* Start settings.daemon, and set load->url. False: why is said. */
bool load_target_start(struct load_target *target, struct load *load);

/* Stop the daemon with SIGTERM, wait, and remove its files; kill it if that takes too
 * long. False: it did not end in order. */
bool load_target_stop(struct load_target *target);

/* Return the process that serves, as a new connection says; 0: nobody does, and why is
 * said. */
pid_t load_target_pid(const struct load *load);

bool load_target_holdings(const struct load *load, struct load_holdings *holdings);

/* Return the descriptors and mappings of a process, and its anonymous memory in KiB; -1:
 * not known. */
int64_t load_target_descriptors(pid_t pid);
int64_t load_target_mappings(pid_t pid);
int64_t load_target_memory(pid_t pid);

/* ---- Kills clients and the daemon's worker at random moments, to see whether the
 * rest goes on. */

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

/* Begin, when the load begins. */
void load_assault_begin(struct load_assault *assault, struct load *load);

/* Do what is due. Returns whether there is something left to kill. */
bool load_assault_turn(struct load_assault *assault);

/* End the victims that are left; they do not count. */
void load_assault_end(struct load_assault *assault);

#endif

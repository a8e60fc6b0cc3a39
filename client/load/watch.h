/* watch.h - detects leaks: measures what a daemon holds over time, and whether that
 * grows.
 *
 * Sample memory, descriptors and mappings once a second; fit a line through the floors of
 * each by least squares. A floor is the least value of a minute: memory above it comes
 * and goes, with sessions that wait for their clients and with free pages that the daemon
 * returns now and then; a leak lifts the floor. Each worker process has a level of its
 * own, because a restarted worker begins elsewhere, and all have one slope. The first
 * seconds of a worker are left out: it takes what it needs then.
 */
#ifndef LOAD_WATCH_H
#define LOAD_WATCH_H

#include <stddef.h>
#include <sys/types.h>

#include "load.h"

/* Fewer floors than these tell nothing. */
#define LOAD_WATCH_FLOORS_MIN 4u

enum load_gauge { LOAD_MEMORY, LOAD_DESCRIPTORS, LOAD_MAPPINGS, LOAD_GAUGES };

struct load_sample {
    double at_s;
    pid_t pid;
    double value[LOAD_GAUGES]; /* memory: anonymous, KiB */
};

struct load_watch {
    uint64_t begin_ns, next_ns;
    struct load_sample *samples;
    size_t count, capacity;
};

struct load_slope {
    size_t count;   /* samples or floors that were used */
    double mean;    /* of the values */
    double per_min; /* slope */
    double error;   /* its standard error, as if they were independent */
};

void load_watch_begin(struct load_watch *watch);
void load_watch_deinit(struct load_watch *watch);

/* Take a sample if one is due. */
void load_watch_turn(struct load_watch *watch, const struct load *load);

/* Return the slope through the floors. */
struct load_slope load_watch_slope(const struct load_watch *watch, enum load_gauge gauge);

/* Find the floors of the samples of each worker, over windows of window_s after its first
 * warm_s: each an entry of floors[count]. One that the worker did not live to the end of
 * does not count. Returns how many there are. */
size_t load_floors_of(const struct load_sample *samples, size_t count, double window_s,
                      double warm_s, struct load_sample *floors);

/* Return the slope of the samples as given. */
struct load_slope load_slope_of(const struct load_sample *samples, size_t count,
                                enum load_gauge gauge, double warm_s);

#endif

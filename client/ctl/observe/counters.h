/* counters.h - the daemon's counters, looked up by name. */
#ifndef CTL_COUNTERS_H
#define CTL_COUNTERS_H

#include <jansson.h>
#include <stdbool.h>
#include <stdint.h>

#include "pccd.h"

#define COUNTERS_MAX 128u

struct counters {
    uint32_t count;
    const char *name[COUNTERS_MAX]; /* the library's, for ever */
    const char *text[COUNTERS_MAX];
    uint64_t value[COUNTERS_MAX];
};

/* Take one more; `context` is the struct counters. */
void counters_take(void *context, const char *name, uint64_t value, const char *text);
/* Read the daemon's counters anew; returns the library's status. */
int counters_read(struct pccd_client *client, struct counters *counters);
/* Return the value of a counter; 0 when there is none of that name. */
uint64_t counters_get(const struct counters *counters, const char *name);
/* Set a member of an object for each counter. */
void counters_add(json_t *object, const struct counters *counters);
/* Return whether a counter tells how something is now; otherwise it is a total that only
 * grows. */
bool counters_is_gauge(const char *name);

/* Return the upper bound of a bucket, in seconds; infinity for the last. */
double histogram_bound_s(uint32_t bucket);
/* Return the upper bound, in seconds, of the first bucket with which at least the share
 * `q` of all is reached; 0 without any. */
double histogram_quantile_s(const struct pccd_histogram_info *histogram, double q);

/* ---- Warnings that follow from a daemon's counters. */

#define HEALTH_MAX        8u
#define HEALTH_TEXT_BYTES 160u

struct health {
    uint32_t count; /* 0: nothing stands out */
    char text[HEALTH_MAX][HEALTH_TEXT_BYTES];
};

void health_judge(const struct counters *counters, struct health *health);

#endif

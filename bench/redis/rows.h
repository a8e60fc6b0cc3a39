/* rows.h - the rows of the comparison with Redis.
 *
 * Threads: one.
 */
#ifndef BENCH_REDIS_ROWS_H
#define BENCH_REDIS_ROWS_H

#include <stdbool.h>

#include "least.h"
#include "pccd.h"
#include "redis.h"

struct rows {
    const struct redis *redis;
    const struct least *least;    /* told beside rows that depend on the machine most */
    struct pccd_client *blocking; /* waits in the kernel */
    struct pccd_client *spinning; /* for 50 us before it does */
    bool smoke;                   /* the least that shows that it works */
};

#define ROWS_VERTICES_MAX 1000000u /* of an update */

/* Rows 1 and 3: one client, one message at a time. */
void rows_trips(const struct rows *rows);

/* Row 2: fifty connections with a ping each in flight. */
void rows_crowd(const struct rows *rows);

/* Rows 4 and 5: positions of many vertices. */
void rows_updates(const struct rows *rows);

/* Row 11: ping while a step computes for a second. */
void rows_busy(const struct rows *rows);

#endif

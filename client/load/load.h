/* load.h - what all processes of a run know.
 *
 * Room:     client/load. May include: tally.h, shape.h.
 * Does:     the settings of a run, and the memory that its processes share.
 * Threads:  processes: constant once the crowd is started, but for what says otherwise.
 */
#ifndef LOAD_LOAD_H
#define LOAD_LOAD_H

#include <stdatomic.h>
#include <stdbool.h>
#include <stdint.h>

#include "shape.h"
#include "tally.h"

#define LOAD_DEPTH_MAX   8u
#define LOAD_PROCESS_MAX 64u
#define LOAD_VICTIM_MAX  64u

/* Which of the two objects has the smaller number, which decides the order of records. Of
 * two that are made anew it may be either. */
#define LOAD_ORDERS 2u

struct load_settings {
    uint64_t seed;
    uint32_t clients;  /* that live as long as the run */
    uint64_t requests; /* of each, at least */
    uint32_t processes;
    uint32_t depth;     /* requests of a client in flight */
    uint32_t think_ms;  /* between two of them, half as long to half again */
    uint32_t minutes;   /* at least; 0: as long as the requests take */
    uint32_t seconds;   /* the same, in addition */
    uint32_t victims;   /* clients at a time that are there to be killed */
    uint64_t kills;     /* of clients */
    uint64_t crashes;   /* kills of the daemon's worker */
    uint32_t pause_ms;  /* between two of these, half as long to half again */
    bool flat;          /* the daemon's memory must not grow */
    const char *daemon; /* program to start; NULL: `url` is the daemon's */
    const char *url;
    char *const *daemon_options; /* NULL-terminated */
};

/* How long the load takes at least. */
static inline double load_settings_ns(const struct load_settings *settings)
{
    return 1e9 * (60.0 * settings->minutes + settings->seconds);
}

/* The answer to one step, as a client that is alone got it. */
struct load_truth {
    uint64_t hash[2];
    uint64_t sum; /* over the records as they lay in shared memory */
};

struct load_shared {
    atomic_uint ready;  /* processes whose clients are connected */
    atomic_bool go;     /* .. may begin */
    atomic_bool enough; /* nothing is left to wait for but the requests */
    atomic_bool failed; /* a process could not do its part */
    struct load_tally crowd[LOAD_PROCESS_MAX];
    struct load_tally victims[LOAD_VICTIM_MAX];
    struct load_truth truth[]; /* [clients + victims][LOAD_ORDERS][LOAD_FRAMES] */
};

struct load {
    struct load_settings settings;
    char url[128]; /* of the daemon */
    struct load_shared *shared;
};

static inline uint64_t load_truth_count(const struct load_settings *settings)
{
    return (uint64_t)(settings->clients + settings->victims) * LOAD_ORDERS * LOAD_FRAMES;
}

static inline struct load_truth *load_truth_of(const struct load *load, uint32_t client,
                                               bool sheet_first, uint32_t frame)
{
    return &load->shared
                ->truth[((uint64_t)client * LOAD_ORDERS + sheet_first) * LOAD_FRAMES +
                        frame];
}

/* CLOCK_MONOTONIC, nanoseconds. */
uint64_t load_now_ns(void);
void load_sleep_ms(uint32_t ms);

/* To stderr, one line. */
void load_say(const char *format, ...) __attribute__((format(printf, 1, 2)));

#endif

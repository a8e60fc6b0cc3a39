/* load.h - the settings of a run of pccd-load, and the memory that its processes share.
 *
 * Threads: processes: constant once the crowd is started, but for what says otherwise.
 */
#ifndef LOAD_LOAD_H
#define LOAD_LOAD_H

#include <stdatomic.h>
#include <stdbool.h>
#include <stdint.h>
#include <string.h>
#include <sys/types.h>
#include <time.h>

#include "clock.h"
#include "shape.h"
#include "tally.h"
#include "whole_file.h"

#define LOAD_DEPTH_MAX   8u
#define LOAD_PROCESS_MAX 1024u
#define LOAD_VICTIM_MAX  64u
#define LOAD_BATCH_MAX   1024u

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
    double hz;          /* of each client, whatever the answers do; 0: the closed loop */
    bool poisson;       /* at random distances */
    double ramp_s;      /* over which the clients join */
    double warm_up_s;   /* after that; until then latencies do not count */
    double deadline_ms; /* of an answer; 0: none */
    double p99_ms;      /* fail when that of the latency is longer; 0: not */
    double stall_share; /* of the requests, after which a client stops reading .. */
    uint32_t stall_ms;  /* .. for so long */
    struct load_sizes sizes;
    enum load_scene scene;
    uint32_t kinds;    /* which, a bit each; clients take them by turns */
    uint32_t batch;    /* scenes of a client of kind batch */
    int mode;          /* enum pccd_mode of all steps; -1: by kind */
    bool near;         /* every second request asks what is near where it leads */
    uint32_t minutes;  /* at least; 0: as long as the requests take */
    uint32_t seconds;  /* the same, in addition */
    uint32_t victims;  /* clients at a time that are there to be killed */
    uint64_t kills;    /* of clients */
    uint64_t crashes;  /* kills of the daemon's worker */
    uint32_t pause_ms; /* between two of these, half as long to half again */
    bool flat;         /* the daemon's memory must not grow */
    bool json;         /* the report is one JSON object */
    const char *csv, *percentiles; /* files to write; NULL: none */
    const char *daemon;            /* program to start; NULL: `url` is the daemon's */
    const char *url;
    char *const *daemon_options; /* NULL-terminated */
};

/* Return how long the load takes at least. */
static inline double load_settings_ns(const struct load_settings *settings)
{
    double timed_s = 60.0 * settings->minutes + settings->seconds;
    return 1e9 * (timed_s + settings->ramp_s + settings->warm_up_s);
}

/* The answer to one step, as a client that is alone got it. */
struct load_truth {
    uint64_t hash[2];
    uint64_t sum; /* over the records as they lay in shared memory */
};

struct load_shared {
    atomic_uint ready;           /* processes whose clients are connected */
    atomic_bool go;              /* .. may begin */
    atomic_ullong go_ns;         /* since when; set before `go` */
    atomic_bool enough;          /* nothing is left to wait for but the requests */
    atomic_bool failed;          /* a process could not do its part */
    atomic_ullong truth_records; /* of a round of every client, alone */
    struct load_tally crowd[LOAD_PROCESS_MAX];
    struct load_tally victims[LOAD_VICTIM_MAX];
    struct load_truth truth[]; /* [clients + victims][LOAD_ORDERS][LOAD_FRAMES] */
};

struct load {
    struct load_settings settings;
    char url[128]; /* of the daemon */
    struct load_shared *shared;
    struct whole_file csv, percentiles; /* of the settings */
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

/* Return the shape of that client; the same in every process. */
static inline struct load_shape load_shape_of(const struct load *load, uint32_t client)
{
    const struct load_settings *settings = &load->settings;
    uint64_t luck = load_mix(settings->seed ^ 0x512e5, client);
    return (struct load_shape){
        .seed = settings->seed,
        .client = client,
        .scene = settings->scene,
        .side = load_sheet_side(load_sizes_draw(&settings->sizes, luck))};
}

/* Return whether there is no daemon: the engine is in each client's own process. */
static inline bool load_is_direct(const struct load *load)
{
    return strncmp(load->url, "direct:", 7) == 0;
}

static inline void load_sleep_ms(uint32_t ms)
{
    struct timespec pause = {ms / 1000, ms % 1000 * 1000000L};
    nanosleep(&pause, NULL);
}

/* Print one line to stderr. */
void load_say(const char *format, ...) __attribute__((format(printf, 1, 2)));

/* ---- The command line of pccd-load. */

/* Exit statuses, those of pccdctl. */
enum load_exit {
    LOAD_DONE = 0,
    LOAD_NEGATIVE = 1, /* something is not as it must be */
    LOAD_USAGE = 2,
    LOAD_NO_DAEMON = 3, /* none could be started or reached */
    LOAD_FAILED = 4
};

/* Parse the command line. Ends the program where it is wrong or asks for help. */
void load_options_parse(int argc, char **argv, struct load_settings *settings);

/* ---- A process that simulates many clients in turn. */

/* Start one, and return its process id, or -1. It exits with 0 unless it could not do its
 * part. It dies with its parent. */
pid_t load_crowd_start(struct load *load, uint32_t index);

/* Run every client, and those that will be killed, alone for one round, in a process of
 * its own, as the engine may be in it (direct:) and its threads do not outlive a fork.
 * Sets truth and truth_records of what is shared. False: it did not work. */
bool load_crowd_find_truth(struct load *load);

#endif

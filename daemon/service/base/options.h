/* options.h - the settings of a daemon: limits, thread counts, paths.
 *
 * Threads: [loop]; what is atomic is read on [compute], too, while config.c changes it:
 * each value by itself, in no order with anything else.
 */
#ifndef SRV_OPTIONS_H
#define SRV_OPTIONS_H

#include <stdatomic.h>
#include <stdbool.h>
#include <stdint.h>
#include <sys/types.h>

#include "log.h"
#include "settings_file.h"

/* The things that a user may have so much of (quota.h). */
enum srv_quota_kind {
    SRV_QUOTA_CLIENTS = 0,
    SRV_QUOTA_SHM_BYTES = 1,
    SRV_QUOTA_MESHES = 2,
    SRV_QUOTA_TRIANGLES = 3, /* of meshes; see srv_triangle_charge */
    SRV_QUOTA_COUNT = 4
};

/* Says if each thread of a step is bound to a processor of its own. */
enum srv_pin {
    SRV_PIN_AUTO = 0, /* when there are as many threads as processors: several daemons, or
                         one with few threads, would crowd the first processors */
    SRV_PIN_ON = 1,
    SRV_PIN_OFF = 2
};

enum srv_sandbox {
    SRV_SANDBOX_AUTO = 0, /* where it can be had */
    SRV_SANDBOX_ON = 1,   /* or do not start */
    SRV_SANDBOX_OFF = 2
};

#define SRV_ALLOW_MAX 32u /* of a kind */

/* List of those who may be clients. All zero: there is none, and whoever can reach the
 * socket may be one. */
struct srv_allow {
    uint32_t uid_count;
    uint32_t gid_count;
    uid_t uids[SRV_ALLOW_MAX];
    gid_t gids[SRV_ALLOW_MAX];
};

#define SRV_SOCKET_PATH_BYTES 108u /* sockaddr_un holds 107 and the NUL */

#define SRV_PATH_BYTES 1024u

struct srv_options {
    char socket_path[SRV_SOCKET_PATH_BYTES];
    _Atomic uint32_t threads_max; /* of a step */
    enum srv_pin pin;
    uint32_t connections_max;      /* of all users; beyond it nobody is accepted */
    uint32_t scenes_max;           /* of one session */
    uint32_t inflight_max;         /* requests of one client, 1 .. 16 */
    uint32_t queue_max;            /* requests that wait for the compute thread */
    _Atomic uint64_t contacts_max; /* records kept for one answer */
    _Atomic uint32_t step_max_ms;  /* that a step computes; 0: as long as it takes */
    uint64_t quota[SRV_QUOTA_COUNT];
    uint64_t memory_total_max; /* of all users, shared and the engine's; 0: no bound */
    struct srv_allow allow;
    uint64_t engine_bytes_max; /* that the engine holds for one user (enginemem.h) */
    uint32_t grace_s;          /* for requests in flight at shutdown */
    uint32_t linger_s;         /* that a session waits for its client; 0: not at all */
    uint32_t idle_exit_s;      /* 0: stay */
    bool private_daemon;       /* go with the last client */
    bool supervise;            /* be the parent of workers (supervise.h) */
    uint32_t crashes_max;      /* that the parent bears within 10 s */
    enum srv_sandbox sandbox;
    int ready_fd;  /* -1: none */
    int listen_fd; /* given to us (activate.c); -1: open one */
    enum srv_level log_level;
    enum srv_log_format log_format;
    char log_path[SRV_PATH_BYTES];    /* "": stderr */
    char config_path[SRV_PATH_BYTES]; /* "": no configuration file */
    struct srv_settings_file *config; /* what was read of it last; NULL: none */
};

#endif

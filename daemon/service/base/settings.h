/* settings.h - the options of the daemon that may also change while it runs.
 *
 * The one list of them, for the command line (commandline.c) and for config.set
 * (config.c):
 *
 *     X(ID, name, letter, argument, form, member, least, most, unit, text, later, first)
 *
 * letter    of the option; 0: none
 * argument  its value in the help
 * form      u32, u64, or level: a word, by its place in `argument`
 * member    of struct srv_options
 * least     value, and
 * most      value; START(N): at most N at the start, and later at most what it was then,
 *           for which the team and the table of descriptors are made
 * unit      what 1 is in that member
 * text      what it is, as `pccdd --help` and `pccdctl config` have it
 * later     added to that for a change while it runs
 * first     the default, for the help
 */
#ifndef SRV_SETTINGS_H
#define SRV_SETTINGS_H

#include "options.h"
#include "proto_limits.h"

#define SRV_MIB (1u << 20)

/* Settings of its life, and of what it says. */
#define SRV_SETTINGS_OF_LIFE(X)                                                          \
    X(IDLE_EXIT, "idle-exit", 0, "SECONDS", u32, idle_exit_s, 0, 1u << 30, 1,            \
      "seconds without a client before the daemon ends; 0: it stays", "", "0")           \
    X(GRACE, "grace", 0, "SECONDS", u32, grace_s, 0, 86400, 1,                           \
      "seconds for requests in flight when it ends", "", "10")                           \
    X(LINGER, "linger", 0, "SECONDS", u32, linger_s, 0, 3600, 1,                         \
      "seconds that a session waits for its client when the connection is lost; 0: not " \
      "at all",                                                                          \
      "", "5")                                                                           \
    X(LOG_LEVEL, "log-level", 'l', "error|warn|info|debug", level, log_level, 0, 3, 1,   \
      "error, warn, info or debug", "", "info")

/* Settings of computing. */
#define SRV_SETTINGS_OF_COMPUTING(X)                                                     \
    X(THREADS, "threads", 't', "N", u32, threads_max, 1, START(1024), 1,                 \
      "threads of a step", ", up to those at the start", "the processors at hand")       \
    X(STEP_MAX, "step-max-ms", 0, "MS", u32, step_max_ms, 0, PROTO_STEP_MAX_MS, 1,       \
      "milliseconds that a step computes before it is answered as one whose deadline "   \
      "has come; 0: as long as it takes",                                                \
      "", "0")                                                                           \
    X(CONTACTS, "contacts-max", 0, "N", u64, contacts_max, 1, 1ull << 32, 1,             \
      "records kept for one answer", "", "16777216")                                     \
    X(SCENES, "scenes-max", 0, "N", u32, scenes_max, 1, 1u << 20, 1,                     \
      "scenes of one client", "; for those that connect from then on", "65536")          \
    X(INFLIGHT, "inflight-max", 0, "N", u32, inflight_max, 1, PROTO_INFLIGHT_MAX, 1,     \
      "steps of one client at a time", "; for rings attached from then on", "16")        \
    X(QUEUE, "queue-max", 0, "N", u32, queue_max, 1, 1u << 20, 1,                        \
      "requests that wait to be computed", "", "32768")

/* Quotas of one user. */
#define SRV_SETTINGS_OF_USER(X)                                                          \
    X(CLIENTS, "clients-max", 0, "N", u64, quota[SRV_QUOTA_CLIENTS], 1, 65536, 1,        \
      "connections of one user", "", "64")                                               \
    X(SHM, "shm-max-mib", 0, "MIB", u64, quota[SRV_QUOTA_SHM_BYTES], 1, 1u << 24,        \
      SRV_MIB, "MiB of shared memory of one user", "",                                   \
      "512, or an eighth of the machine's memory if that is more")                       \
    X(MESHES, "meshes-max", 0, "N", u64, quota[SRV_QUOTA_MESHES], 1, 1u << 20, 1,        \
      "meshes of one user", "", "131072")                                                \
    X(TRIANGLES, "triangles-max", 0, "N", u64, quota[SRV_QUOTA_TRIANGLES], 1,            \
      1ull << 40, 1, "triangles of meshes of one user", "", "256000000")                 \
    X(MEMORY, "memory-max-mib", 0, "MIB", u64, engine_bytes_max, 1, 1u << 24, SRV_MIB,   \
      "MiB that the engine holds for one user: meshes, objects, hierarchies, answers",   \
      "", "half of the machine's memory")

/* Bounds of all users together. */
#define SRV_SETTINGS_OF_ALL(X)                                                           \
    X(MEMORY_TOTAL, "memory-total-mib", 0, "MIB", u64, memory_total_max, 1, 1u << 24,    \
      SRV_MIB, "MiB of memory of all users, shared and the engine's", "",                \
      "three quarters of the machine's")                                                 \
    X(CONNECTIONS, "connections-max", 0, "N", u32, connections_max, 1, START(1u << 20),  \
      1, "connections of all users", ", up to those at the start", "1024")

#define SRV_SETTINGS(X)                                                                  \
    SRV_SETTINGS_OF_LIFE(X)                                                              \
    SRV_SETTINGS_OF_COMPUTING(X)                                                         \
    SRV_SETTINGS_OF_USER(X)                                                              \
    SRV_SETTINGS_OF_ALL(X)

#endif

/* commandline.c - what the command line decides. */
#include "commandline.h"

#include <argp.h>
#include <assert.h>
#include <errno.h>
#include <sched.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "allow.h"
#include "proto_limits.h"
#include "seqpacket.h"
#include "supervise.h"

const char *argp_program_version = "pccdd " PACKAGE_VERSION;

enum {
    OPT_SOCKET = 's',
    OPT_THREADS = 't',
    OPT_LOG_LEVEL = 'l',
    OPT_PRIVATE = 0x100,
    OPT_IDLE_EXIT,
    OPT_READY_FD,
    OPT_GRACE,
    OPT_CLIENTS,
    OPT_CONNECTIONS,
    OPT_SHM,
    OPT_MESHES,
    OPT_TRIANGLES,
    OPT_MEMORY,
    OPT_MEMORY_TOTAL,
    OPT_ALLOW_UID,
    OPT_ALLOW_GID,
    OPT_STEP_MAX,
    OPT_CONTACTS,
    OPT_SCENES,
    OPT_INFLIGHT,
    OPT_QUEUE,
    OPT_PIN,
    OPT_SUPERVISE,
    OPT_CRASHES,
    OPT_SANDBOX,
    OPT_LINGER
};

static const struct argp_option option_table[] = {
    {NULL, 0, NULL, 0, "Where and how long:", 1},
    {"socket", OPT_SOCKET, "PATH", 0,
     "listen there (default: $XDG_RUNTIME_DIR/pccd/pccd.sock, or "
     "/tmp/pccd-UID/pccd.sock)",
     1},
    {"private", OPT_PRIVATE, NULL, 0,
     "exit with the last client, or after 10 s if none comes", 1},
    {"idle-exit", OPT_IDLE_EXIT, "SECONDS", 0,
     "exit after so many seconds without a client; 0 = stay (default)", 1},
    {"grace", OPT_GRACE, "SECONDS", 0,
     "on SIGTERM, finish requests in flight for at most that long (default 10)", 1},
    {"linger", OPT_LINGER, "SECONDS", 0,
     "let the session of a client whose connection is lost wait for it for that long "
     "(default 5; 0 = not at all)",
     1},
    {"supervise", OPT_SUPERVISE, NULL, 0,
     "stay as a small parent that starts the daemon again when it crashes", 1},
    {"crashes-max", OPT_CRASHES, "N", 0,
     "supervise: give up after that many crashes within 10 s (default 5)", 1},
    {"sandbox", OPT_SANDBOX, "WHEN", 0,
     "allow only the system calls that serving needs: on, off, or auto (default: on "
     "where the system can do it)",
     1},
    {"ready-fd", OPT_READY_FD, "N", 0,
     "write the byte 1 to this descriptor and close it when listening", 1},
    {"log-level", OPT_LOG_LEVEL, "LEVEL", 0, "error, warn, info (default) or debug", 1},
    {NULL, 0, NULL, 0, "Computing:", 2},
    {"threads", OPT_THREADS, "N", 0, "threads of a step (default: the CPUs at hand)", 2},
    {"pin", OPT_PIN, "WHEN", 0,
     "bind each thread of a step to a processor of its own: on, off, or auto (default: "
     "when --threads is the number of processors that may be used)",
     2},
    {"step-max-ms", OPT_STEP_MAX, "MS", 0,
     "end a step that has computed for so many milliseconds, as if its deadline had "
     "come; 0 = never (default)",
     2},
    {"contacts-max", OPT_CONTACTS, "N", 0,
     "records kept for one answer (default 16777216)", 2},
    {"scenes-max", OPT_SCENES, "N", 0, "scenes of one client (default 65536)", 2},
    {"inflight-max", OPT_INFLIGHT, "N", 0,
     "steps of one client at a time, 1..16 (default 16)", 2},
    {"queue-max", OPT_QUEUE, "N", 0,
     "requests of all clients that wait to be computed (default 32768)", 2},
    {"allow-uid", OPT_ALLOW_UID, "USER", 0,
     "let this user be a client, besides root and the daemon's own; may be repeated "
     "(default: whoever can reach the socket)",
     1},
    {"allow-gid", OPT_ALLOW_GID, "GROUP", 0,
     "let the members of this group be clients, likewise; may be repeated", 1},
    {NULL, 0, NULL, 0, "Quotas of one user:", 3},
    {"clients-max", OPT_CLIENTS, "N", 0, "connections (default 64)", 3},
    {"shm-max-mib", OPT_SHM, "MIB", 0,
     "shared memory (default: 512, or an eighth of the machine's if that is more)", 3},
    {"meshes-max", OPT_MESHES, "N", 0, "meshes (default 131072)", 3},
    {"triangles-max", OPT_TRIANGLES, "N", 0, "triangles of meshes (default 256000000)",
     3},
    {"memory-max-mib", OPT_MEMORY, "MIB", 0,
     "memory of meshes, objects, hierarchies and answers (default: half of the "
     "machine's)",
     3},
    {NULL, 0, NULL, 0, "Bounds of all users together:", 4},
    {"memory-total-mib", OPT_MEMORY_TOTAL, "MIB", 0,
     "shared memory, and memory of meshes, objects, hierarchies and answers (default: "
     "three quarters of the machine's)",
     4},
    {"connections-max", OPT_CONNECTIONS, "N", 0,
     "connections; more are refused (default 1024)", 4},
    {NULL, 0, NULL, 0, NULL, 0},
};

/* An option's argument as a number in [min, max]; ends the program otherwise. */
static uint64_t number(const struct argp_state *state, const char *option,
                       const char *text, uint64_t min, uint64_t max)
{
    char *end = NULL;
    errno = 0;
    unsigned long long value = strtoull(text, &end, 10);
    if (text[0] < '0' || text[0] > '9' || *end != '\0' || errno != 0 || value < min ||
        value > max) {
        argp_error(state, "--%s: \"%s\" is not a number from %llu to %llu", option, text,
                   (unsigned long long)min, (unsigned long long)max);
    }
    return value;
}

static void set_socket(struct srv_options *options, const struct argp_state *state,
                       const char *path)
{
    if (path[0] == '\0' || strlen(path) >= sizeof options->socket_path) {
        argp_error(state, "--socket: a path has 1 to %u bytes, this one %zu",
                   SRV_SOCKET_PATH_BYTES - 1, strlen(path));
    }
    strcpy(options->socket_path, path);
}

static error_t parse_limit(int key, const char *text, const struct argp_state *state,
                           struct srv_options *options)
{
    switch (key) {
    case OPT_CLIENTS:
        options->quota[SRV_QUOTA_CLIENTS] = number(state, "clients-max", text, 1, 65536);
        return 0;
    case OPT_CONNECTIONS:
        options->connections_max =
            (uint32_t)number(state, "connections-max", text, 1, 1u << 20);
        return 0;
    case OPT_SHM:
        options->quota[SRV_QUOTA_SHM_BYTES] =
            number(state, "shm-max-mib", text, 1, 1u << 24) << 20;
        return 0;
    case OPT_MESHES:
        options->quota[SRV_QUOTA_MESHES] = number(state, "meshes-max", text, 1, 1u << 20);
        return 0;
    case OPT_TRIANGLES:
        options->quota[SRV_QUOTA_TRIANGLES] =
            number(state, "triangles-max", text, 1, 1ull << 40);
        return 0;
    case OPT_MEMORY:
        options->engine_bytes_max = number(state, "memory-max-mib", text, 1, 1u << 24)
                                    << 20;
        return 0;
    case OPT_MEMORY_TOTAL:
        options->memory_total_max = number(state, "memory-total-mib", text, 1, 1u << 24)
                                    << 20;
        return 0;
    case OPT_STEP_MAX:
        options->step_max_ms =
            (uint32_t)number(state, "step-max-ms", text, 0, PROTO_STEP_MAX_MS);
        return 0;
    case OPT_CONTACTS:
        options->contacts_max = number(state, "contacts-max", text, 1, 1ull << 32);
        return 0;
    case OPT_SCENES:
        options->scenes_max = (uint32_t)number(state, "scenes-max", text, 1, 1u << 20);
        return 0;
    case OPT_INFLIGHT:
        options->inflight_max =
            (uint32_t)number(state, "inflight-max", text, 1, PROTO_INFLIGHT_MAX);
        return 0;
    case OPT_QUEUE:
        options->queue_max = (uint32_t)number(state, "queue-max", text, 1, 1u << 20);
        return 0;
    default:
        return ARGP_ERR_UNKNOWN;
    }
}

/* "auto", "on" or "off": the numbers of enum srv_pin and of enum srv_sandbox. */
static int choice(const struct argp_state *state, const char *option, const char *text)
{
    static const char *const names[] = {
        [SRV_PIN_AUTO] = "auto", [SRV_PIN_ON] = "on", [SRV_PIN_OFF] = "off"};
    static_assert((int)SRV_SANDBOX_AUTO == SRV_PIN_AUTO &&
                      (int)SRV_SANDBOX_ON == SRV_PIN_ON &&
                      (int)SRV_SANDBOX_OFF == SRV_PIN_OFF,
                  "one table");
    for (int i = SRV_PIN_AUTO; i <= SRV_PIN_OFF; i++) {
        if (strcmp(text, names[i]) == 0) {
            return i;
        }
    }
    argp_error(state, "--%s: \"%s\" is none of auto, on, off", option, text);
    return SRV_PIN_AUTO;
}

static error_t parse_option(int key, char *text, struct argp_state *state)
{
    struct srv_options *options = state->input;
    switch (key) {
    case OPT_SOCKET:
        set_socket(options, state, text);
        return 0;
    case OPT_PRIVATE:
        options->private_daemon = true;
        return 0;
    case OPT_SUPERVISE:
        options->supervise = true;
        return 0;
    case OPT_CRASHES:
        options->crashes_max =
            (uint32_t)number(state, "crashes-max", text, 1, SRV_CRASHES_LIMIT);
        return 0;
    case OPT_IDLE_EXIT:
        options->idle_exit_s = (uint32_t)number(state, "idle-exit", text, 0, 1u << 30);
        return 0;
    case OPT_GRACE:
        options->grace_s = (uint32_t)number(state, "grace", text, 0, 86400);
        return 0;
    case OPT_LINGER:
        options->linger_s = (uint32_t)number(state, "linger", text, 0, 3600);
        return 0;
    case OPT_READY_FD:
        options->ready_fd = (int)number(state, "ready-fd", text, 0, 1u << 20);
        return 0;
    case OPT_THREADS:
        options->threads_max = (uint32_t)number(state, "threads", text, 1, 1024);
        return 0;
    case OPT_PIN:
        options->pin = (enum srv_pin)choice(state, "pin", text);
        return 0;
    case OPT_SANDBOX:
        options->sandbox = (enum srv_sandbox)choice(state, "sandbox", text);
        return 0;
    case OPT_ALLOW_UID:
        if (!srv_allow_user(&options->allow, text)) {
            argp_error(state, "--allow-uid: no user \"%s\", or more than %u", text,
                       SRV_ALLOW_MAX);
        }
        return 0;
    case OPT_ALLOW_GID:
        if (!srv_allow_group(&options->allow, text)) {
            argp_error(state, "--allow-gid: no group \"%s\", or more than %u", text,
                       SRV_ALLOW_MAX);
        }
        return 0;
    case OPT_LOG_LEVEL:
        if (srv_log_level_by_name(text) < 0) {
            argp_error(state, "--log-level: \"%s\" is none of error, warn, info, debug",
                       text);
        }
        options->log_level = (enum srv_level)srv_log_level_by_name(text);
        return 0;
    case ARGP_KEY_ARG:
        argp_error(state, "there are no arguments, only options: \"%s\"", text);
        return 0;
    default:
        return parse_limit(key, text, state, options);
    }
}

static uint32_t cpu_count(void)
{
    cpu_set_t cpus;
    if (sched_getaffinity(0, sizeof cpus, &cpus) != 0) {
        return 1; /* more CPUs than cpu_set_t holds: --threads says how many to use */
    }
    return (uint32_t)CPU_COUNT(&cpus);
}

/* Half of what the machine has; 1 GiB where it does not say. */
static uint64_t half_of_memory(void)
{
    long pages = sysconf(_SC_PHYS_PAGES);
    long page_bytes = sysconf(_SC_PAGESIZE);
    return pages > 0 && page_bytes > 0 ? (uint64_t)pages * (uint64_t)page_bytes / 2
                                       : 1ull << 30;
}

static uint64_t shared_memory(void)
{
    uint64_t eighth = half_of_memory() / 4 >> 20 << 20;
    return eighth > PROTO_SHM_BYTES_PER_UID ? eighth : PROTO_SHM_BYTES_PER_UID;
}

void srv_options_parse(struct srv_options *options, int argc, char **argv)
{
    static const struct argp argp = {
        .options = option_table,
        .parser = parse_option,
        .doc =
            "Continuous collision detection of deforming triangle meshes, as a service "
            "for the processes of this machine.",
    };
    *options = (struct srv_options){
        .threads_max = cpu_count(),
        .connections_max = 1024,
        .scenes_max = PROTO_SCENES_PER_CLIENT,
        .inflight_max = PROTO_INFLIGHT_MAX,
        .queue_max = 32768,
        .contacts_max = PROTO_CONTACTS_PER_STEP,
        .quota = {[SRV_QUOTA_CLIENTS] = PROTO_CLIENTS_PER_UID,
                  [SRV_QUOTA_SHM_BYTES] = shared_memory(),
                  [SRV_QUOTA_MESHES] = PROTO_MESHES_PER_UID,
                  [SRV_QUOTA_TRIANGLES] = PROTO_TRIANGLES_PER_UID},
        .engine_bytes_max = half_of_memory(),
        .memory_total_max = half_of_memory() / 2 * 3,
        .grace_s = 10,
        .crashes_max = SRV_CRASHES_MAX,
        .linger_s = PROTO_LINGER_S,
        .ready_fd = -1,
        .listen_fd = -1,
        .log_level = SRV_LOG_INFO,
    };
    argp_parse(&argp, argc, argv, 0, NULL, options);
    if (options->socket_path[0] == '\0' &&
        proto_default_socket_path(options->socket_path, sizeof options->socket_path) !=
            0) {
        fprintf(stderr, "pccdd: the default socket path is too long; use --socket\n");
        exit(1);
    }
}

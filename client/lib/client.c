/* client.c - a connection: options, connect, hello, close, error text.
 *
 * Room:     client/lib. May include: client.h, rpc.h, attach.h, launch.h, proto.
 * Does:     the public functions of pccd.h that make, describe and end a client.
 * Does not: start daemons (launch.c) or exchange messages (rpc.c).
 * Threads:  [owner].
 */
#include <errno.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <time.h>
#include <unistd.h>

#include "attach.h"
#include "client.h"
#include "launch.h"
#include "records.h" /* asserts that the records have the layout of the wire */
#include "rpc.h"
#include "seqpacket.h"

#define CLI_TIMEOUT_MS     30000
#define CLI_TIMEOUT_MS_MAX 3600000
#define CLI_SPIN_US        50u
#define CLI_SPIN_US_MAX    1000u
#define CLI_SLOT_COUNT     4u
#define CLI_RESULT_BYTES   (64ull << 20)
#define CLI_OPTIONS_MAX    4096u /* of struct_bytes: no release will ever need more */
#define CLI_STARTS_MAX     3     /* daemons started by one connect */
#define CLI_RETRY_NS       1000000u
#define CLI_RETRY_NS_MAX   50000000u
#define CLI_START_PATIENCE 2000000000ull /* ns: from "listening" to a connection */

static _Thread_local char connect_error[CLI_TEXT_BYTES];

int cli_fail(struct pccd_client *client, int status, const char *format, ...)
{
    char *text = client != NULL ? client->error : connect_error;
    va_list arguments;

    va_start(arguments, format);
    (void)vsnprintf(text, CLI_TEXT_BYTES, format, arguments);
    va_end(arguments);
    return status;
}

uint64_t cli_now_ns(void)
{
    struct timespec now;

    (void)clock_gettime(CLOCK_MONOTONIC, &now);
    return (uint64_t)now.tv_sec * 1000000000u + (uint64_t)now.tv_nsec;
}

uint64_t cli_deadline(const struct pccd_client *client, int timeout_ms)
{
    int wait_ms = timeout_ms < 0 ? client->timeout_ms : timeout_ms;

    return cli_now_ns() + (uint64_t)wait_ms * 1000000u;
}

const char *pccd_status_name(int status)
{
    return proto_status_name(status);
}

const char *pccd_status_text(int status)
{
    return proto_status_text(status);
}

const char *pccd_error_text(const struct pccd_client *client)
{
    return client != NULL ? client->error : connect_error;
}

#define CLI_STR_(x) #x
#define CLI_STR(x)  CLI_STR_(x)

const char *pccd_version(void)
{
    return CLI_STR(PCCD_VERSION_MAJOR) "." CLI_STR(PCCD_VERSION_MINOR) "." CLI_STR(
        PCCD_VERSION_PATCH);
}

void pccd_options_init(struct pccd_options *options)
{
    if (options == NULL) {
        return;
    }
    memset(options, 0, sizeof(*options));
    options->struct_bytes = sizeof(*options);
    options->timeout_ms = CLI_TIMEOUT_MS;
    options->slot_count = CLI_SLOT_COUNT;
    options->result_bytes = CLI_RESULT_BYTES;
    /* With one CPU a spin only keeps the daemon from running. */
    options->spin_us = sysconf(_SC_NPROCESSORS_ONLN) > 1 ? CLI_SPIN_US : 0;
}

/* Check what the user asked for and fill in what was left open. */
static int take_options(struct pccd_client *client, const struct pccd_options *asked,
                        struct pccd_options *options)
{
    pccd_options_init(options);
    if (asked == NULL) {
        return 0;
    }
    if (asked->struct_bytes != 0 &&
        (asked->struct_bytes < sizeof(*asked) || asked->struct_bytes > CLI_OPTIONS_MAX)) {
        return cli_fail(client, PCCD_E_INVAL, "options.struct_bytes is %zu, not %zu",
                        asked->struct_bytes, sizeof(*asked));
    }
    /* A newer program may know options that this library does not: only their zero. */
    for (size_t i = sizeof(*asked); i < asked->struct_bytes; i++) {
        if (((const unsigned char *)asked)[i] != 0) {
            return cli_fail(client, PCCD_E_INVAL,
                            "options hold something that libpccd %s does not know",
                            pccd_version());
        }
    }
    if (asked->timeout_ms < 0 || asked->timeout_ms > CLI_TIMEOUT_MS_MAX) {
        return cli_fail(client, PCCD_E_INVAL, "options.timeout_ms is %d, not 1 .. %d",
                        asked->timeout_ms, CLI_TIMEOUT_MS_MAX);
    }
    if (asked->slot_count > PROTO_SLOTS_MAX) {
        return cli_fail(client, PCCD_E_INVAL, "options.slot_count is %u, not 1 .. %u",
                        asked->slot_count, PROTO_SLOTS_MAX);
    }
    if (asked->spin_us > CLI_SPIN_US_MAX) {
        return cli_fail(client, PCCD_E_INVAL, "options.spin_us is %u, not 0 .. %u",
                        asked->spin_us, CLI_SPIN_US_MAX);
    }
    if (asked->result_bytes != 0 && asked->result_bytes < PROTO_RESULT_BYTES_MIN) {
        return cli_fail(client, PCCD_E_INVAL,
                        "options.result_bytes is %llu, less than %u",
                        (unsigned long long)asked->result_bytes, PROTO_RESULT_BYTES_MIN);
    }
    if (asked->slot_bytes != 0 && asked->slot_bytes < PROTO_SLOT_BYTES_MIN) {
        return cli_fail(client, PCCD_E_INVAL, "options.slot_bytes is %llu, less than %u",
                        (unsigned long long)asked->slot_bytes, PROTO_SLOT_BYTES_MIN);
    }
    if (asked->private_daemon && (asked->no_autostart || asked->url != NULL)) {
        return cli_fail(client, PCCD_E_INVAL,
                        "options.private_daemon excludes url and no_autostart");
    }
    options->url = asked->url;
    options->daemon = asked->daemon;
    options->name = asked->name;
    options->no_autostart = asked->no_autostart;
    options->private_daemon = asked->private_daemon;
    options->slot_bytes = asked->slot_bytes;
    if (asked->timeout_ms != 0) {
        options->timeout_ms = asked->timeout_ms;
    }
    if (asked->slot_count != 0) {
        options->slot_count = asked->slot_count;
    }
    if (asked->result_bytes != 0) {
        options->result_bytes = asked->result_bytes;
    }
    if (asked->struct_bytes != 0) {
        options->spin_us = asked->spin_us;
    }
    return 0;
}

static void sleep_ns(uint64_t ns)
{
    struct timespec pause = {(time_t)(ns / 1000000000u), (long)(ns % 1000000000u)};

    (void)nanosleep(&pause,
                    NULL); /* cut short by a signal: the caller looks at the clock */
}

/* Connect the socket, waiting while the daemon's queue of connections is full.
 * PCCD_E_NODAEMON: nobody listens there. */
static int open_socket(struct pccd_client *client, const char *path, uint64_t deadline_ns)
{
    struct sockaddr_un address = {.sun_family = AF_UNIX};
    uint64_t pause_ns = CLI_RETRY_NS;

    memcpy(address.sun_path, path, strlen(path)); /* checked: shorter than sun_path */
    (void)snprintf(client->url, sizeof(client->url), "unix:%s", path);
    client->socket = socket(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
    if (client->socket < 0) {
        return cli_fail(client, PCCD_E_SYSTEM, "socket: %s", strerror(errno));
    }
    while (connect(client->socket, (const struct sockaddr *)&address, sizeof(address)) !=
           0) {
        int reason = errno;

        if (reason == EAGAIN && cli_now_ns() < deadline_ns) {
            sleep_ns(pause_ns);
            pause_ns = pause_ns * 2 < CLI_RETRY_NS_MAX ? pause_ns * 2 : CLI_RETRY_NS_MAX;
            continue;
        }
        if (reason == EINTR) {
            continue;
        }
        (void)close(client->socket);
        client->socket = -1;
        if (reason == EAGAIN) {
            return cli_fail(client, PCCD_E_TIMEOUT, "the daemon at %s accepts nobody",
                            path);
        }
        if (reason == ENOENT || reason == ECONNREFUSED || reason == ENOTDIR) {
            return cli_fail(client, PCCD_E_NODAEMON, "nobody listens at %s: %s", path,
                            strerror(reason));
        }
        return cli_fail(client, PCCD_E_SYSTEM, "connect to %s: %s", path,
                        strerror(reason));
    }
    return 0;
}

/* The first message. A daemon that refuses the session says why in its goaway. */
static int say_hello(struct pccd_client *client, const char *name, uint64_t deadline_ns)
{
    struct proto_HELLO_request request = {.version_min = PROTO_VERSION_MIN,
                                          .version_max = PROTO_VERSION_MAX};
    struct proto_HELLO_result result;
    int rc;

    (void)snprintf(request.client, sizeof(request.client), "%s",
                   name != NULL ? name : program_invocation_short_name);
    rc = cli_call_sync(client, PROTO_METHOD_HELLO, &request, &result, deadline_ns);
    if (rc == PCCD_E_DISCONNECTED && client->goaway != 0) {
        return cli_fail(client, client->goaway, "%s", client->dead_text);
    }
    if (rc != 0) {
        return rc;
    }
    if (result.version < PROTO_VERSION_MIN || result.version > PROTO_VERSION_MAX) {
        return cli_fail(client, PCCD_E_VERSION,
                        "the daemon chose version %u, this library speaks %u .. %u",
                        result.version, PROTO_VERSION_MIN, PROTO_VERSION_MAX);
    }
    client->pid = result.pid;
    static_assert(sizeof(client->cpu) == sizeof(result.cpu), "the whole string");
    memcpy(client->cpu, result.cpu, sizeof(client->cpu));
    return 0;
}

/* Who listens on a path that nobody chose must be this user or root: in /tmp, or with
 * another user's $XDG_RUNTIME_DIR, anybody may have been there first. */
static int check_owner(struct pccd_client *client)
{
    struct ucred peer; /* of the process that began to listen */
    socklen_t bytes = sizeof(peer);

    if (getsockopt(client->socket, SOL_SOCKET, SO_PEERCRED, &peer, &bytes) != 0) {
        return cli_fail(client, PCCD_E_SYSTEM, "owner of the daemon at %s: %s",
                        client->url, strerror(errno));
    }
    if (peer.uid != 0 && peer.uid != geteuid() && peer.uid != getuid()) {
        return cli_fail(client, PCCD_E_SYSTEM,
                        "the daemon at %s is user %u's, not this user's (%u); an url "
                        "or PCCD_URL chooses it nevertheless",
                        client->url, (unsigned)peer.uid, (unsigned)geteuid());
    }
    return 0;
}

/* `own`: only a daemon of this user. */
static int open_session(struct pccd_client *client, const char *path, bool own,
                        const char *name, uint64_t deadline_ns)
{
    int rc = open_socket(client, path, deadline_ns);

    if (rc != 0) {
        return rc;
    }
    rc = own ? check_owner(client) : 0;
    if (rc == 0) {
        rc = say_hello(client, name, deadline_ns);
    }
    if (rc != 0) {
        cli_rpc_close(client);
    }
    return rc;
}

/* A daemon that ends while we connect, or that has not yet begun to listen: try again. */
static bool is_worth_retrying(int rc)
{
    return rc == PCCD_E_NODAEMON || rc == PCCD_E_DISCONNECTED || rc == PCCD_E_SHUTDOWN;
}

static int retry_session(struct pccd_client *client, const char *path, const char *name,
                         uint64_t deadline_ns)
{
    uint64_t pause_ns = CLI_RETRY_NS;
    uint64_t until_ns = cli_now_ns() + CLI_START_PATIENCE;
    int rc;

    if (until_ns > deadline_ns) {
        until_ns = deadline_ns;
    }
    do {
        rc = open_session(client, path, true, name, deadline_ns);
        if (!is_worth_retrying(rc)) {
            return rc;
        }
        sleep_ns(pause_ns);
        pause_ns = pause_ns * 2 < CLI_RETRY_NS_MAX ? pause_ns * 2 : CLI_RETRY_NS_MAX;
    } while (cli_now_ns() < until_ns);
    return rc;
}

/* The user's own daemon, started when nobody listens. Of two clients that start one at
 * the same time the daemon's lock lets one through; the other's daemon ends, and both
 * connect to the first. */
static int connect_user(struct pccd_client *client, const struct pccd_options *options,
                        uint64_t deadline_ns)
{
    char path[CLI_SOCKET_BYTES];
    int rc;

    if (proto_default_socket_path(path, sizeof(path)) != 0) {
        return cli_fail(client, PCCD_E_LIMIT,
                        "$XDG_RUNTIME_DIR is too long for a socket's path");
    }
    rc = open_session(client, path, true, options->name, deadline_ns);
    for (int start = 0; start < CLI_STARTS_MAX && is_worth_retrying(rc); start++) {
        int started;

        if (options->no_autostart) {
            return rc;
        }
        started = cli_launch_user(client, options->daemon, path, deadline_ns);
        if (started != 0 && started != PCCD_E_AGAIN) {
            return started;
        }
        rc = retry_session(client, path, options->name, deadline_ns);
        if (is_worth_retrying(rc) && started == PCCD_E_AGAIN) {
            return cli_fail(
                client, PCCD_E_NODAEMON,
                "the daemon that was started for %s ended at once; PCCD_LOG=FILE "
                "shows what it says",
                path);
        }
    }
    return rc;
}

static int connect_private(struct pccd_client *client, const struct pccd_options *options,
                           uint64_t deadline_ns)
{
    char path[CLI_SOCKET_BYTES];
    int rc = cli_launch_private(client, options->daemon, path, deadline_ns);

    if (rc != 0) {
        return rc;
    }
    return open_session(client, path, true, options->name, deadline_ns);
}

static int connect_url(struct pccd_client *client, const char *url,
                       const struct pccd_options *options, uint64_t deadline_ns)
{
    if (strncmp(url, "unix:", 5) != 0 || url[5] == '\0') {
        return cli_fail(client, PCCD_E_INVAL, "url \"%.200s\" is not unix:PATH", url);
    }
    if (strlen(url + 5) >= CLI_SOCKET_BYTES) {
        return cli_fail(client, PCCD_E_INVAL, "the path of \"%.200s\" is longer than %u",
                        url, CLI_SOCKET_BYTES - 1);
    }
    return open_session(client, url + 5, false, options->name, deadline_ns);
}

static int connect_any(struct pccd_client *client, const struct pccd_options *asked)
{
    struct pccd_options options;
    const char *url;
    uint64_t deadline_ns;
    int rc = take_options(client, asked, &options);

    if (rc != 0) {
        return rc;
    }
    client->timeout_ms = options.timeout_ms;
    client->spin_us = options.spin_us;
    client->slots_chosen = asked != NULL && asked->slot_count != 0;
    client->slot_count = options.slot_count;
    client->slot_bytes = options.slot_bytes;
    client->result_bytes = options.result_bytes;
    deadline_ns = cli_deadline(client, -1);
    if (options.private_daemon) {
        return connect_private(client, &options, deadline_ns);
    }
    url = options.url != NULL ? options.url : getenv("PCCD_URL");
    if (url != NULL && url[0] != '\0') {
        return connect_url(client, url, &options, deadline_ns);
    }
    return connect_user(client, &options, deadline_ns);
}

int pccd_connect(const struct pccd_options *options, struct pccd_client **client)
{
    struct pccd_client *made;
    int rc;

    if (client == NULL) {
        return cli_fail(NULL, PCCD_E_INVAL, "client is NULL");
    }
    made = calloc(1, sizeof(*made));
    if (made == NULL) {
        return cli_fail(NULL, PCCD_E_NOMEM, "no memory for a client");
    }
    made->socket = -1;
    made->fds[0] = made->fds[1] = -1;
    made->owner = getpid();
    made->next_id = 1;
    made->next_step = 1;
    made->page_first = made->page_end = 1;
    made->ring.upload = made->ring.result = (struct proto_memory)PROTO_MEMORY_NONE;
    made->decoder = proto_decoder_new();
    rc = made->decoder == NULL ? cli_fail(made, PCCD_E_NOMEM, "no memory for a decoder")
                               : connect_any(made, options);
    if (rc != 0) {
        (void)snprintf(connect_error, sizeof(connect_error), "%s", made->error);
        pccd_close(made);
        return rc;
    }
    connect_error[0] = made->error[0] = '\0';
    *client = made;
    return 0;
}

void pccd_close(struct pccd_client *client)
{
    if (client == NULL) {
        return;
    }
    cli_rpc_close(client);
    cli_ring_deinit(&client->ring);
    if (client->owner == getpid()) {
        cli_launch_stop(&client->child);
    }
    proto_decoder_free(client->decoder);
    free(client);
}

int pccd_fd(const struct pccd_client *client)
{
    return client != NULL ? client->socket : -1;
}

uint32_t pccd_daemon_pid(const struct pccd_client *client)
{
    return client != NULL ? client->pid : 0;
}

const char *pccd_daemon_cpu(const struct pccd_client *client)
{
    return client != NULL ? client->cpu : "";
}

const char *pccd_url(const struct pccd_client *client)
{
    return client != NULL ? client->url : "";
}

/* link.c - the way to a daemon. */
#include "link.h"

#include <assert.h>
#include <errno.h>
#include <fcntl.h>
#include <string.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <time.h>
#include <unistd.h>

#include "connection.h"
#include "launch.h"
#include "rpc.h"
#include "seqpacket.h"

#define CLI_RETRY_NS       1000000u
#define CLI_RETRY_NS_MAX   50000000u
#define CLI_STARTS_MAX     3             /* daemons started by one connect */
#define CLI_START_PATIENCE 2000000000ull /* ns: from "listening" to a connection */

void cli_sleep_ns(uint64_t ns)
{
    struct timespec pause = {(time_t)(ns / 1000000000u), (long)(ns % 1000000000u)};

    (void)nanosleep(&pause,
                    NULL); /* cut short by a signal: the caller looks at the clock */
}

/* Pause, twice as long the next time. */
static void pause_longer(uint64_t *pause_ns)
{
    cli_sleep_ns(*pause_ns);
    *pause_ns = *pause_ns * 2 < CLI_RETRY_NS_MAX ? *pause_ns * 2 : CLI_RETRY_NS_MAX;
}

/* Take a connected socket; in place of another one under the same number, so that whoever
 * watches it goes on. */
static int take_socket(struct pccd_client *client, int fd)
{
    if (client->socket < 0) {
        client->socket = fd;
        return 0;
    }
    if (dup3(fd, client->socket, O_CLOEXEC) < 0) {
        (void)close(fd);
        return cli_fail(client, PCCD_E_SYSTEM, "dup3: %s", strerror(errno));
    }
    (void)close(fd);
    return 0;
}

/* Have cli_await wait. All else that is done with the socket asks not to. */
static bool make_awaited(int fd)
{
    const struct timeval timeout = {CLI_AWAIT_NS / 1000000000u, 0};
    int flags = fcntl(fd, F_GETFL);

    return flags >= 0 && fcntl(fd, F_SETFL, flags & ~O_NONBLOCK) == 0 &&
           setsockopt(fd, SOL_SOCKET, SO_RCVTIMEO, &timeout, sizeof timeout) == 0;
}

/* Connect the socket, waiting while the daemon's queue of connections is full.
 * PCCD_E_NODAEMON: nobody listens there. */
static int open_socket(struct pccd_client *client, const char *path, uint64_t deadline_ns)
{
    struct sockaddr_un address = {.sun_family = AF_UNIX};
    uint64_t pause_ns = CLI_RETRY_NS;
    int fd;

    assert(strlen(path) < CLI_SOCKET_BYTES && strlen(path) < sizeof address.sun_path);
    memcpy(address.sun_path, path, strlen(path)); /* checked: shorter than sun_path */
    memcpy(client->url, "unix:", 5);
    memcpy(client->url + 5, path, strlen(path) + 1);
    fd = socket(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
    if (fd < 0) {
        return cli_fail(client, PCCD_E_SYSTEM, "socket: %s", strerror(errno));
    }
    while (connect(fd, (const struct sockaddr *)&address, sizeof address) != 0) {
        int reason = errno;

        if (reason == EAGAIN && common_now_ns() < deadline_ns) {
            pause_longer(&pause_ns);
            continue;
        }
        if (reason == EINTR) {
            continue;
        }
        (void)close(fd);
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
    if (!make_awaited(fd)) {
        (void)close(fd);
        return cli_fail(client, PCCD_E_SYSTEM, "socket: %s", strerror(errno));
    }
    return take_socket(client, fd);
}

/* Hello and its answer; with_held: see link.h. */
static int exchange(struct pccd_client *client, const struct proto_HELLO_request *request,
                    bool with_held, struct proto_HELLO_result *result,
                    uint64_t deadline_ns)
{
    struct cli_call *call = NULL;
    int status = cli_call_send(client, PROTO_METHOD_HELLO, request, CLI_SLOT_NONE,
                               deadline_ns, &call);

    if (status != 0) {
        return status;
    }
    call->result = result;
    status = with_held ? cli_call_resend_all(client, deadline_ns) : 0;
    status = status != 0 ? status : cli_call_wait(client, call, deadline_ns);
    if (status == 0) {
        return cli_call_finish(client, call);
    }
    cli_call_drop(client, call);
    return status == PCCD_E_TIMEOUT ? cli_fail(client, status, "no answer to %s in time",
                                               proto_messages[PROTO_METHOD_HELLO].name)
                                    : status;
}

/* The first message. A daemon that refuses the session says why in its goaway. */
static int say_hello(struct pccd_client *client, bool with_held, uint64_t deadline_ns,
                     bool *resumed)
{
    struct cli_link *link = &client->link;
    struct proto_HELLO_request request = {.version_min = PROTO_VERSION_MIN,
                                          .version_max = PROTO_VERSION_MAX,
                                          .resumable = link->patience_ns > 0,
                                          .resume_epoch = link->epoch,
                                          .resume_session = link->session,
                                          .token_hi = link->token[0],
                                          .token_lo = link->token[1],
                                          .observer = link->observes};
    struct proto_HELLO_result result;
    const char *name;
    int status;

    name = link->name[0] != '\0' ? link->name : program_invocation_short_name;
    memcpy(request.client, name, strnlen(name, sizeof request.client - 1));
    status = exchange(client, &request, with_held, &result, deadline_ns);
    if (status == PCCD_E_DISCONNECTED && client->goaway != 0) {
        return cli_fail(client, client->goaway, "%s", client->dead_text);
    }
    if (status != 0) {
        return status;
    }
    if (result.version < PROTO_VERSION_MIN || result.version > PROTO_VERSION_MAX) {
        return cli_fail(client, PCCD_E_VERSION,
                        "the daemon chose version %u, this library speaks %u .. %u",
                        result.version, PROTO_VERSION_MIN, PROTO_VERSION_MAX);
    }
    *resumed = result.resumed;
    link->features = result.features;
    link->epoch = result.epoch;
    link->session = result.token_hi != 0 || result.token_lo != 0 ? result.session : 0;
    link->token[0] = result.token_hi;
    link->token[1] = result.token_lo;
    client->pid = result.pid;
    static_assert(sizeof client->cpu == sizeof result.cpu, "the whole string");
    memcpy(client->cpu, result.cpu, sizeof client->cpu);
    memcpy(client->daemon, result.daemon, sizeof client->daemon);
    client->version = result.version;
    client->threads_max = result.threads_max;
    client->session = result.session;
    return 0;
}

/* Check that this user or root listens on a path that nobody chose: in /tmp, or with
 * another user's $XDG_RUNTIME_DIR, anybody may have been there first. */
static int check_owner(struct pccd_client *client)
{
    struct ucred peer; /* of the process that began to listen */
    socklen_t bytes = sizeof peer;

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

static int open_session(struct pccd_client *client, bool with_held, uint64_t deadline_ns,
                        bool *resumed)
{
    const struct cli_link *link = &client->link;
    int status = link->way == CLI_WAY_DIRECT
                     ? cli_direct_open(client)
                     : open_socket(client, link->path, deadline_ns);

    if (status == 0 && (link->way == CLI_WAY_USER || link->way == CLI_WAY_PRIVATE)) {
        status = check_owner(client);
    }
    return status != 0 ? status : say_hello(client, with_held, deadline_ns, resumed);
}

/* The same, and nothing is left of a connection that failed. */
static int open_first(struct pccd_client *client, uint64_t deadline_ns)
{
    bool resumed = false;
    int status = open_session(client, false, deadline_ns, &resumed);

    if (status != 0) {
        cli_connection_close(client);
    }
    return status;
}

/* A daemon that ends while we connect, or that has not yet begun to listen: try again. */
static bool is_worth_retrying(int status)
{
    return status == PCCD_E_NODAEMON || status == PCCD_E_DISCONNECTED ||
           status == PCCD_E_SHUTDOWN;
}

static int retry_session(struct pccd_client *client, uint64_t deadline_ns)
{
    uint64_t pause_ns = CLI_RETRY_NS;
    uint64_t until_ns = common_now_ns() + CLI_START_PATIENCE;
    int status;

    if (until_ns > deadline_ns) {
        until_ns = deadline_ns;
    }
    do {
        status = open_first(client, deadline_ns);
        if (!is_worth_retrying(status)) {
            return status;
        }
        pause_longer(&pause_ns);
    } while (common_now_ns() < until_ns);
    return status;
}

/* The user's own daemon, started when nobody listens. Of two clients that start one at
 * the same time the daemon's lock lets one through; the other's daemon ends, and both
 * connect to the first, whenever that has come to listen: on a busy machine it takes
 * seconds. Or it is about to end, and then the next one is started. */
static int connect_user(struct pccd_client *client, uint64_t deadline_ns)
{
    const struct cli_link *link = &client->link;
    int status = open_first(client, deadline_ns);

    for (int start = 0; start < CLI_STARTS_MAX && is_worth_retrying(status);) {
        int started;

        if (link->no_autostart) {
            return status;
        }
        started = cli_launch_user(client, link->daemon, link->path, deadline_ns);
        if (started != 0 && started != PCCD_E_AGAIN && started != PCCD_E_BUSY) {
            return started;
        }
        start += started != PCCD_E_BUSY || common_now_ns() >= deadline_ns;
        status = retry_session(client, deadline_ns);
        if (is_worth_retrying(status) && started == PCCD_E_AGAIN) {
            char words[CLI_WORDS_BYTES];

            cli_launch_words(client, link->path, words);
            return cli_fail(client, PCCD_E_NODAEMON,
                            "the daemon that was started for %s ended at once%s",
                            link->path, words);
        }
    }
    return status;
}

int cli_link_first(struct pccd_client *client, uint64_t deadline_ns)
{
    struct cli_link *link = &client->link;
    int status = 0;

    switch (link->way) {
    case CLI_WAY_USER:
        if (proto_default_socket_path(link->path, sizeof link->path) != 0) {
            return cli_fail(client, PCCD_E_LIMIT,
                            "$XDG_RUNTIME_DIR is too long for a socket's path");
        }
        return connect_user(client, deadline_ns);
    case CLI_WAY_PRIVATE:
        status = cli_launch_private(client, link->daemon, link->path, deadline_ns);
        break;
    case CLI_WAY_URL:
    case CLI_WAY_DIRECT:
        break;
    }
    status = status != 0 ? status : open_first(client, deadline_ns);
    /* One that dies between accepting us and its answer has a successor, as a rule. */
    return status == PCCD_E_DISCONNECTED && link->patience_ns > 0
               ? retry_session(client, deadline_ns)
               : status;
}

/* Start a daemon in place of one that is gone, where this client may. */
static int launch_again(struct pccd_client *client, uint64_t deadline_ns)
{
    struct cli_link *link = &client->link;

    if (link->way == CLI_WAY_PRIVATE) {
        cli_launch_stop(&client->child);
        return cli_launch_private(client, link->daemon, link->path, deadline_ns);
    }
    if (link->way == CLI_WAY_USER && !link->no_autostart) {
        int status = cli_launch_user(client, link->daemon, link->path, deadline_ns);

        /* Another client was faster. */
        return status == PCCD_E_AGAIN || status == PCCD_E_BUSY ? 0 : status;
    }
    return PCCD_E_NODAEMON;
}

int cli_link_again(struct pccd_client *client, bool with_held, uint64_t deadline_ns,
                   bool *resumed)
{
    int status = open_session(client, with_held, deadline_ns, resumed);

    if (status == PCCD_E_NODAEMON && client->link.way != CLI_WAY_URL) {
        status = launch_again(client, deadline_ns);
        if (status == 0) {
            status = open_session(client, with_held, deadline_ns, resumed);
        }
    }
    return status;
}

void cli_link_bye(struct pccd_client *client)
{
    struct proto_BYE_request request = {.reserved = 0};
    struct cli_link *link = &client->link;

    if (link->session != 0 && !client->dead && !link->is_down && client->socket >= 0 &&
        client->owner == getpid() &&
        proto_encode_request(&client->encoder, client->next_id, PROTO_METHOD_BYE,
                             &request) == 0) {
        /* When the socket takes nothing more, the session ends when its time is up. */
        (void)proto_send(client->socket, client->encoder.data, client->encoder.bytes,
                         NULL, 0);
    }
}

void cli_link_forget(struct pccd_client *client)
{
    cli_link_bye(client);
    client->link.session = 0;
    client->link.token[0] = client->link.token[1] = 0;
}

/* reactor.c - the event loop, and what the daemon has besides the service.
 *
 * Start and stop in order:
 *
 *     RUNNING -- signal, idle, private --> DRAINING
 *     DRAINING -- nothing in flight, all replies sent --> CLOSING
 *     CLOSING -- all sessions freed --> CLOSED --> end
 *
 * When the grace time ends in DRAINING, requests are cancelled; FORCE_MS later the
 * process just ends.
 *
 * Threads: [loop]; on_enter is called on [compute], on_notify also on [pages].
 */
#include "reactor.h"

#include <malloc.h>
#include <signal.h>
#include <stdlib.h>
#include <unistd.h>

#include "commandline.h"
#include "config.h"
#include "conn.h"
#include "crash.h"
#include "dispatch.h"
#include "engine.h"
#include "hold.h"
#include "invariant.h"
#include "lifeline.h"
#include "linger.h"
#include "listener.h"
#include "notify.h"
#include "now.h"
#include "pccd_types.h"
#include "printable.h"
#include "proto_limits.h"
#include "request.h"
#include "sandbox.h"
#include "server.h"
#include "session.h"
#include "setup.h"
#include "socketfile.h"
#include "stray.h"
#include "supervise.h"
#include "threads.h"
#include "watch.h"

struct srv_reactor {
    struct srv_server server; /* first */
    struct srv_listener listener;
    uint32_t closed_since_trim; /* connections */
    bool grace_over;            /* requests in flight have been cancelled */
    bool has_let_go;            /* of the socket's path: go with the last client */
    struct srv_wakeup wakeup;   /* rung when a thread has finished jobs */
    uv_signal_t sigterm;
    uv_signal_t sigint;
    uv_signal_t sighup;
    uv_timer_t idle;  /* until we go because nobody is here */
    uv_timer_t grace; /* until requests in flight are cancelled, then until we give up */
    struct srv_heartbeat heartbeat; /* of which the service manager is told */
    uv_timer_t report;              /* until what the log has left out is said */
    uv_prepare_t stopper; /* looks, before each wait, whether the next phase can begin */
    uv_prepare_t sender;  /* lets, before each wait, what is kept of answers go */
    struct srv_awake awake;
};

static struct srv_reactor *reactor_of(struct srv_server *server)
{
    return (struct srv_reactor *)(void *)server;
}

#define PRIVATE_WAIT_MS 10000u /* for the first client of a private daemon */
#define LAST_TURNS      16     /* for what has come before a connection is closed */
#define REPORT_MS       1000u  /* from a line that is left out until it is told of */
#define FORCE_MS        5000u  /* for a cancelled request to let go */

/* ---- stopping ---------------------------------------------------------------------- */

static void close_if_open(uv_handle_t *handle)
{
    if (!uv_is_closing(handle)) {
        uv_close(handle, NULL);
    }
}

/* The service's; a second time is nothing. */
static void close_timers(struct srv_reactor *reactor)
{
    srv_linger_deinit(&reactor->server.service);
    srv_spare_runner_deinit(&reactor->server.service.spare_runner);
    srv_reclaim_deinit(&reactor->server.service.reclaim);
    srv_stray_deinit(&reactor->server.service);
    srv_deadlines_deinit(&reactor->server.service.deadlines);
}

static void close_handles(struct srv_reactor *reactor)
{
    if (!uv_is_closing((uv_handle_t *)&reactor->wakeup.poll)) {
        srv_wakeup_close(&reactor->wakeup);
    }
    close_if_open((uv_handle_t *)&reactor->sigterm);
    close_if_open((uv_handle_t *)&reactor->sigint);
    close_if_open((uv_handle_t *)&reactor->sighup);
    close_if_open((uv_handle_t *)&reactor->idle);
    close_if_open((uv_handle_t *)&reactor->grace);
    close_if_open((uv_handle_t *)&reactor->report);
    close_if_open((uv_handle_t *)&reactor->stopper);
    close_if_open((uv_handle_t *)&reactor->sender);
    close_if_open((uv_handle_t *)&reactor->awake.idle);
    close_if_open((uv_handle_t *)&reactor->heartbeat.timer);
    close_timers(reactor);
}

/* Close every connection; what a client has sent meanwhile is answered first, so that it
 * sees the answers and not a reset. */
static void close_conns(struct srv_reactor *reactor)
{
    for (struct srv_conn *conn = reactor->server.conns; conn != NULL;) {
        struct srv_conn *next = conn->next;
        for (int i = 0; i < LAST_TURNS && conn->fd >= 0 && conn->state == SRV_CONN_OPEN;
             i++) {
            srv_conn_read(conn);
        }
        if (conn->fd >= 0) {
            srv_conn_close(conn);
        }
        conn = next;
    }
}

/* Check, before each wait while stopping, whether this phase is over. */
static void on_stopper(uv_prepare_t *prepare)
{
    struct srv_reactor *reactor = prepare->data;
    if (reactor->server.service.phase == SRV_PHASE_DRAINING &&
        reactor->server.service.request_count == 0 &&
        reactor->server.put_off_count == 0 &&
        (reactor->server.reply_count == 0 || reactor->grace_over)) {
        reactor->server.service.phase = SRV_PHASE_CLOSING;
        close_conns(reactor);
    }
    if (reactor->server.service.phase == SRV_PHASE_CLOSING &&
        reactor->server.service.sessions == NULL) {
        reactor->server.service.phase = SRV_PHASE_CLOSED;
        srv_compute_stop(&reactor->server.service.compute);
        srv_compute_stop(&reactor->server.service.pages);
        close_handles(reactor);
    }
}

/* The compute thread does not let go: a step that ignores its flag is our bug. */
static void on_force(uv_timer_t *timer)
{
    (void)timer;
    srv_log(SRV_LOG_ERROR, 0, "a cancelled request does not end; giving up");
    _exit(1);
}

static void on_grace(uv_timer_t *timer)
{
    struct srv_reactor *reactor = timer->data;
    if (reactor->server.service.phase != SRV_PHASE_DRAINING || reactor->grace_over) {
        return;
    }
    reactor->grace_over = true;
    srv_log(SRV_LOG_WARN, 0, "the grace time is over: cancelling %u %s",
            reactor->server.service.request_count,
            proto_plural(reactor->server.service.request_count, "request", "requests"));
    for (struct srv_session *session = reactor->server.service.sessions;
         session != NULL;) {
        struct srv_session *next = session->next; /* a closed one may free itself */
        srv_request_cancel_all(session);
        session = next;
    }
    uv_timer_start(&reactor->grace, on_force, FORCE_MS, 0);
}

static void shut_down(struct srv_reactor *reactor, const char *why)
{
    srv_assert_loop();
    if (reactor->server.service.phase != SRV_PHASE_RUNNING) {
        return;
    }
    srv_log(SRV_LOG_INFO, 0, "shutting down: %s; %u %s, %u %s in flight", why,
            reactor->server.service.client_count,
            proto_plural(reactor->server.service.client_count, "client", "clients"),
            reactor->server.service.request_count,
            proto_plural(reactor->server.service.request_count, "request", "requests"));
    reactor->server.service.phase = SRV_PHASE_DRAINING;
    srv_notify_announce("STOPPING=1");
    srv_listener_close(&reactor->listener);
    uv_timer_stop(&reactor->idle);
    srv_linger_end_all(&reactor->server.service); /* nobody can come back any more */
    srv_hold_end_all(&reactor->server.service); /* nobody may submit what they wait for */
    srv_dispatch_goaway(&reactor->server.service, PCCD_E_SHUTDOWN,
                        "the daemon is shutting down");
    uv_timer_start(&reactor->grace, on_grace,
                   (uint64_t)reactor->server.service.options->grace_s * 1000, 0);
    uv_prepare_start(&reactor->stopper, on_stopper);
}

static void on_path_lost(struct srv_server *server, const char *why)
{
    struct srv_reactor *reactor = reactor_of(server);
    srv_assert_loop();
    if (reactor->server.service.phase != SRV_PHASE_RUNNING || reactor->has_let_go) {
        return;
    }
    srv_log(SRV_LOG_ERROR, 0, "%s: %s; giving up this path, %u %s",
            reactor->server.service.options->socket_path, why,
            reactor->server.service.client_count,
            proto_plural(reactor->server.service.client_count,
                         "client is served until it leaves",
                         "clients are served until they leave"));
    reactor->has_let_go = true;
    srv_listener_close(&reactor->listener);
    if (reactor->server.lockfile != NULL) {
        srv_lockfile_release(reactor->server.lockfile);
    }
    srv_linger_end_all(&reactor->server.service); /* nobody can come back any more */
    if (reactor->server.service.client_count == 0) {
        shut_down(reactor, "nobody can find it");
    }
}

static void on_signal(uv_signal_t *signal, int number)
{
    struct srv_reactor *reactor = signal->data;
    if (reactor->server.service.phase == SRV_PHASE_RUNNING) {
        shut_down(reactor, number == SIGTERM ? "SIGTERM" : "SIGINT");
    } else {
        on_grace(&reactor->grace); /* asked twice: no more patience */
    }
}

/* An operator has changed the configuration file, or has renamed that of the log. */
static void on_hangup(uv_signal_t *signal, int number)
{
    struct srv_reactor *reactor = signal->data;
    const struct srv_options *options = reactor->server.service.options;
    (void)number;
    srv_log_reopen();
    if (options->config != NULL) {
        srv_config_reload(&reactor->server.service, srv_option_wrong);
    }
}

/* ---- clients ----------------------------------------------------------------------- */

static void on_idle(uv_timer_t *timer)
{
    shut_down(timer->data, "no client");
}

/* Nobody is here: start to count, if that matters. */
static void watch_idle(struct srv_reactor *reactor, bool first)
{
    const struct srv_options *options = reactor->server.service.options;
    if (reactor->server.service.phase != SRV_PHASE_RUNNING) {
        return;
    }
    if ((options->private_daemon || reactor->has_let_go) && !first) {
        shut_down(reactor, "the last client has gone");
    } else if (options->private_daemon) {
        uv_timer_start(&reactor->idle, on_idle, PRIVATE_WAIT_MS, 0);
    } else if (options->idle_exit_s > 0) {
        uv_timer_start(&reactor->idle, on_idle, (uint64_t)options->idle_exit_s * 1000, 0);
    }
}

void srv_host_client_joined(struct srv_service *service)
{
    struct srv_reactor *reactor = reactor_of(srv_server_of(service));
    service->client_count++;
    uv_timer_stop(&reactor->idle);
    srv_heartbeat_change(&reactor->heartbeat);
}

void srv_host_client_left(struct srv_service *service)
{
    struct srv_reactor *reactor = reactor_of(srv_server_of(service));
    PCCD_ASSERT(service->client_count > 0);
    if (--service->client_count == 0) {
        watch_idle(reactor, false);
    }
    srv_heartbeat_change(&reactor->heartbeat);
}

/* The heap is trimmed after so many: what clients had lies scattered over it, freed but
 * not given back by itself. It takes about a millisecond. */
#define CLOSED_PER_TRIM 256u

static void on_conn_closed(struct srv_server *server)
{
    struct srv_reactor *reactor = reactor_of(server);
    PCCD_ASSERT(reactor->server.conn_count > 0);
    reactor->server.conn_count--;
    if (reactor->server.conn_count == 0 ||
        ++reactor->closed_since_trim == CLOSED_PER_TRIM) {
        reactor->closed_since_trim = 0;
        (void)malloc_trim(0);
    }
}

/* ---- starting ---------------------------------------------------------------------- */

static void on_completions(void *context)
{
    struct srv_reactor *reactor = context;
    srv_request_send_open(&reactor->server.service);
    srv_compute_drain(&reactor->server.service.compute);
    srv_compute_drain(&reactor->server.service.pages);
}

/* [compute] */
static void on_notify(void *context)
{
    struct srv_reactor *reactor = context;
    srv_wakeup_ring(&reactor->wakeup);
}

/* Return the threads of that runner's team. */
static uint32_t threads_of(const struct srv_service *service, uint32_t number)
{
    return number < SRV_PLACES ? service->start_options->threads_max : 1;
}

/* Make the team before the first step wants it. [compute] */
static void on_enter(void *context, uint32_t number)
{
    const struct srv_reactor *reactor = context;
    const struct srv_service *service = &reactor->server.service;
    eng_payer()->number = number;
    eng_payer()->threads_max = threads_of(service, number);
    srv_crash_thread();
    eng_affinity_warm_up(service->is_pinned ? service->workspaces[number].affinity : NULL,
                         eng_payer()->threads_max);
}

/* The runtime ends the process when it is refused a thread of a team. */
int srv_host_start_runner(struct srv_service *service)
{
    uint32_t threads = threads_of(service, service->compute.runner_count);
    return srv_threads_granted(threads, 1) < threads
               ? PCCD_E_SYSTEM
               : srv_compute_add_runner(&service->compute);
}

/* Clients that come and go without end kept a processor busy with their rings, and the
 * team of the steps shared it. [pages] */
static void on_enter_pages(void *context, uint32_t number)
{
    (void)context;
    (void)number;
    srv_crash_thread();
    srv_priority_behind();
}

/* Before any thread is bound or made: they inherit where this one may run. */
static void choose_affinity(struct srv_reactor *reactor)
{
    const struct srv_options *options = reactor->server.service.options;
    reactor->server.service.is_pinned =
        options->pin == SRV_PIN_ON ||
        (options->pin == SRV_PIN_AUTO &&
         options->threads_max == reactor->server.service.workspaces[0].affinity->count);
    struct proto_STATS_result *counters = &reactor->server.service.metrics.counters;
    counters->threads_bound = reactor->server.service.is_pinned;
    counters->processors = reactor->server.service.workspaces[0].affinity->count;
    counters->processors_allowed = srv_processors_allowed();
}

static void on_report(uv_timer_t *timer)
{
    (void)timer;
    srv_log_report();
}

/* Before each wait. */
static void on_sender(uv_prepare_t *prepare)
{
    struct srv_reactor *reactor = prepare->data;
    srv_conn_send_kept(&reactor->server);
    srv_awake_before_wait(&reactor->awake);
    if (srv_log_owes_report() && !uv_is_active((uv_handle_t *)&reactor->report) &&
        !uv_is_closing((uv_handle_t *)&reactor->report)) {
        uv_timer_start(&reactor->report, on_report, REPORT_MS, 0);
    }
}

static int init_buffers(struct srv_reactor *reactor)
{
    reactor->server.buffer = malloc(PROTO_MESSAGE_BYTES_MAX);
    reactor->server.closer = srv_closer_new();
    return reactor->server.closer != NULL && reactor->server.buffer != NULL
               ? 0
               : PCCD_E_NOMEM;
}

static void deinit_buffers(struct srv_reactor *reactor)
{
    free(reactor->server.buffer);
    srv_closer_free(reactor->server.closer);
}

/* Every handle, so that close_handles may close every one. libuv's own failures here are
 * those of memory and descriptors. */
static int init_handles(struct srv_reactor *reactor)
{
    int status =
        srv_wakeup_init(&reactor->wakeup, &reactor->server.uv, on_completions, reactor);
    if (status != 0) {
        return status;
    }
    uv_timer_init(&reactor->server.uv, &reactor->idle);
    uv_timer_init(&reactor->server.uv, &reactor->grace);
    uv_timer_init(&reactor->server.uv, &reactor->report);
    uv_prepare_init(&reactor->server.uv, &reactor->stopper);
    uv_prepare_init(&reactor->server.uv, &reactor->sender);
    srv_awake_init(&reactor->awake, &reactor->server.uv, &reactor->server.service);
    reactor->sender.data = reactor;
    uv_prepare_start(&reactor->sender, on_sender);
    srv_heartbeat_init(&reactor->heartbeat, &reactor->server.uv,
                       &reactor->server.service);
    uv_signal_init(&reactor->server.uv, &reactor->sigterm);
    uv_signal_init(&reactor->server.uv, &reactor->sigint);
    uv_signal_init(&reactor->server.uv, &reactor->sighup);
    reactor->idle.data = reactor;
    reactor->grace.data = reactor;
    reactor->stopper.data = reactor;
    reactor->sigterm.data = reactor;
    reactor->sigint.data = reactor;
    reactor->sighup.data = reactor;
    if (uv_signal_start(&reactor->sigterm, on_signal, SIGTERM) != 0 ||
        uv_signal_start(&reactor->sigint, on_signal, SIGINT) != 0 ||
        uv_signal_start(&reactor->sighup, on_hangup, SIGHUP) != 0) {
        close_handles(reactor);
        return PCCD_E_SYSTEM;
    }
    sigset_t hangup; /* may have come since the files were read (main.c) */
    sigemptyset(&hangup);
    sigaddset(&hangup, SIGHUP);
    sigprocmask(SIG_UNBLOCK, &hangup, NULL);
    return 0;
}

static int start_queues(struct srv_reactor *reactor)
{
    struct srv_service *service = &reactor->server.service;
    struct srv_compute_settings settings = {.capacity = service->options->queue_max,
                                            .place_max = SRV_PLACES,
                                            .runner_max = SRV_RUNNERS_MAX,
                                            .enter = on_enter,
                                            .notify = on_notify,
                                            .context = reactor};
    int status = srv_compute_start(&service->compute, &settings);
    if (status == 0) {
        srv_spare_runner_begin(&service->spare_runner);
        status = srv_reclaim_init(&service->reclaim, service);
    }
    if (status == 0) {
        status = srv_stray_init(service);
    }
    if (status == 0) {
        settings.place_max = 1;
        settings.runner_max = 1;
        settings.enter = on_enter_pages;
        status = srv_compute_start(&service->pages, &settings);
    }
    return status;
}

/* With everything allocated: serve. */
static int serve(struct srv_reactor *reactor)
{
    struct srv_config_kept *kept = srv_kept_take();
    int status = init_handles(reactor);
    srv_priority_punctual(); /* the team sleeps for 20 us at a time where it must */
    if (status != 0) {
        srv_log(SRV_LOG_ERROR, 0, "the event loop cannot be set up");
        uv_run(&reactor->server.uv, UV_RUN_DEFAULT); /* close what there is */
        return status;
    }
    status = start_queues(reactor);
    if (status != 0) {
        srv_log(SRV_LOG_ERROR, 0, "the threads that compute cannot be started");
    } else {
        status = srv_listener_open(&reactor->listener,
                                   &reactor->server); /* says itself what is wrong */
    }
    if (status == 0) {
        srv_lifeline_raise(reactor->listener.fd_count);
        status = srv_listener_follow(&reactor->listener);
        srv_priority_prompt(); /* the other threads are there, and do not inherit it */
    }
    if (status == 0) {
        status = srv_sandbox_enter(reactor->server.service.options);
    }
    /* A spare worker waits here, with all behind it that takes long: threads take 5 ms to
     * start, and the kernel some 10 ms to take the sandbox's filter. */
    if (status == 0 && !srv_standby()) {
        status = PCCD_E_SHUTDOWN;
    }
    if (status != 0) {
        srv_listener_close(&reactor->listener);
        srv_compute_stop(&reactor->server.service.compute);
        srv_compute_stop(&reactor->server.service.pages);
        close_handles(reactor);
    } else {
        srv_log(SRV_LOG_INFO, 0, "process %ld listens on %s, %s, %u %s%s%s",
                (long)getpid(), reactor->server.service.options->socket_path,
                eng_kernels_name(eng_kernels()),
                reactor->server.service.options->threads_max,
                proto_plural((uint64_t)reactor->server.service.options->threads_max,
                             "thread", "threads"),
                reactor->server.service.is_pinned ? ", each bound to a processor" : "",
                srv_sandbox_text());
        if (reactor->server.service.options->listen_fd <
            0) { /* else it listened before us */
            srv_listener_tell_ready(reactor->server.service.options->ready_fd);
        }
        reactor->server.service.start_ns = common_now_ns();
        srv_config_restore(&reactor->server.service, kept);
        srv_listener_room(&reactor->listener); /* from here on clients are taken over */
        watch_idle(reactor, true);
        srv_heartbeat_ready(&reactor->heartbeat);
    }
    uv_run(&reactor->server.uv, UV_RUN_DEFAULT); /* until the last handle is closed */
    return status;
}

int srv_reactor_run(const struct srv_options *options, struct srv_lockfile *lockfile)
{
    struct eng_affinity processors;
    srv_thread_enter(SRV_THREAD_LOOP);
    eng_affinity_init(&processors); /* OpenMP's runtime opens its files while it may */
    srv_sandbox_begin(options);
    struct srv_reactor *reactor = calloc(1, sizeof *reactor);
    if (reactor == NULL || uv_loop_init(&reactor->server.uv) != 0) {
        srv_log(SRV_LOG_ERROR, 0, "no memory for the event loop");
        free(reactor);
        return 1;
    }
    reactor->listener.fd = -1;
    reactor->server.conn_closed = on_conn_closed;
    reactor->server.path_lost = on_path_lost;
    reactor->server.lockfile = lockfile;
    int status = srv_service_init(&reactor->server.service, options);
    reactor->server.service.does_brief = true;
    if (status == 0) {
        choose_affinity(reactor);
        status = init_buffers(reactor);
    }
    if (status == 0) {
        status = serve(reactor);
    } else {
        srv_log(SRV_LOG_ERROR, 0, "no memory for the buffers, or no thread");
        close_timers(reactor);
        uv_run(&reactor->server.uv, UV_RUN_DEFAULT);
    }
    int failed = uv_loop_close(&reactor->server.uv);
    PCCD_ASSERT(failed == 0);
    srv_service_deinit(&reactor->server.service);
    deinit_buffers(reactor);
    free(reactor);
    if (status != 0) {
        return 1;
    }
    srv_log_report();
    srv_log(SRV_LOG_INFO, 0, "ended");
    return 0;
}

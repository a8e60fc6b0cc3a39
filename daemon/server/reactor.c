/* reactor.c - the event loop, and what the daemon has besides the service.
 *
 * Room:     server. See reactor.h.
 * Does:     start and stop in order:
 *
 *     RUNNING -- signal, idle, private --> DRAINING
 *     DRAINING -- nothing in flight, all replies sent --> CLOSING
 *     CLOSING -- all sessions freed --> CLOSED --> end
 *
 *           When the grace time ends in DRAINING, requests are cancelled; FORCE_MS later
 *           the process just ends.
 *
 * Does not: poll: an idle daemon is not woken by anything of its own.
 * Threads:  [loop]; on_enter is called on [compute], on_notify also on [pages].
 */
#include "reactor.h"

#include <malloc.h>
#include <signal.h>
#include <stdlib.h>
#include <unistd.h>

#include "activate.h"
#include "closer.h"
#include "conn.h"
#include "crash.h"
#include "dispatch.h"
#include "held.h"
#include "invariant.h"
#include "kernel.h"
#include "lifeline.h"
#include "lockfile.h"
#include "notify.h"
#include "now.h"
#include "pccd_types.h"
#include "plural.h"
#include "priority.h"
#include "proto_limits.h"
#include "sandbox.h"
#include "session.h"
#include "threads.h"

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
    srv_linger_deinit(&reactor->loop);
    srv_relief_deinit(&reactor->loop);
    srv_overdue_deinit(&reactor->loop.overdue);
}

static void close_handles(struct srv_reactor *reactor)
{
    if (!uv_is_closing((uv_handle_t *)&reactor->bell.poll)) {
        srv_bell_close(&reactor->bell);
    }
    close_if_open((uv_handle_t *)&reactor->sigterm);
    close_if_open((uv_handle_t *)&reactor->sigint);
    close_if_open((uv_handle_t *)&reactor->idle);
    close_if_open((uv_handle_t *)&reactor->grace);
    close_if_open((uv_handle_t *)&reactor->report);
    close_if_open((uv_handle_t *)&reactor->stopper);
    close_if_open((uv_handle_t *)&reactor->sender);
    close_if_open((uv_handle_t *)&reactor->pulse.timer);
    close_timers(reactor);
}

/* Close every connection; what a client has sent meanwhile is answered first, so that it
 * sees the answers and not a reset. */
static void close_conns(struct srv_reactor *reactor)
{
    for (struct srv_conn *conn = reactor->conns; conn != NULL;) {
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

/* Before each wait while stopping: is this phase over? */
static void on_stopper(uv_prepare_t *prepare)
{
    struct srv_reactor *reactor = prepare->data;
    if (reactor->loop.phase == SRV_PHASE_DRAINING && reactor->loop.request_count == 0 &&
        reactor->put_off_count == 0 &&
        (reactor->reply_count == 0 || reactor->grace_over)) {
        reactor->loop.phase = SRV_PHASE_CLOSING;
        close_conns(reactor);
    }
    if (reactor->loop.phase == SRV_PHASE_CLOSING && reactor->loop.sessions == NULL) {
        reactor->loop.phase = SRV_PHASE_CLOSED;
        srv_compute_stop(&reactor->loop.compute);
        srv_compute_stop(&reactor->loop.pages);
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
    if (reactor->loop.phase != SRV_PHASE_DRAINING || reactor->grace_over) {
        return;
    }
    reactor->grace_over = true;
    srv_log(SRV_LOG_WARN, 0, "the grace time is over: cancelling %u %s",
            reactor->loop.request_count,
            proto_plural(reactor->loop.request_count, "request", "requests"));
    for (struct srv_session *session = reactor->loop.sessions; session != NULL;) {
        struct srv_session *next = session->next; /* a closed one may free itself */
        srv_session_cancel_all(session);
        session = next;
    }
    uv_timer_start(&reactor->grace, on_force, FORCE_MS, 0);
}

void srv_reactor_shutdown(struct srv_reactor *reactor, const char *why)
{
    srv_assert_loop();
    if (reactor->loop.phase != SRV_PHASE_RUNNING) {
        return;
    }
    srv_log(SRV_LOG_INFO, 0, "shutting down: %s; %u %s, %u %s in flight", why,
            reactor->loop.client_count,
            proto_plural(reactor->loop.client_count, "client", "clients"),
            reactor->loop.request_count,
            proto_plural(reactor->loop.request_count, "request", "requests"));
    reactor->loop.phase = SRV_PHASE_DRAINING;
    srv_notify_announce("STOPPING=1");
    srv_listener_close(&reactor->listener);
    uv_timer_stop(&reactor->idle);
    srv_linger_end_all(&reactor->loop); /* nobody can come back any more */
    srv_held_end_all(&reactor->loop);   /* nobody may submit what they wait for */
    srv_dispatch_goaway(&reactor->loop, PCCD_E_SHUTDOWN, "the daemon is shutting down");
    uv_timer_start(&reactor->grace, on_grace,
                   (uint64_t)reactor->loop.options->grace_s * 1000, 0);
    uv_prepare_start(&reactor->stopper, on_stopper);
}

void srv_reactor_let_go(struct srv_reactor *reactor, const char *why)
{
    srv_assert_loop();
    if (reactor->loop.phase != SRV_PHASE_RUNNING || reactor->has_let_go) {
        return;
    }
    srv_log(SRV_LOG_ERROR, 0, "%s: %s; letting go of it, %u %s",
            reactor->loop.options->socket_path, why, reactor->loop.client_count,
            proto_plural(reactor->loop.client_count, "client is served until it leaves",
                         "clients are served until they leave"));
    reactor->has_let_go = true;
    srv_listener_close(&reactor->listener);
    if (reactor->lockfile != NULL) {
        srv_lockfile_release(reactor->lockfile);
    }
    srv_linger_end_all(&reactor->loop); /* nobody can come back any more */
    if (reactor->loop.client_count == 0) {
        srv_reactor_shutdown(reactor, "nobody can find it");
    }
}

static void on_signal(uv_signal_t *signal, int number)
{
    struct srv_reactor *reactor = signal->data;
    if (reactor->loop.phase == SRV_PHASE_RUNNING) {
        srv_reactor_shutdown(reactor, number == SIGTERM ? "SIGTERM" : "SIGINT");
    } else {
        on_grace(&reactor->grace); /* asked twice: no more patience */
    }
}

/* ---- clients ----------------------------------------------------------------------- */

static void on_idle(uv_timer_t *timer)
{
    srv_reactor_shutdown(timer->data, "no client");
}

/* Nobody is here: start to count, if that matters. */
static void watch_idle(struct srv_reactor *reactor, bool first)
{
    const struct srv_options *options = reactor->loop.options;
    if (reactor->loop.phase != SRV_PHASE_RUNNING) {
        return;
    }
    if ((options->private_daemon || reactor->has_let_go) && !first) {
        srv_reactor_shutdown(reactor, "the last client has gone");
    } else if (options->private_daemon) {
        uv_timer_start(&reactor->idle, on_idle, PRIVATE_WAIT_MS, 0);
    } else if (options->idle_exit_s > 0) {
        uv_timer_start(&reactor->idle, on_idle, (uint64_t)options->idle_exit_s * 1000, 0);
    }
}

void srv_host_client_joined(struct srv_loop *loop)
{
    struct srv_reactor *reactor = (struct srv_reactor *)loop;
    loop->client_count++;
    uv_timer_stop(&reactor->idle);
    srv_pulse_change(&reactor->pulse);
}

void srv_host_client_left(struct srv_loop *loop)
{
    struct srv_reactor *reactor = (struct srv_reactor *)loop;
    PCCD_ASSERT(loop->client_count > 0);
    if (--loop->client_count == 0) {
        watch_idle(reactor, false);
    }
    srv_pulse_change(&reactor->pulse);
}

void srv_host_limit_changed(struct srv_loop *loop)
{
    srv_listener_room(&((struct srv_reactor *)loop)->listener);
}

/* What clients had lies scattered over the heap: freed, but not given back by itself. It
 * takes about a millisecond. */
#define CLOSED_PER_TRIM 256u

void srv_reactor_conn_closed(struct srv_reactor *reactor)
{
    PCCD_ASSERT(reactor->conn_count > 0);
    reactor->conn_count--;
    srv_listener_room(&reactor->listener);
    if (reactor->conn_count == 0 || ++reactor->closed_since_trim == CLOSED_PER_TRIM) {
        reactor->closed_since_trim = 0;
        (void)malloc_trim(0);
    }
}

/* ---- starting ---------------------------------------------------------------------- */

static void on_completions(void *context)
{
    struct srv_reactor *reactor = context;
    srv_compute_drain(&reactor->loop.compute);
    srv_compute_drain(&reactor->loop.pages);
}

/* [compute] */
static void on_notify(void *context)
{
    struct srv_reactor *reactor = context;
    srv_bell_ring(&reactor->bell);
}

/* Make the team before the first step wants it. [compute] */
static void on_enter(void *context, uint32_t number)
{
    const struct srv_reactor *reactor = context;
    const struct srv_loop *loop = &reactor->loop;
    eng_payer()->number = number;
    srv_crash_thread();
    eng_places_warm_up(loop->is_pinned ? &loop->desks[number].places : NULL,
                       loop->start_options->threads_max);
}

/* The runtime ends the process when it is refused a thread of a team. */
int srv_host_start_runner(struct srv_loop *loop)
{
    uint32_t threads = loop->start_options->threads_max;
    return srv_threads_granted(threads, 1) < threads
               ? PCCD_E_SYSTEM
               : srv_compute_add_runner(&loop->compute);
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
static void choose_places(struct srv_reactor *reactor)
{
    const struct srv_options *options = reactor->loop.options;
    reactor->loop.is_pinned =
        options->pin == SRV_PIN_ON ||
        (options->pin == SRV_PIN_AUTO &&
         options->threads_max == reactor->loop.desks[0].places.count);
    reactor->loop.metrics.counters.threads_bound = reactor->loop.is_pinned;
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
    srv_conn_send_kept(reactor);
    if (srv_log_owes_report() && !uv_is_active((uv_handle_t *)&reactor->report) &&
        !uv_is_closing((uv_handle_t *)&reactor->report)) {
        uv_timer_start(&reactor->report, on_report, REPORT_MS, 0);
    }
}

static int init_buffers(struct srv_reactor *reactor)
{
    reactor->buffer = malloc(PROTO_MESSAGE_BYTES_MAX);
    reactor->closer = srv_closer_new();
    return reactor->closer != NULL && reactor->buffer != NULL ? 0 : PCCD_E_NOMEM;
}

static void deinit_buffers(struct srv_reactor *reactor)
{
    free(reactor->buffer);
    srv_closer_free(reactor->closer);
}

/* Every handle, so that close_handles may close every one. libuv's own failures here are
 * those of memory and descriptors. */
static int init_handles(struct srv_reactor *reactor)
{
    int status = srv_bell_init(&reactor->bell, &reactor->uv, on_completions, reactor);
    if (status != 0) {
        return status;
    }
    uv_timer_init(&reactor->uv, &reactor->idle);
    uv_timer_init(&reactor->uv, &reactor->grace);
    uv_timer_init(&reactor->uv, &reactor->report);
    uv_prepare_init(&reactor->uv, &reactor->stopper);
    uv_prepare_init(&reactor->uv, &reactor->sender);
    reactor->sender.data = reactor;
    uv_prepare_start(&reactor->sender, on_sender);
    srv_pulse_init(&reactor->pulse, &reactor->uv, &reactor->loop);
    uv_signal_init(&reactor->uv, &reactor->sigterm);
    uv_signal_init(&reactor->uv, &reactor->sigint);
    reactor->idle.data = reactor;
    reactor->grace.data = reactor;
    reactor->stopper.data = reactor;
    reactor->sigterm.data = reactor;
    reactor->sigint.data = reactor;
    if (uv_signal_start(&reactor->sigterm, on_signal, SIGTERM) != 0 ||
        uv_signal_start(&reactor->sigint, on_signal, SIGINT) != 0) {
        close_handles(reactor);
        return PCCD_E_SYSTEM;
    }
    return 0;
}

static int start_queues(struct srv_reactor *reactor)
{
    struct srv_loop *loop = &reactor->loop;
    int status = srv_compute_start(&loop->compute, loop->options->queue_max,
                                   SRV_RUNNERS_MAX, on_enter, on_notify, reactor);
    if (status == 0) {
        srv_relief_begin(loop);
        status = srv_compute_start(&loop->pages, loop->options->queue_max, 1,
                                   on_enter_pages, on_notify, reactor);
    }
    return status;
}

/* With everything allocated: serve. */
static int serve(struct srv_reactor *reactor)
{
    int status = init_handles(reactor);
    srv_priority_punctual(); /* the team sleeps for 20 us at a time where it must */
    if (status != 0) {
        srv_log(SRV_LOG_ERROR, 0, "the event loop cannot be set up");
        uv_run(&reactor->uv, UV_RUN_DEFAULT); /* close what there is */
        return status;
    }
    status = start_queues(reactor);
    if (status != 0) {
        srv_log(SRV_LOG_ERROR, 0, "the threads that compute cannot be started");
    } else {
        status = srv_listener_open(&reactor->listener,
                                   reactor); /* says itself what is wrong */
    }
    if (status == 0) {
        srv_lifeline_raise(reactor->listener.fd_count);
        status = srv_listener_follow(&reactor->listener);
        srv_priority_prompt(); /* the other threads are there, and do not inherit it */
    }
    if (status == 0) {
        status = srv_sandbox_enter(reactor->loop.options);
    }
    /* A spare worker waits here, with all behind it that takes long: threads take 5 ms to
     * start, and the kernel some 10 ms to take the sandbox's filter. */
    if (status == 0 && !srv_standby()) {
        status = PCCD_E_SHUTDOWN;
    }
    if (status != 0) {
        srv_listener_close(&reactor->listener);
        srv_compute_stop(&reactor->loop.compute);
        srv_compute_stop(&reactor->loop.pages);
        close_handles(reactor);
    } else {
        srv_log(SRV_LOG_INFO, 0, "process %ld listens on %s, %s, %u %s%s%s",
                (long)getpid(), reactor->loop.options->socket_path, eng_kernels()->name,
                reactor->loop.options->threads_max,
                proto_plural((uint64_t)reactor->loop.options->threads_max, "thread",
                             "threads"),
                reactor->loop.is_pinned ? ", each bound to a processor" : "",
                srv_sandbox_text());
        if (reactor->loop.options->listen_fd < 0) { /* else it listened before us */
            srv_listener_tell_ready(reactor->loop.options->ready_fd);
        }
        reactor->loop.start_ns = srv_now_ns();
        srv_listener_room(&reactor->listener); /* from here on clients are taken over */
        watch_idle(reactor, true);
        srv_pulse_ready(&reactor->pulse);
    }
    uv_run(&reactor->uv, UV_RUN_DEFAULT); /* until the last handle is closed */
    return status;
}

int srv_reactor_run(const struct srv_options *options, struct srv_lockfile *lockfile)
{
    srv_thread_enter(SRV_THREAD_LOOP);
    srv_sandbox_keep_files(options);
    struct srv_reactor *reactor = calloc(1, sizeof *reactor);
    if (reactor == NULL || uv_loop_init(&reactor->uv) != 0) {
        srv_log(SRV_LOG_ERROR, 0, "no memory for the event loop");
        free(reactor);
        return 1;
    }
    reactor->listener.fd = -1;
    reactor->lockfile = lockfile;
    int status = srv_loop_init(&reactor->loop, options);
    choose_places(reactor);
    reactor->loop.does_brief = true;
    if (status == 0) {
        status = init_buffers(reactor);
    }
    if (status == 0) {
        status = serve(reactor);
    } else {
        srv_log(SRV_LOG_ERROR, 0, "no memory for the buffers, or no thread");
        close_timers(reactor);
        uv_run(&reactor->uv, UV_RUN_DEFAULT);
    }
    int failed = uv_loop_close(&reactor->uv);
    PCCD_ASSERT(failed == 0);
    srv_loop_deinit(&reactor->loop);
    deinit_buffers(reactor);
    free(reactor);
    if (status != 0) {
        return 1;
    }
    srv_log_report();
    srv_log(SRV_LOG_INFO, 0, "ended");
    return 0;
}

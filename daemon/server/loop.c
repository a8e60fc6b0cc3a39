/* loop.c - the event loop, and everything there is one of.
 *
 * Room:     server. See loop.h.
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
#include "loop.h"

#include <malloc.h>
#include <signal.h>
#include <stdlib.h>
#include <sys/random.h>
#include <unistd.h>

#include "activate.h"
#include "closer.h"
#include "conn.h"
#include "dispatch.h"
#include "invariant.h"
#include "kernel.h"
#include "lifeline.h"
#include "limits.h"
#include "now.h"
#include "pccd_types.h"
#include "priority.h"
#include "sandbox.h"
#include "session.h"

#define PRIVATE_WAIT_MS 10000u /* for the first client of a private daemon */
#define LAST_TURNS      16     /* for what has come before a connection is closed */
#define FORCE_MS        5000u  /* for a cancelled request to let go */

/* ---- stopping ---------------------------------------------------------------------- */

static void close_if_open(uv_handle_t *handle)
{
    if (!uv_is_closing(handle)) {
        uv_close(handle, NULL);
    }
}

static void close_handles(struct srv_loop *loop)
{
    if (!uv_is_closing((uv_handle_t *)&loop->bell.poll)) {
        srv_bell_close(&loop->bell);
    }
    close_if_open((uv_handle_t *)&loop->sigterm);
    close_if_open((uv_handle_t *)&loop->sigint);
    close_if_open((uv_handle_t *)&loop->idle);
    close_if_open((uv_handle_t *)&loop->grace);
    close_if_open((uv_handle_t *)&loop->stopper);
    close_if_open((uv_handle_t *)&loop->linger.timer);
    srv_overdue_close(&loop->overdue);
}

/* Close every connection; what a client has sent meanwhile is answered first, so that it
 * sees the answers and not a reset. */
static void close_conns(struct srv_loop *loop)
{
    for (struct srv_conn *conn = loop->conns; conn != NULL;) {
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
    struct srv_loop *loop = prepare->data;
    if (loop->phase == SRV_PHASE_DRAINING && loop->request_count == 0 &&
        loop->put_off_count == 0 &&
        (loop->reply_count == 0 || loop->grace_over)) {
        loop->phase = SRV_PHASE_CLOSING;
        close_conns(loop);
    }
    if (loop->phase == SRV_PHASE_CLOSING && loop->sessions == NULL) {
        loop->phase = SRV_PHASE_CLOSED;
        srv_compute_stop(&loop->compute);
        srv_compute_stop(&loop->pages);
        close_handles(loop);
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
    struct srv_loop *loop = timer->data;
    if (loop->phase != SRV_PHASE_DRAINING || loop->grace_over) {
        return;
    }
    loop->grace_over = true;
    srv_log(SRV_LOG_WARN, 0, "the grace time is over: cancelling %u requests",
            loop->request_count);
    for (struct srv_session *session = loop->sessions; session != NULL;) {
        struct srv_session *next = session->next; /* a closed one may free itself */
        srv_session_cancel_all(session);
        session = next;
    }
    uv_timer_start(&loop->grace, on_force, FORCE_MS, 0);
}

void srv_loop_shutdown(struct srv_loop *loop, const char *why)
{
    srv_assert_loop();
    if (loop->phase != SRV_PHASE_RUNNING) {
        return;
    }
    srv_log(SRV_LOG_INFO, 0, "shutting down: %s; %u clients, %u requests in flight", why,
            loop->client_count, loop->request_count);
    loop->phase = SRV_PHASE_DRAINING;
    srv_listener_close(&loop->listener);
    uv_timer_stop(&loop->idle);
    srv_linger_end_all(loop); /* nobody can come back any more */
    srv_dispatch_goaway(loop, PCCD_E_SHUTDOWN, "the daemon is shutting down");
    uv_timer_start(&loop->grace, on_grace, (uint64_t)loop->options->grace_s * 1000, 0);
    uv_prepare_start(&loop->stopper, on_stopper);
}

static void on_signal(uv_signal_t *signal, int number)
{
    struct srv_loop *loop = signal->data;
    if (loop->phase == SRV_PHASE_RUNNING) {
        srv_loop_shutdown(loop, number == SIGTERM ? "SIGTERM" : "SIGINT");
    } else {
        on_grace(&loop->grace); /* asked twice: no more patience */
    }
}

/* ---- clients ----------------------------------------------------------------------- */

static void on_idle(uv_timer_t *timer)
{
    srv_loop_shutdown(timer->data, "no client");
}

/* Nobody is here: start to count, if that matters. */
static void watch_idle(struct srv_loop *loop, bool first)
{
    const struct srv_options *options = loop->options;
    if (loop->phase != SRV_PHASE_RUNNING) {
        return;
    }
    if (options->private_daemon && !first) {
        srv_loop_shutdown(loop, "the last client has gone");
    } else if (options->private_daemon) {
        uv_timer_start(&loop->idle, on_idle, PRIVATE_WAIT_MS, 0);
    } else if (options->idle_exit_s > 0) {
        uv_timer_start(&loop->idle, on_idle, (uint64_t)options->idle_exit_s * 1000, 0);
    }
}

void srv_loop_client_joined(struct srv_loop *loop)
{
    loop->client_count++;
    uv_timer_stop(&loop->idle);
}

void srv_loop_client_left(struct srv_loop *loop)
{
    PCCD_ASSERT(loop->client_count > 0);
    if (--loop->client_count == 0) {
        watch_idle(loop, false);
    }
}

/* What clients had lies scattered over the heap: freed, but not given back by itself. It
 * takes about a millisecond. */
#define CLOSED_PER_TRIM 256u

void srv_loop_conn_closed(struct srv_loop *loop)
{
    PCCD_ASSERT(loop->conn_count > 0);
    loop->conn_count--;
    srv_listener_room(&loop->listener);
    if (loop->conn_count == 0 || ++loop->closed_since_trim == CLOSED_PER_TRIM) {
        loop->closed_since_trim = 0;
        (void)malloc_trim(0);
    }
}

/* ---- starting ---------------------------------------------------------------------- */

static void on_completions(void *context)
{
    struct srv_loop *loop = context;
    srv_compute_drain(&loop->compute);
    srv_compute_drain(&loop->pages);
}

/* [compute] */
static void on_notify(void *context)
{
    struct srv_loop *loop = context;
    srv_bell_ring(&loop->bell);
}

/* Make the team before the first step wants it. [compute] */
static void on_enter(void *context)
{
    const struct srv_loop *loop = context;
    eng_places_warm_up(loop->is_pinned ? &loop->places : NULL,
                       loop->options->threads_max);
}

/* Clients that come and go without end kept a processor busy with their rings, and the
 * team of the steps shared it. [pages] */
static void on_enter_pages(void *context)
{
    (void)context;
    srv_priority_behind();
}

/* Before any thread is bound or made: they inherit where this one may run. */
static void choose_places(struct srv_loop *loop)
{
    const struct srv_options *options = loop->options;
    eng_places_init(&loop->places);
    loop->is_pinned =
        options->pin == SRV_PIN_ON ||
        (options->pin == SRV_PIN_AUTO && options->threads_max == loop->places.count);
    loop->metrics.counters.threads_bound = loop->is_pinned;
}

static int init_buffers(struct srv_loop *loop)
{
    loop->decoder = proto_decoder_new();
    loop->encoder = malloc(sizeof *loop->encoder);
    loop->buffer = malloc(PROTO_MESSAGE_BYTES_MAX);
    loop->segments = malloc(PROTO_SEGMENTS_MAX * sizeof *loop->segments);
    loop->closer = srv_closer_new();
    if (loop->closer == NULL || loop->decoder == NULL || loop->encoder == NULL ||
        loop->buffer == NULL || loop->segments == NULL) {
        return PCCD_E_NOMEM;
    }
    return 0;
}

static void deinit_buffers(struct srv_loop *loop)
{
    proto_decoder_free(loop->decoder);
    free(loop->encoder);
    free(loop->buffer);
    free(loop->segments);
    srv_closer_free(loop->closer);
}

/* Every handle, so that close_handles may close every one. libuv's own failures here are
 * those of memory and descriptors. */
static int init_handles(struct srv_loop *loop)
{
    int status = srv_bell_init(&loop->bell, &loop->uv, on_completions, loop);
    if (status != 0) {
        return status;
    }
    uv_timer_init(&loop->uv, &loop->idle);
    uv_timer_init(&loop->uv, &loop->grace);
    uv_prepare_init(&loop->uv, &loop->stopper);
    srv_linger_init(loop);
    srv_overdue_init(&loop->overdue, &loop->uv);
    uv_signal_init(&loop->uv, &loop->sigterm);
    uv_signal_init(&loop->uv, &loop->sigint);
    loop->idle.data = loop;
    loop->grace.data = loop;
    loop->stopper.data = loop;
    loop->sigterm.data = loop;
    loop->sigint.data = loop;
    if (uv_signal_start(&loop->sigterm, on_signal, SIGTERM) != 0 ||
        uv_signal_start(&loop->sigint, on_signal, SIGINT) != 0) {
        close_handles(loop);
        return PCCD_E_SYSTEM;
    }
    return 0;
}

/* A number that differs from start to start. */
static uint64_t make_epoch(void)
{
    uint64_t epoch = 0;
    if (getrandom(&epoch, sizeof epoch, GRND_NONBLOCK) != (ssize_t)sizeof epoch) {
        epoch = srv_now_ns() ^ (uint64_t)getpid() << 32;
    }
    return epoch == 0 ? 1 : epoch; /* 0 means none */
}

/* With everything allocated: serve. */
static int serve(struct srv_loop *loop)
{
    int status = init_handles(loop);
    srv_priority_punctual(); /* the team sleeps for 20 us at a time where it must */
    if (status != 0) {
        srv_log(SRV_LOG_ERROR, 0, "the event loop cannot be set up");
        uv_run(&loop->uv, UV_RUN_DEFAULT); /* close what there is */
        return status;
    }
    status = srv_compute_start(&loop->compute, loop->options->queue_max, on_enter,
                               on_notify, loop);
    if (status == 0) {
        status = srv_compute_start(&loop->pages, loop->options->queue_max, on_enter_pages,
                                   on_notify, loop);
    }
    if (status != 0) {
        srv_log(SRV_LOG_ERROR, 0, "the threads that compute cannot be started");
    } else {
        status = srv_listener_open(&loop->listener, loop); /* says itself what is wrong */
    }
    if (status == 0) {
        srv_lifeline_raise(loop->listener.fd_count);
        srv_priority_prompt(); /* the other threads are there, and do not inherit it */
        status = srv_sandbox_enter(loop->options);
    }
    /* A spare worker waits here, with all behind it that takes long: threads take 5 ms to
     * start, and the kernel some 10 ms to take the sandbox's filter. */
    if (status == 0 && !srv_standby()) {
        status = PCCD_E_SHUTDOWN;
    }
    if (status != 0) {
        srv_listener_close(&loop->listener);
        srv_compute_stop(&loop->compute);
        srv_compute_stop(&loop->pages);
        close_handles(loop);
    } else {
        srv_log(SRV_LOG_INFO, 0, "process %ld listens on %s, %s, %u threads%s",
                (long)getpid(), loop->options->socket_path, eng_kernels()->name,
                loop->options->threads_max,
                loop->is_pinned ? ", each bound to a processor" : "");
        if (loop->options->listen_fd < 0) { /* else it listened before us */
            srv_listener_tell_ready(loop->options->ready_fd);
        }
        loop->start_ns = srv_now_ns();
        srv_listener_room(&loop->listener); /* from here on clients are taken over */
        watch_idle(loop, true);
    }
    uv_run(&loop->uv, UV_RUN_DEFAULT); /* until the last handle is closed */
    return status;
}

int srv_loop_run(const struct srv_options *options)
{
    srv_thread_enter(SRV_THREAD_LOOP);
    struct srv_loop *loop = calloc(1, sizeof *loop);
    if (loop == NULL || uv_loop_init(&loop->uv) != 0) {
        srv_log(SRV_LOG_ERROR, 0, "no memory for the event loop");
        free(loop);
        return 1;
    }
    loop->options = options;
    loop->listener.fd = -1;
    loop->epoch = make_epoch();
    choose_places(loop);
    srv_quota_init(&loop->quota, options->quota);
    int status = init_buffers(loop);
    if (status == 0) {
        status = serve(loop);
    } else {
        srv_log(SRV_LOG_ERROR, 0, "no memory for the buffers, or no thread");
    }
    int failed = uv_loop_close(&loop->uv);
    PCCD_ASSERT(failed == 0);
    srv_quota_deinit(&loop->quota);
    srv_laststep_set(&loop->last_step, NULL);
    deinit_buffers(loop);
    free(loop);
    if (status != 0) {
        return 1;
    }
    srv_log(SRV_LOG_INFO, 0, "ended");
    return 0;
}

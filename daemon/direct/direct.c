/* direct.c - the service in the process of its client.
 *
 * One service for all clients of the process, made with the first and freed with the
 * last; what a message asks for is computed at once, by the thread that brings it.
 */
#include <errno.h>
#include <pthread.h>
#include <sched.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "dispatch.h"
#include "engine.h"
#include "enginemem.h"
#include "inbox.h"
#include "invariant.h"
#include "meshes.h"
#include "now.h"
#include "pccd_types.h"
#include "proto_direct.h"
#include "proto_limits.h"
#include "ringio.h"
#include "service.h"
#include "session.h"
#include "setup.h"
#include "shared.h"
#include "timers.h"
#include "watcher.h"

/* Quotas keep the users of a daemon from each other. Here is one, and the memory is its
 * own: only what no machine has is refused. Half, so that sums do not overflow. */
#define UNLIMITED      (UINT64_MAX / 2)
#define TRIANGLE_BYTES 56u /* of a mesh, at least */

#define CLIENTS_MAX 4096u

struct proto_direct_inbox {
    struct srv_conn conn;            /* first */
    bool (*is_stopped)(void *asked); /* NULL: nobody is asked */
    void *asked;
    void (*write)(void *writer, void *to, const void *from, uint64_t count);
    void *writer;
    void (*weigh)(void *weigher, const struct pccd_pair *pairs, uint32_t count);
    void *weigher;
    uint32_t threads; /* at most, for its messages; 0: as many as others */
};

/* Whose turn it is: everything below, and all that the service has. */
static pthread_mutex_t turn = PTHREAD_MUTEX_INITIALIZER;
static struct srv_options options;
static struct srv_service *the_service; /* NULL: no client */
static struct srv_conn *conns;          /* newest first */
static uint64_t
    reported_ns; /* when something is due, as the descriptors know; 0: never */

/* OpenMP's team does not survive a fork: a copy of the process must not compute. */
static volatile bool is_forked;

static void on_forked(void)
{
    is_forked = true;
}

static void watch_forks(void)
{
    (void)pthread_atfork(NULL, NULL, on_forked);
}

static void take_turn(void)
{
    int failed = pthread_mutex_lock(&turn);
    PCCD_ASSERT(failed == 0);
    srv_thread_enter(SRV_THREAD_LOOP);
    eng_guest_enter();
}

static bool try_turn(void)
{
    int failed = pthread_mutex_trylock(&turn);
    PCCD_ASSERT(failed == 0 || failed == EBUSY);
    if (failed == 0) {
        srv_thread_enter(SRV_THREAD_LOOP);
        eng_guest_enter();
    }
    return failed == 0;
}

static void end_turn(void)
{
    eng_guest_leave();
    srv_thread_enter(SRV_THREAD_OTHER);
    int failed = pthread_mutex_unlock(&turn);
    PCCD_ASSERT(failed == 0);
}

/* ---- what the service asks of its host --------------------------------------------- */

void srv_conn_send_all(struct srv_service *service, const struct proto_encoder *message)
{
    (void)service;
    for (struct srv_conn *conn = conns; conn != NULL; conn = conn->next) {
        srv_conn_send(conn, message, NULL, 0);
    }
}

/* All clients are this process. */
gid_t srv_conn_group(const struct srv_conn *conn)
{
    (void)conn;
    return getegid();
}

bool srv_conn_has_group(const struct srv_conn *conn, gid_t gid)
{
    (void)conn;
    return gid == getegid() || group_member(gid) != 0;
}

void srv_conn_established(struct srv_conn *conn)
{
    (void)conn; /* nobody waits for hello */
}

/* No session waits for its client or for the compute thread, so there is never a message
 * that could come back. */
int srv_conn_put_off(struct srv_conn *conn, const void *message, size_t bytes)
{
    (void)conn;
    (void)message;
    (void)bytes;
    return PCCD_E_LIMIT;
}

void srv_conn_room(struct srv_service *service, const struct srv_quota_user *user)
{
    (void)service;
    (void)user;
}

void srv_conn_orphan(struct srv_conn *conn)
{
    srv_conn_finish(conn);
    conn->session = NULL;
}

void srv_conn_adopt(struct srv_conn *conn, struct srv_session *session)
{
    conn->session = session;
}

void srv_host_client_joined(struct srv_service *service)
{
    service->client_count++;
}

void srv_host_client_left(struct srv_service *service)
{
    PCCD_ASSERT(service->client_count > 0);
    service->client_count--;
}

int srv_host_start_runner(struct srv_service *service)
{
    (void)service;
    return PCCD_E_STATE; /* who asks for something computes it */
}

bool srv_host_is_full(const struct srv_service *service)
{
    (void)service;
    return false; /* whoever asks is the only client */
}

/* ---- the service ------------------------------------------------------------------- */

static uint32_t cpu_count(void)
{
    cpu_set_t cpus;
    return sched_getaffinity(0, sizeof cpus, &cpus) == 0 ? (uint32_t)CPU_COUNT(&cpus) : 1;
}

/* As OpenMP reads it: the number of the outermost level; the processors at hand where it
 * says nothing that makes sense. */
static uint32_t threads_wanted(void)
{
    const char *text = getenv("OMP_NUM_THREADS");
    char *end = NULL;
    errno = 0;
    unsigned long number = text != NULL ? strtoul(text, &end, 10) : 0;
    if (number < 1 || number > UINT16_MAX || errno != 0 ||
        (*end != '\0' && *end != ',' && *end != ' ')) {
        return cpu_count();
    }
    return (uint32_t)number;
}

static void free_service(struct srv_service *service)
{
    srv_service_deinit(service);
    srv_compute_deinit(&service->compute);
    srv_compute_deinit(&service->pages);
    free(service);
}

/* Return the memory of the machine; 2 GiB where it does not say. */
static uint64_t memory_bytes(void)
{
    long pages = sysconf(_SC_PHYS_PAGES);
    long page_bytes = sysconf(_SC_PAGESIZE);
    return pages > 0 && page_bytes > 0 ? (uint64_t)pages * (uint64_t)page_bytes
                                       : 2ull << 30;
}

static struct srv_service *make_service(void)
{
    options = (struct srv_options){
        .threads_max = threads_wanted(),
        .pin = SRV_PIN_OFF,
        .scenes_max = SRV_HANDLE_INDEX_MAX,
        .inflight_max = PROTO_INFLIGHT_MAX,
        .queue_max = CLIENTS_MAX,
        .contacts_max = PROTO_CONTACTS_PER_STEP,
        .quota = {[SRV_QUOTA_CLIENTS] = CLIENTS_MAX,
                  [SRV_QUOTA_SHM_BYTES] = memory_bytes() / 2,
                  [SRV_QUOTA_MESHES] = UNLIMITED,
                  [SRV_QUOTA_TRIANGLES] = memory_bytes() / TRIANGLE_BYTES},
        .engine_bytes_max = UNLIMITED,
        .ready_fd = -1,
        .listen_fd = -1,
        .log_level = SRV_LOG_ERROR,
    };
    srv_log_set_level(options.log_level);
    struct srv_service *service = calloc(1, sizeof *service);
    if (service == NULL || srv_compute_init(&service->compute, options.queue_max) != 0) {
        free(service);
        return NULL;
    }
    if (srv_compute_init(&service->pages, options.queue_max) != 0) {
        srv_compute_deinit(&service->compute);
        free(service);
        return NULL;
    }
    if (srv_service_init(service, &options) != 0) {
        free_service(service);
        return NULL;
    }
    service->is_pinned = true;
    service->lends_pages = true; /* clients are this process */
    service->workspaces[0].affinity->is_guest = true;
    service->start_ns = common_now_ns();
    return service;
}

/* Compute all that there is to, also what comes of it. */
static void work_off(struct srv_service *service)
{
    bool ran = true;
    int cpu = sched_getcpu();
    service->workspaces[0].affinity->first_on = cpu < 0 ? 0 : cpu;
    while (ran) {
        srv_thread_enter(SRV_THREAD_COMPUTE);
        ran = srv_compute_run_next(&service->compute) ||
              srv_compute_run_next(&service->pages);
        srv_thread_enter(SRV_THREAD_LOOP);
        srv_compute_drain(&service->compute);
        srv_compute_drain(&service->pages);
    }
}

/* At the end of a turn. */
static void do_due(void)
{
    if (direct_timers_are_due()) {
        direct_timers_fire();
        work_off(the_service);
    }
    uint64_t at_ns = direct_timers_due_ns();
    if (at_ns != reported_ns) {
        reported_ns = at_ns;
        for (struct srv_conn *conn = conns; conn != NULL; conn = conn->next) {
            srv_inbox_alarm(conn, at_ns);
        }
    }
}

/* ---- lines ------------------------------------------------------------------------- */

static int refuse(char text[PROTO_DIRECT_TEXT_BYTES], int status, const char *why)
{
    (void)snprintf(text, PROTO_DIRECT_TEXT_BYTES, "%s", why);
    return status;
}

static void unlink_conn(struct srv_conn *conn)
{
    if (conn->prev != NULL) {
        conn->prev->next = conn->next;
    } else {
        conns = conn->next;
    }
    if (conn->next != NULL) {
        conn->next->prev = conn->prev;
    }
}

static void link_conn(struct srv_conn *conn)
{
    conn->next = conns;
    if (conns != NULL) {
        conns->prev = conn;
    }
    conns = conn;
}

/* In its turn. */
static int add_line(struct proto_direct_inbox *line, char text[PROTO_DIRECT_TEXT_BYTES])
{
    const struct srv_peer peer = {.uid = geteuid(), .pid = getpid()};
    if (the_service == NULL) {
        the_service = make_service();
    }
    if (the_service == NULL) {
        return refuse(text, PCCD_E_NOMEM, "no memory for the service");
    }
    line->conn.session = srv_session_new(the_service, &line->conn, &peer);
    if (line->conn.session == NULL) {
        if (conns == NULL) {
            free_service(the_service);
            the_service = NULL;
        }
        return refuse(text, PCCD_E_NOMEM, "no memory for a session");
    }
    link_conn(&line->conn);
    srv_inbox_alarm(&line->conn, reported_ns);
    return 0;
}

static int open_line(struct proto_direct_inbox **line, char text[PROTO_DIRECT_TEXT_BYTES])
{
    static pthread_once_t once = PTHREAD_ONCE_INIT;
    const char *cpu = getenv("PCCD_CPU");
    if (is_forked) {
        return refuse(text, PCCD_E_STATE,
                      "this process was forked from one that computes; connect to a "
                      "daemon, or start a program");
    }
    if (eng_kernels_named(cpu) == NULL) {
        (void)snprintf(text, PROTO_DIRECT_TEXT_BYTES,
                       "PCCD_CPU=%s: there is no such instruction set here", cpu);
        return PCCD_E_INVAL;
    }
    struct proto_direct_inbox *made = calloc(1, sizeof *made);
    if (made == NULL || srv_inbox_init(&made->conn) != 0) {
        free(made);
        return refuse(text, PCCD_E_NOMEM, "no memory for a client");
    }
    (void)pthread_once(&once, watch_forks);
    take_turn();
    int status = add_line(made, text);
    end_turn();
    if (status != 0) {
        srv_inbox_deinit(&made->conn);
        free(made);
        return status;
    }
    *line = made;
    return 0;
}

static int send_message(struct proto_direct_inbox *line, const void *message,
                        size_t bytes)
{
    if (is_forked || srv_inbox_is_finished(&line->conn)) {
        return PCCD_E_DISCONNECTED;
    }
    take_turn();
    the_service->metrics.counters.messages++;
    uint32_t threads = the_service->live.threads_max;
    bool is_limited = line->threads > 0 && line->threads < threads;
    if (is_limited) {
        the_service->live.threads_max = line->threads;
    }
    the_service->is_stopped = line->is_stopped;
    the_service->asked = line->asked;
    the_service->write = line->write;
    the_service->writer = line->writer;
    the_service->weigh = line->weigh;
    the_service->weigher = line->weigher;
    srv_dispatch(line->conn.session, message, bytes);
    work_off(the_service);
    the_service->is_stopped = NULL;
    the_service->write = NULL;
    the_service->weigh = NULL;
    if (is_limited && the_service->live.threads_max == line->threads) {
        the_service->live.threads_max = threads; /* else the message has set it */
    }
    do_due();
    end_turn();
    return 0;
}

/* The client reads again: tell it what was kept from it. */
static void catch_up(struct srv_session *session)
{
    if (session != NULL) {
        srv_watcher_flush(session);
        srv_shared_catch_up(session);
    }
}

static int receive_message(struct proto_direct_inbox *line, void *buffer, size_t capacity,
                           size_t *bytes, int *fds, int *fd_count)
{
    if (is_forked) {
        *fd_count = 0;
        return PCCD_E_DISCONNECTED;
    }
    if (direct_timers_are_due() &&
        try_turn()) { /* else whoever has it does what is due */
        do_due();
        end_turn();
    }
    int status = srv_inbox_take(&line->conn, buffer, capacity, bytes, fds, fd_count);
    if (srv_inbox_is_behind(&line->conn)) {
        take_turn();
        catch_up(line->conn.session);
        end_turn();
    }
    return status;
}

static int descriptor_of(struct proto_direct_inbox *line)
{
    return is_forked ? -1 : srv_inbox_descriptor(&line->conn);
}

/* In its turn. */
static int set_own(struct srv_session *session, uint32_t handle, const uint64_t *vertices,
                   const uint64_t *edges)
{
    struct srv_mesh *mesh = srv_handles_get(&session->meshes, handle);
    struct eng_mesh *engine = NULL;
    if (mesh == NULL) {
        return PCCD_E_HANDLE;
    }
    if (!mesh->is_committed) {
        return PCCD_E_STATE;
    }
    struct srv_enginemem memory;
    srv_thread_enter(SRV_THREAD_COMPUTE);
    srv_enginemem_begin(&memory, session->owner.user);
    int status = srv_shape_engine(mesh->current, &engine);
    if (status == 0) {
        status = eng_mesh_set_own(engine, vertices, edges);
    }
    (void)srv_enginemem_end(&memory);
    srv_thread_enter(SRV_THREAD_LOOP);
    return status;
}

static int tell_own(struct proto_direct_inbox *line, uint32_t mesh,
                    const uint64_t *vertices, const uint64_t *edges)
{
    if (is_forked || srv_inbox_is_finished(&line->conn)) {
        return PCCD_E_DISCONNECTED;
    }
    take_turn();
    int status = line->conn.session != NULL
                     ? set_own(line->conn.session, mesh, vertices, edges)
                     : PCCD_E_DISCONNECTED;
    end_turn();
    return status;
}

/* In its turn. */
static int lend_positions(struct srv_session *session, uint32_t handle, uint32_t object,
                          enum proto_direct_lend what, double (**x0)[3], double (**x1)[3])
{
    struct srv_scene *scene = srv_handles_get(&session->scenes, handle);
    if (scene == NULL || scene->shared != NULL) {
        return PCCD_E_HANDLE;
    }
    struct srv_placed *placed = srv_scene_find(scene, object);
    if (placed == NULL) {
        return PCCD_E_HANDLE;
    }
    if (what == PROTO_DIRECT_LEND) {
        return eng_stage_map(scene->engine, placed->engine_idx, x0, x1);
    }
    if (what == PROTO_DIRECT_FORGET) {
        placed->mapped = SRV_MAPPED_NOTHING;
        eng_stage_unmap(scene->engine, placed->engine_idx);
        return 0;
    }
    placed->mapped = what == PROTO_DIRECT_HAS_X0X1 ? SRV_MAPPED_X0X1 : SRV_MAPPED_X1;
    scene->has_mapped = true;
    return 0;
}

static int lend_in_turn(struct proto_direct_inbox *line, uint32_t scene, uint32_t object,
                        enum proto_direct_lend what, double (**x0)[3], double (**x1)[3])
{
    if (is_forked || srv_inbox_is_finished(&line->conn)) {
        return PCCD_E_DISCONNECTED;
    }
    take_turn();
    struct srv_session *session = line->conn.session;
    int status = PCCD_E_DISCONNECTED;
    if (session != NULL) {
        struct srv_enginemem memory;
        srv_thread_enter(SRV_THREAD_COMPUTE);
        srv_enginemem_begin(&memory, session->owner.user);
        status = lend_positions(session, scene, object, what, x0, x1);
        (void)srv_enginemem_end(&memory);
        srv_thread_enter(SRV_THREAD_LOOP);
    }
    end_turn();
    return status;
}

static void expect(struct proto_direct_inbox *line, uint32_t handle, uint64_t records)
{
    if (is_forked || srv_inbox_is_finished(&line->conn)) {
        return;
    }
    take_turn();
    const struct srv_session *session = line->conn.session;
    struct srv_scene *scene =
        session != NULL ? srv_handles_get(&session->scenes, handle) : NULL;
    if (scene != NULL && session->ring != NULL) {
        srv_thread_enter(SRV_THREAD_COMPUTE);
        scene->expected = records;
        srv_ring_give_back(session->ring);
        srv_thread_enter(SRV_THREAD_LOOP);
    }
    end_turn();
}

static void limit_line(struct proto_direct_inbox *line, uint32_t threads)
{
    line->threads = threads;
}

static void watch_line(struct proto_direct_inbox *line, bool (*is_stopped)(void *asked),
                       void *asked)
{
    line->is_stopped = is_stopped;
    line->asked = asked;
}

static void write_line(struct proto_direct_inbox *line,
                       void (*write)(void *writer, void *to, const void *from,
                                     uint64_t count),
                       void *writer)
{
    line->write = write;
    line->writer = writer;
}

static void weigh_line(struct proto_direct_inbox *line,
                       void (*weigh)(void *weigher, const struct pccd_pair *pairs,
                                     uint32_t count),
                       void *weigher)
{
    line->weigh = weigh;
    line->weigher = weigher;
}

static void close_line(struct proto_direct_inbox *line)
{
    if (is_forked) {
        return; /* whose copy this is may have had the turn when it was copied */
    }
    take_turn();
    unlink_conn(&line->conn);
    if (line->conn.session != NULL) {
        srv_session_detach(line->conn.session);
    }
    work_off(the_service);
    if (conns == NULL) {
        free_service(the_service);
        the_service = NULL;
    }
    do_due();
    end_turn();
    srv_inbox_deinit(&line->conn);
    free(line);
}

/* ---- the entrance ------------------------------------------------------------------ */

__attribute__((visibility("default"))) const struct proto_direct *
pccd_direct_host(uint32_t version);

const struct proto_direct *pccd_direct_host(uint32_t version)
{
    static const struct proto_direct host = {.open = open_line,
                                             .send = send_message,
                                             .receive = receive_message,
                                             .descriptor = descriptor_of,
                                             .own = tell_own,
                                             .lend = lend_in_turn,
                                             .watch = watch_line,
                                             .limit = limit_line,
                                             .expect = expect,
                                             .write = write_line,
                                             .weigh = weigh_line,
                                             .close = close_line};
    return version == PROTO_DIRECT_VERSION ? &host : NULL;
}

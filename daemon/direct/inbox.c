/* inbox.c - a client in the process of the service. */
#include "inbox.h"

#include <stdlib.h>
#include <string.h>
#include <sys/epoll.h>
#include <sys/eventfd.h>
#include <sys/timerfd.h>
#include <time.h>
#include <unistd.h>

#include "invariant.h"
#include "pccd_types.h"

#define NS_PER_S     1000000000u
#define CAPACITY_MIN 4096u

struct head {
    size_t bytes;
    int fd_count;
    int fds[PROTO_FDS_MAX]; /* ours until they are taken */
};

static void lock(struct srv_conn *conn)
{
    int failed = pthread_mutex_lock(&conn->mutex);
    PCCD_ASSERT(failed == 0);
}

static void unlock(struct srv_conn *conn)
{
    int failed = pthread_mutex_unlock(&conn->mutex);
    PCCD_ASSERT(failed == 0);
}

static void close_fds(const int *fds, int fd_count)
{
    for (int i = 0; i < fd_count; i++) {
        close(fds[i]);
    }
}

/* Whole heads, one behind the other. */
static size_t room_of(size_t bytes)
{
    size_t all = sizeof(struct head) + bytes;
    return (all + sizeof(struct head) - 1) / sizeof(struct head) * sizeof(struct head);
}

int srv_inbox_init(struct srv_conn *conn)
{
    *conn = (struct srv_conn){.descriptor = -1, .event = -1, .timer = -1};
    return pthread_mutex_init(&conn->mutex, NULL) == 0 ? 0 : PCCD_E_NOMEM;
}

static void close_descriptors(struct srv_conn *conn)
{
    int *const all[] = {&conn->descriptor, &conn->event, &conn->timer};
    for (int i = 0; i < 3; i++) {
        if (*all[i] >= 0) {
            close(*all[i]);
        }
        *all[i] = -1;
    }
}

/* The oldest message is no longer there. Locked. */
static void drop_first(struct srv_conn *conn, const struct head *head)
{
    conn->first += room_of(head->bytes);
    if (--conn->count == 0) {
        PCCD_ASSERT(conn->first == conn->end);
        conn->first = 0;
        conn->end = 0;
    }
}

void srv_inbox_deinit(struct srv_conn *conn)
{
    while (conn->count > 0) {
        struct head head;
        memcpy(&head, conn->queue + conn->first, sizeof head);
        close_fds(head.fds, head.fd_count);
        drop_first(conn, &head);
    }
    close_descriptors(conn);
    free(conn->queue);
    pthread_mutex_destroy(&conn->mutex);
}

/* ---- in ---------------------------------------------------------------------------- */

/* Room for `bytes` more behind the last message. Locked. */
static bool make_room(struct srv_conn *conn, size_t bytes)
{
    size_t used = conn->end - conn->first;
    if (conn->capacity - conn->end >= bytes) {
        return true;
    }
    if (conn->capacity - used < bytes) {
        size_t capacity = conn->capacity == 0 ? CAPACITY_MIN : conn->capacity;
        while (capacity - used <
               bytes) { /* ends: messages and their number are bounded */
            capacity *= 2;
        }
        uint8_t *queue = realloc(conn->queue, capacity);
        if (queue == NULL) {
            return false;
        }
        conn->queue = queue;
        conn->capacity = capacity;
    }
    memmove(conn->queue, conn->queue + conn->first, used);
    conn->first = 0;
    conn->end = used;
    return true;
}

/* Let the descriptor be readable. Locked; it holds 0 now, and a write of 1 cannot
 * block. */
static void ring(const struct srv_conn *conn)
{
    uint64_t one = 1;
    if (conn->event >= 0) {
        ssize_t written = write(conn->event, &one, sizeof one);
        PCCD_ASSERT(written == (ssize_t)sizeof one);
    }
}

void srv_conn_send(struct srv_conn *conn, const struct proto_encoder *message,
                   const int *fds, int fd_count)
{
    srv_assert_loop();
    struct head head = {.bytes = message->bytes, .fd_count = fd_count, .fds = {-1, -1}};
    PCCD_ASSERT(fd_count >= 0 && fd_count <= PROTO_FDS_MAX);
    for (int i = 0; i < fd_count; i++) {
        head.fds[i] = fds[i];
    }
    lock(conn);
    if (conn->is_finished || conn->count >= SRV_INBOX_MESSAGES_MAX ||
        !make_room(conn, room_of(head.bytes))) {
        conn->is_finished = true;
        close_fds(fds, fd_count);
    } else {
        memcpy(conn->queue + conn->end, &head, sizeof head);
        memcpy(conn->queue + conn->end + sizeof head, message->data, head.bytes);
        conn->end += room_of(head.bytes);
        if (conn->count++ == 0) {
            ring(conn);
        }
    }
    unlock(conn);
}

bool srv_conn_is_free(const struct srv_conn *conn)
{
    struct srv_conn *locked = (struct srv_conn *)(uintptr_t)conn;
    lock(locked);
    bool is_free = conn->count < SRV_INBOX_FREE_MAX && !conn->is_finished;
    locked->is_behind = locked->is_behind || !is_free;
    unlock(locked);
    return is_free;
}

/* Who waits takes the answers itself. */
struct srv_outlet *srv_conn_outlet(struct srv_conn *conn)
{
    (void)conn;
    return NULL;
}

int srv_outlet_send(struct srv_outlet *outlet, const struct proto_encoder *message)
{
    (void)outlet;
    (void)message;
    srv_assert_failed("there is no outlet", __FILE__, __LINE__);
}

void srv_outlet_drop(struct srv_outlet *outlet)
{
    (void)outlet;
}

void srv_conn_finish(struct srv_conn *conn)
{
    lock(conn);
    conn->is_finished = true;
    if (conn->count == 0) {
        ring(conn);
    }
    unlock(conn);
}

/* ---- out --------------------------------------------------------------------------- */

int srv_inbox_take(struct srv_conn *conn, void *buffer, size_t capacity, size_t *bytes,
                   int *fds, int *fd_count)
{
    struct head head = {.bytes = 0};
    int status = 0;
    *fd_count = 0;
    lock(conn);
    if (conn->count == 0) {
        status = conn->is_finished ? PCCD_E_DISCONNECTED : PCCD_E_AGAIN;
        unlock(conn);
        return status;
    }
    memcpy(&head, conn->queue + conn->first, sizeof head);
    if (head.bytes > capacity) {
        close_fds(head.fds, head.fd_count);
        status = PCCD_E_BADMSG;
    } else {
        memcpy(buffer, conn->queue + conn->first + sizeof head, head.bytes);
        *bytes = head.bytes;
        *fd_count = head.fd_count;
        memcpy(fds, head.fds, sizeof head.fds);
    }
    drop_first(conn, &head);
    if (conn->count == 0 && conn->event >= 0 && !conn->is_finished) {
        uint64_t value = 0;
        ssize_t got = read(conn->event, &value, sizeof value);
        PCCD_ASSERT(got == (ssize_t)sizeof value);
    }
    unlock(conn);
    return status;
}

bool srv_inbox_is_behind(struct srv_conn *conn)
{
    lock(conn);
    bool is_behind = conn->is_behind && conn->count == 0;
    conn->is_behind = conn->is_behind && !is_behind;
    unlock(conn);
    return is_behind;
}

/* Locked. */
static void set_alarm(const struct srv_conn *conn)
{
    const struct itimerspec at = {.it_value = {(time_t)(conn->alarm_ns / NS_PER_S),
                                               (long)(conn->alarm_ns % NS_PER_S)}};
    if (conn->timer >= 0) {
        int failed = timerfd_settime(conn->timer, TFD_TIMER_ABSTIME, &at, NULL);
        PCCD_ASSERT(failed == 0);
    }
}

void srv_inbox_alarm(struct srv_conn *conn, uint64_t at_ns)
{
    lock(conn);
    conn->alarm_ns = at_ns;
    set_alarm(conn);
    unlock(conn);
}

/* Locked. */
static bool make_descriptors(struct srv_conn *conn)
{
    struct epoll_event readable = {.events = EPOLLIN};
    conn->descriptor = epoll_create1(EPOLL_CLOEXEC);
    conn->event = eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK);
    conn->timer = timerfd_create(CLOCK_MONOTONIC, TFD_CLOEXEC | TFD_NONBLOCK);
    return conn->descriptor >= 0 && conn->event >= 0 && conn->timer >= 0 &&
           epoll_ctl(conn->descriptor, EPOLL_CTL_ADD, conn->event, &readable) == 0 &&
           epoll_ctl(conn->descriptor, EPOLL_CTL_ADD, conn->timer, &readable) == 0;
}

int srv_inbox_descriptor(struct srv_conn *conn)
{
    lock(conn);
    if (conn->descriptor < 0) {
        if (!make_descriptors(conn)) {
            close_descriptors(conn);
        }
        set_alarm(conn);
        if (conn->count > 0 || conn->is_finished) {
            ring(conn);
        }
    }
    int descriptor = conn->descriptor;
    unlock(conn);
    return descriptor;
}

bool srv_inbox_is_finished(struct srv_conn *conn)
{
    lock(conn);
    bool is_finished = conn->is_finished;
    unlock(conn);
    return is_finished;
}

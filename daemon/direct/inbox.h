/* inbox.h - the messages that wait for a client which runs the service in its own process
 * (the url direct:).
 *
 * Threads: the queue has a lock of its own: a client may look for answers while another
 * one's step is computed.
 */
#ifndef DIRECT_INBOX_H
#define DIRECT_INBOX_H

#include <pthread.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "host.h"
#include "proto_direct.h"

/* Messages that a client lets wait before it is dropped: it has no more requests in
 * flight, and the rest are notifications that it does not read. */
#define SRV_INBOX_MESSAGES_MAX 1024u

/* Beyond so many, what may wait is not told before the client has taken them. */
#define SRV_INBOX_FREE_MAX 256u

/* The connection of host.h to a client. */
struct srv_conn {
    struct srv_conn *prev; /* of the process; under the turn (turn.c) */
    struct srv_conn *next;
    struct srv_session *session; /* NULL: it is over */
    pthread_mutex_t mutex;       /* of all below */
    uint8_t *queue;              /* [capacity] messages, each behind its head */
    size_t capacity;
    size_t first; /* of the oldest message */
    size_t end;
    uint32_t count;
    int descriptor;    /* an epoll of both below; -1: nobody has asked for it, nor they */
    int event;         /* eventfd: there is a message, or the end */
    int timer;         /* timerfd: something is due */
    uint64_t alarm_ns; /* CLOCK_MONOTONIC, when that is; 0: nothing is */
    bool is_behind;    /* something is not told for want of room */
    bool is_finished;  /* nothing more is sent either way */
};

/* Make it empty. Returns 0 or PCCD_E_NOMEM. */
int srv_inbox_init(struct srv_conn *conn);
/* Free it, and the messages that nobody took. */
void srv_inbox_deinit(struct srv_conn *conn);

/* Take the oldest message, as proto_receive does. */
int srv_inbox_take(struct srv_conn *conn, void *buffer, size_t capacity, size_t *bytes,
                   int *fds, int *fd_count);
/* Return the descriptor to wait with, made when there is none; -1: there is none to be
 * had. */
int srv_inbox_descriptor(struct srv_conn *conn);
/* Have the descriptor be readable from that time on, CLOCK_MONOTONIC, too; 0: not any
 * more. [turn] */
void srv_inbox_alarm(struct srv_conn *conn, uint64_t at_ns);
/* Return whether it has taken all messages since srv_conn_is_free said no; once. */
bool srv_inbox_is_behind(struct srv_conn *conn);
/* Return whether nothing more comes, but for what is there. */
bool srv_inbox_is_finished(struct srv_conn *conn);

#endif

/* replyqueue.c - messages that wait, of the daemon and of its client. */
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "conn.h"
#include "invariant.h"
#include "pccd_types.h"

void srv_reply_close_fds(const int *fds, int fd_count)
{
    for (int i = 0; i < fd_count; i++) {
        close(fds[i]);
    }
}

int srv_replyqueue_push(struct srv_replyqueue *queue, const void *message, size_t bytes,
                        const int *fds, int fd_count)
{
    struct srv_reply *reply = malloc(sizeof *reply + bytes);
    if (reply == NULL) {
        srv_reply_close_fds(fds, fd_count);
        return PCCD_E_NOMEM;
    }
    reply->next = NULL;
    reply->bytes = bytes;
    reply->fd_count = fd_count;
    for (int i = 0; i < fd_count; i++) {
        reply->fds[i] = fds[i];
    }
    memcpy(reply->data, message, bytes);
    if (queue->last == NULL) {
        queue->first = reply;
    } else {
        queue->last->next = reply;
    }
    queue->last = reply;
    queue->count++;
    return 0;
}

void srv_replyqueue_pop(struct srv_replyqueue *queue)
{
    struct srv_reply *reply = queue->first;
    PCCD_ASSERT(queue->count > 0);
    queue->first = reply->next;
    if (queue->first == NULL) {
        queue->last = NULL;
    }
    queue->count--;
    srv_reply_close_fds(reply->fds, reply->fd_count);
    free(reply);
}

/* ---- A message that waits for room. */

int srv_deferred_keep(struct srv_deferred *deferred, const void *message, size_t bytes)
{
    PCCD_ASSERT(deferred->message == NULL);
    if (deferred->turns == SRV_DEFERRED_MAX) {
        return PCCD_E_LIMIT;
    }
    struct srv_message *copy = malloc(sizeof *copy + bytes);
    if (copy == NULL) {
        return PCCD_E_NOMEM;
    }
    copy->bytes = bytes;
    memcpy(copy->data, message, bytes);
    deferred->message = copy;
    deferred->turns++;
    return 0;
}

struct srv_message *srv_deferred_take(struct srv_deferred *deferred)
{
    struct srv_message *message = deferred->message;
    deferred->message = NULL;
    return message;
}

/* replyqueue.h - the replies that wait until their client reads. */
#ifndef SRV_REPLYQUEUE_H
#define SRV_REPLYQUEUE_H

#include <stddef.h>
#include <stdint.h>

#include "seqpacket.h"

struct srv_reply {
    struct srv_reply *next;
    size_t bytes;
    int fd_count;
    int fds[PROTO_FDS_MAX]; /* the queue's */
    uint8_t data[];
};

/* Zeroed: empty. */
struct srv_replyqueue {
    struct srv_reply *first;
    struct srv_reply *last;
    uint32_t count;
};

/* Takes the descriptors over, whatever it returns: 0 or PCCD_E_NOMEM. */
int srv_replyqueue_push(struct srv_replyqueue *queue, const void *message, size_t bytes,
                        const int *fds, int fd_count);

/* Give the first up, and close its descriptors; there must be one. */
void srv_replyqueue_pop(struct srv_replyqueue *queue);

void srv_reply_close_fds(const int *fds, int fd_count);

#endif

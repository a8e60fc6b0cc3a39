/* outlet.c - the way out of a client's socket, for the thread that computes. */
#include "conn.h"

#include <pthread.h>
#include <stdatomic.h>
#include <stdlib.h>

#include "invariant.h"
#include "pccd_types.h"
#include "seqpacket.h"

struct srv_outlet {
    uint32_t references; /* [loop] */
    atomic_bool is_blocked;
    pthread_mutex_t mutex;
    int fd; /* locked; -1: closed */
};

struct srv_outlet *srv_outlet_new(int fd)
{
    struct srv_outlet *outlet = calloc(1, sizeof *outlet);
    if (outlet == NULL || pthread_mutex_init(&outlet->mutex, NULL) != 0) {
        free(outlet);
        return NULL;
    }
    outlet->references = 1;
    outlet->fd = fd;
    return outlet;
}

struct srv_outlet *srv_outlet_hold(struct srv_outlet *outlet)
{
    srv_assert_loop();
    outlet->references++;
    return outlet;
}

void srv_outlet_drop(struct srv_outlet *outlet)
{
    srv_assert_loop();
    PCCD_ASSERT(outlet->references > 0);
    if (--outlet->references == 0) {
        pthread_mutex_destroy(&outlet->mutex);
        free(outlet);
    }
}

void srv_outlet_close(struct srv_outlet *outlet)
{
    pthread_mutex_lock(&outlet->mutex);
    outlet->fd = -1;
    pthread_mutex_unlock(&outlet->mutex);
    srv_outlet_drop(outlet);
}

void srv_outlet_block(struct srv_outlet *outlet, bool is_blocked)
{
    atomic_store(&outlet->is_blocked, is_blocked);
}

int srv_outlet_send(struct srv_outlet *outlet, const struct proto_encoder *message)
{
    int status = PCCD_E_DISCONNECTED;
    if (atomic_load(&outlet->is_blocked)) {
        return PCCD_E_AGAIN;
    }
    pthread_mutex_lock(&outlet->mutex);
    if (outlet->fd >= 0) {
        status = proto_send(outlet->fd, message->data, message->bytes, NULL, 0);
    }
    pthread_mutex_unlock(&outlet->mutex);
    return status;
}

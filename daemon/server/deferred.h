/* deferred.h - one message of a client that cannot be handled yet because a queue is
 * full.
 */
#ifndef SRV_DEFERRED_H
#define SRV_DEFERRED_H

#include <stddef.h>
#include <stdint.h>

/* A message comes back that often at most: sessions of its user may leave for ever. */
#define SRV_DEFERRED_MAX 64u

struct srv_message {
    size_t bytes;
    uint8_t data[];
};

/* Zeroed: nothing waits. */
struct srv_deferred {
    struct srv_message *message; /* NULL: none */
    uint32_t turns;              /* how often, the message that was read last */
};

/* Keep a copy; there must be none. Returns 0, PCCD_E_LIMIT (too often) or
 * PCCD_E_NOMEM. */
int srv_deferred_keep(struct srv_deferred *deferred, const void *message, size_t bytes);

/* What was kept, for the caller to free; NULL: nothing. */
struct srv_message *srv_deferred_take(struct srv_deferred *deferred);

#endif

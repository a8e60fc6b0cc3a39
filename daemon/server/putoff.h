/* putoff.h - a message that waits for room.
 *
 * Room:     server. May include: the C library.
 * Does:     keep one message of a client as it came, and bound how often it comes back.
 * Does not: know when there is room, or handle it (conn.c).
 * Threads:  [loop]
 */
#ifndef SRV_PUTOFF_H
#define SRV_PUTOFF_H

#include <stddef.h>
#include <stdint.h>

/* A message comes back that often at most: sessions of its user may leave for ever. */
#define SRV_PUT_OFF_MAX 64u

struct srv_message {
    size_t bytes;
    uint8_t data[];
};

/* Zeroed: nothing waits. */
struct srv_putoff {
    struct srv_message *message; /* NULL: none */
    uint32_t turns;              /* how often, the message that was read last */
};

/* Keep a copy; there must be none. Returns 0, PCCD_E_LIMIT (too often) or
 * PCCD_E_NOMEM. */
int srv_putoff_keep(struct srv_putoff *put_off, const void *message, size_t bytes);

/* What was kept, for the caller to free; NULL: nothing. */
struct srv_message *srv_putoff_take(struct srv_putoff *put_off);

#endif

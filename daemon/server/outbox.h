/* outbox.h - answers that go out together.
 *
 * Room:     server. May include: the C library.
 * Does:     keep small messages until the loop has handled what had come, or as many
 *           messages as there are places. Each that is sent may wake its client, and who
 *           is woken while more comes has to be woken again: of fifty clients in one
 *           process one wakes for sixteen answers in the place of every few.
 * Does not: send, or keep anything while the loop waits (conn.c sees to both).
 * Threads:  [loop]
 */
#ifndef SRV_OUTBOX_H
#define SRV_OUTBOX_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#define SRV_OUTBOX_PLACES 16u  /* and messages handled while the first waits */
#define SRV_OUTBOX_BYTES  120u /* of a message; an answer to a step is longer */

struct srv_conn;

struct srv_outbox {
    uint32_t count;
    uint32_t handled; /* messages since the first came */
    struct {
        struct srv_conn *conn;
        size_t bytes;
        uint8_t data[SRV_OUTBOX_BYTES];
    } places[SRV_OUTBOX_PLACES];
};

/* False: it is too long, or there is no place; nothing has changed. */
bool srv_outbox_add(struct srv_outbox *outbox, struct srv_conn *conn, const void *message,
                    size_t bytes);

/* The loop has handled one more message. Returns whether what is kept is to go. */
bool srv_outbox_is_due(struct srv_outbox *outbox);

/* It has gone. */
void srv_outbox_clear(struct srv_outbox *outbox);

#endif

/* outbox.h - collects small answers, so that a client is woken once for several of them.
 *
 * Keep small messages until the loop has handled everything that had come, or until there
 * are as many as there are entries. Sending a message may wake its client, and a client
 * that wakes too early has to be woken again. For example, of fifty clients in one
 * process, one wakes once for sixteen answers instead of once for every few.
 */
#ifndef SRV_OUTBOX_H
#define SRV_OUTBOX_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#define SRV_OUTBOX_ENTRIES 16u  /* and messages handled while the first waits */
#define SRV_OUTBOX_BYTES   120u /* of a message; an answer to a step is longer */

struct srv_conn;

struct srv_outbox {
    uint32_t count;
    uint32_t handled; /* messages since the first came */
    struct {
        struct srv_conn *conn;
        size_t bytes;
        uint8_t data[SRV_OUTBOX_BYTES];
    } entries[SRV_OUTBOX_ENTRIES];
};

/* False: it is too long, or there is no place; nothing has changed. */
bool srv_outbox_add(struct srv_outbox *outbox, struct srv_conn *conn, const void *message,
                    size_t bytes);

/* The loop has handled one more message. Returns whether what is kept is to go. */
bool srv_outbox_is_due(struct srv_outbox *outbox);

/* It has gone. */
void srv_outbox_clear(struct srv_outbox *outbox);

#endif

/* refused.h - connections of clients that are refused, until they have heard so.
 *
 * Room:     server. May include: the C library.
 * Does:     list them, the oldest first, so that they have places of their own: beside
 *           those of clients, and theirs again when descriptors are short. Who has to
 *           make room is told why before it is closed.
 * Does not: refuse anybody (session.h does), or close one that has read its answer: that
 *           ends as any other does (conn.h).
 * Threads:  [loop]
 */
#ifndef SRV_REFUSED_H
#define SRV_REFUSED_H

#include <stdbool.h>
#include <stdint.h>

struct srv_conn;

/* Zeroed: empty. */
struct srv_refused {
    struct srv_conn *first; /* the oldest */
    struct srv_conn *last;
    uint32_t count;
};

/* The part of a connection. Zeroed: not in the list. */
struct srv_refused_link {
    struct srv_conn *older;
    struct srv_conn *newer;
    bool is_in;
};

void srv_refused_add(struct srv_refused *refused, struct srv_conn *conn);
/* It is closed, or a client now; nothing if it is not in the list. */
void srv_refused_remove(struct srv_refused *refused, struct srv_conn *conn);

/* Close the oldest ones until at most `count` are left; what they have sent is answered
 * first. Must not be called from inside a handler. */
void srv_refused_shrink(struct srv_refused *refused, uint32_t count);

#endif

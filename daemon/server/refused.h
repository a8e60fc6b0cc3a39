/* refused.h - the connections of clients that were refused, until each has read why. */
#ifndef SRV_REFUSED_H
#define SRV_REFUSED_H

#include <stdint.h>

struct srv_conn;

/* The part of a connection. Zeroed: not in the list. */
struct srv_refused_link {
    struct srv_conn *conn; /* that it is part of; NULL: it is not in the list */
    struct srv_refused_link *older;
    struct srv_refused_link *newer;
};

/* Zeroed: empty. */
struct srv_refused {
    struct srv_refused_link *first; /* the oldest */
    struct srv_refused_link *last;
    uint32_t count;
};

void srv_refused_add(struct srv_refused *refused, struct srv_refused_link *link,
                     struct srv_conn *conn);
/* It is closed, or a client now; nothing if it is not in the list. */
void srv_refused_remove(struct srv_refused *refused, struct srv_refused_link *link);

#endif

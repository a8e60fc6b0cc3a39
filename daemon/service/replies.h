/* replies.h - answers that may have to be sent once more.
 *
 * Room:     service. May include: the protocol's headers.
 * Does:     keep the last answers of a resumable session, encoded, until newer ones take
 *           their places; tell a request that comes again from a new one.
 * Does not: send, or know who acknowledged what: a client has no more than
 *           PROTO_REPLIES_KEPT requests without an answer, and answers go out in order,
 *           so one that was not received is always among the last.
 * Threads:  [loop].
 */
#ifndef SRV_REPLIES_H
#define SRV_REPLIES_H

#include <stdbool.h>
#include <stdint.h>

#include "codec.h"

struct srv_kept_reply {
    uint32_t id;
    size_t bytes;
    uint8_t *data; /* NULL: none here */
};

struct srv_replies {
    struct srv_kept_reply kept[PROTO_REPLIES_KEPT]; /* a ring */
    uint32_t next;
    uint32_t id_newest; /* of the requests that came; ids of a session only grow */
    bool is_broken;     /* an answer could not be kept: the session cannot be resumed */
};

struct srv_replies *srv_replies_new(void);          /* NULL: no memory */
void srv_replies_free(struct srv_replies *replies); /* NULL is allowed */

/* Whether a request with that id cannot have come before; it counts as come then. */
bool srv_replies_is_new(struct srv_replies *replies, uint32_t id);

/* Keep the answer to a request, if its method is one that must not run twice. */
void srv_replies_keep(struct srv_replies *replies, uint32_t id, int method,
                      const struct proto_encoder *answer);

/* Put the answer that was given to `id` into *encoder. False: it is not kept. */
bool srv_replies_find(const struct srv_replies *replies, uint32_t id,
                      struct proto_encoder *encoder);

#endif

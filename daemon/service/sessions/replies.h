/* replies.h - the last answers of a session, kept in case the connection is lost and they
 * must be sent again.
 *
 * Threads: [loop], but for functions marked otherwise.
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

/* Make an empty one. NULL: no memory. */
struct srv_replies *srv_replies_new(void);
void srv_replies_free(struct srv_replies *replies); /* NULL is allowed */

/* Return whether a request with that id cannot have come before; then it has now. */
bool srv_replies_is_new(struct srv_replies *replies, uint32_t id);

/* Return whether an answer is to be kept, because its method must not run twice. [any] */
bool srv_replies_must_keep(int method);
/* Make a copy of an answer, to be kept; `data` NULL: there is no memory for it. [any] */
struct srv_kept_reply srv_reply_copy(uint32_t id, const struct proto_encoder *answer);
/* Keep a copy, which is taken over. One without data breaks the session's replies. */
void srv_replies_keep(struct srv_replies *replies, struct srv_kept_reply copy);

/* Put the answer that was given to `id` into *encoder. False: it is not kept. */
bool srv_replies_find(const struct srv_replies *replies, uint32_t id,
                      struct proto_encoder *encoder);

#endif

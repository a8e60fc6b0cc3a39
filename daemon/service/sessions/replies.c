/* replies.c - answers that may have to be sent once more. */
#include "replies.h"

#include <stdlib.h>
#include <string.h>

#include "invariant.h"
#include "messages.h"

struct srv_replies *srv_replies_new(void)
{
    return calloc(1, sizeof(struct srv_replies));
}

void srv_replies_free(struct srv_replies *replies)
{
    if (replies == NULL) {
        return;
    }
    for (uint32_t i = 0; i < PROTO_REPLIES_KEPT; i++) {
        free(replies->kept[i].data);
    }
    free(replies);
}

bool srv_replies_is_new(struct srv_replies *replies, uint32_t id)
{
    uint32_t ahead = id - replies->id_newest; /* ids wrap */
    if (ahead == 0 || ahead > UINT32_MAX / 2) {
        return false;
    }
    replies->id_newest = id;
    return true;
}

bool srv_replies_must_keep(int method)
{
    return method >= 0 && (proto_messages[method].flags & PROTO_F_REPEAT) == 0;
}

struct srv_kept_reply srv_reply_copy(uint32_t id, const struct proto_encoder *answer)
{
    PCCD_ASSERT(answer->bytes > 0 && answer->bytes <= sizeof answer->data);
    struct srv_kept_reply copy = {
        .id = id, .bytes = answer->bytes, .data = malloc(answer->bytes)};
    if (copy.data != NULL) {
        memcpy(copy.data, answer->data, answer->bytes);
    }
    return copy;
}

void srv_replies_keep(struct srv_replies *replies, struct srv_kept_reply copy)
{
    struct srv_kept_reply *place = &replies->kept[replies->next++ % PROTO_REPLIES_KEPT];
    free(place->data);
    *place = copy;
    replies->is_broken = replies->is_broken || copy.data == NULL;
}

bool srv_replies_find(const struct srv_replies *replies, uint32_t id,
                      struct proto_encoder *encoder)
{
    for (uint32_t i = 0; i < PROTO_REPLIES_KEPT; i++) {
        const struct srv_kept_reply *place = &replies->kept[i];
        if (place->data != NULL && place->id == id) {
            memcpy(encoder->data, place->data, place->bytes);
            encoder->bytes = place->bytes;
            return true;
        }
    }
    return false;
}

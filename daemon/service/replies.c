/* replies.c - answers that may have to be sent once more.
 *
 * Room:     service. See replies.h.
 * Does:     a ring of PROTO_REPLIES_KEPT encoded messages, about 1 KiB each.
 * Threads:  [loop].
 */
#include "replies.h"

#include <stdlib.h>
#include <string.h>

#include "invariant.h"

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

/* Asked twice, these only say something once more; the answer to shm.attach cannot be
 * kept, because its descriptors went with it, and what it attached is replaced. */
static bool may_run_twice(int method)
{
    return method == PROTO_METHOD_HELLO || method == PROTO_METHOD_PING ||
           method == PROTO_METHOD_STATS || method == PROTO_METHOD_STATS_THREAD ||
           method == PROTO_METHOD_CANCEL || method == PROTO_METHOD_SHM_ATTACH ||
           method == PROTO_METHOD_BYE || method == PROTO_METHOD_LIST_SESSION ||
           method == PROTO_METHOD_LIST_SCENE || method == PROTO_METHOD_LIST_OBJECT ||
           method == PROTO_METHOD_LIST_MESH || method == PROTO_METHOD_LIST_PAIR ||
           method == PROTO_METHOD_STATS_HISTOGRAM || method == PROTO_METHOD_CONFIG_GET ||
           method == PROTO_METHOD_CONFIG_SET || method == PROTO_METHOD_WATCH_START ||
           method == PROTO_METHOD_WATCH_STOP;
}

void srv_replies_keep(struct srv_replies *replies, uint32_t id, int method,
                      const struct proto_encoder *answer)
{
    if (method < 0 || may_run_twice(method)) {
        return;
    }
    struct srv_kept_reply *place = &replies->kept[replies->next++ % PROTO_REPLIES_KEPT];
    PCCD_ASSERT(answer->bytes > 0 && answer->bytes <= sizeof answer->data);
    free(place->data);
    place->id = id;
    place->bytes = answer->bytes;
    place->data = malloc(answer->bytes);
    if (place->data == NULL) {
        replies->is_broken = true;
        return;
    }
    memcpy(place->data, answer->data, answer->bytes);
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

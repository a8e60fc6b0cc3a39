/* deferred.c - a message that waits for room. */
#include "deferred.h"

#include <stdlib.h>
#include <string.h>

#include "invariant.h"
#include "pccd_types.h"

int srv_deferred_keep(struct srv_deferred *deferred, const void *message, size_t bytes)
{
    PCCD_ASSERT(deferred->message == NULL);
    if (deferred->turns == SRV_DEFERRED_MAX) {
        return PCCD_E_LIMIT;
    }
    struct srv_message *copy = malloc(sizeof *copy + bytes);
    if (copy == NULL) {
        return PCCD_E_NOMEM;
    }
    copy->bytes = bytes;
    memcpy(copy->data, message, bytes);
    deferred->message = copy;
    deferred->turns++;
    return 0;
}

struct srv_message *srv_deferred_take(struct srv_deferred *deferred)
{
    struct srv_message *message = deferred->message;
    deferred->message = NULL;
    return message;
}

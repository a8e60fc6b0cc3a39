/* putoff.c - a message that waits for room.
 *
 * Room:     server. See putoff.h.
 * Does:     one copy.
 * Threads:  [loop]
 */
#include "putoff.h"

#include <stdlib.h>
#include <string.h>

#include "invariant.h"
#include "pccd_types.h"

int srv_putoff_keep(struct srv_putoff *put_off, const void *message, size_t bytes)
{
    PCCD_ASSERT(put_off->message == NULL);
    if (put_off->turns == SRV_PUT_OFF_MAX) {
        return PCCD_E_LIMIT;
    }
    struct srv_message *copy = malloc(sizeof *copy + bytes);
    if (copy == NULL) {
        return PCCD_E_NOMEM;
    }
    copy->bytes = bytes;
    memcpy(copy->data, message, bytes);
    put_off->message = copy;
    put_off->turns++;
    return 0;
}

struct srv_message *srv_putoff_take(struct srv_putoff *put_off)
{
    struct srv_message *message = put_off->message;
    put_off->message = NULL;
    return message;
}

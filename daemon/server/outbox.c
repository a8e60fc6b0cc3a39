/* outbox.c - answers that go out together. */
#include "outbox.h"

#include <string.h>

bool srv_outbox_add(struct srv_outbox *outbox, struct srv_conn *conn, const void *message,
                    size_t bytes)
{
    if (outbox->count == SRV_OUTBOX_ENTRIES || bytes > SRV_OUTBOX_BYTES) {
        return false;
    }
    outbox->entries[outbox->count].conn = conn;
    outbox->entries[outbox->count].bytes = bytes;
    memcpy(outbox->entries[outbox->count].data, message, bytes);
    outbox->count++;
    return true;
}

bool srv_outbox_is_due(struct srv_outbox *outbox)
{
    return outbox->count > 0 && ++outbox->handled >= SRV_OUTBOX_ENTRIES;
}

void srv_outbox_clear(struct srv_outbox *outbox)
{
    outbox->count = 0;
    outbox->handled = 0;
}

/* server.c - the connections that were refused, and answers that go out together. */
#include "server.h"

#include <stddef.h>
#include <string.h>

void srv_refused_add(struct srv_refused *refused, struct srv_refused_link *link,
                     struct srv_conn *conn)
{
    *link = (struct srv_refused_link){.conn = conn, .older = refused->last};
    if (refused->last != NULL) {
        refused->last->newer = link;
    } else {
        refused->first = link;
    }
    refused->last = link;
    refused->count++;
}

void srv_refused_remove(struct srv_refused *refused, struct srv_refused_link *link)
{
    if (link->conn == NULL) {
        return;
    }
    if (link->older != NULL) {
        link->older->newer = link->newer;
    } else {
        refused->first = link->newer;
    }
    if (link->newer != NULL) {
        link->newer->older = link->older;
    } else {
        refused->last = link->older;
    }
    refused->count--;
    *link = (struct srv_refused_link){.conn = NULL};
}

/* ---- Answers that go out together. */

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

/* refused.c - connections of clients that are refused, until they have heard so.
 *
 * Room:     server. See refused.h.
 * Does:     a list through the connections.
 * Threads:  [loop]
 */
#include "refused.h"

#include <stddef.h>

#include "conn.h"
#include "dispatch.h"
#include "invariant.h"

void srv_refused_add(struct srv_refused *refused, struct srv_conn *conn)
{
    conn->refused = (struct srv_refused_link){.older = refused->last, .is_in = true};
    if (refused->last != NULL) {
        refused->last->refused.newer = conn;
    } else {
        refused->first = conn;
    }
    refused->last = conn;
    refused->count++;
}

void srv_refused_remove(struct srv_refused *refused, struct srv_conn *conn)
{
    const struct srv_refused_link link = conn->refused;
    if (!link.is_in) {
        return;
    }
    if (link.older != NULL) {
        link.older->refused.newer = link.newer;
    } else {
        refused->first = link.newer;
    }
    if (link.newer != NULL) {
        link.newer->refused.older = link.older;
    } else {
        refused->last = link.older;
    }
    refused->count--;
    conn->refused = (struct srv_refused_link){.is_in = false};
}

void srv_refused_shrink(struct srv_refused *refused, uint32_t count)
{
    while (refused->count > count) {
        struct srv_conn *conn = refused->first;
        if (conn->state == SRV_CONN_OPEN) {
            srv_conn_read(conn); /* it may have spoken; it may even find a place */
        }
        if (conn->refused.is_in && conn->fd >= 0 && conn->state == SRV_CONN_OPEN) {
            srv_dispatch_refuse_silent(conn->session);
        }
        if (conn->refused.is_in) {
            srv_conn_close(conn); /* takes it out */
        }
        PCCD_ASSERT(conn != refused->first);
    }
}

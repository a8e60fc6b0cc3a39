/* refused.c - connections of clients that are refused, until they have heard so. */
#include "refused.h"

#include <stddef.h>

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

/* workspace.h - the scratch memory of each thread that computes.
 *
 * Threads: made and freed on [loop]; each belongs to one thread that computes, or to
 * [loop] while nothing is computed.
 */
#ifndef SRV_WORKSPACE_H
#define SRV_WORKSPACE_H

#include "codec.h"
#include "compute.h"
#include "engine.h"
#include "shm.h"

struct srv_workspace {
    struct eng_affinity *affinity; /* processors that may be used; NULL: no team */
    struct proto_encoder
        *encoder; /* of answers that are sent from here; NULL: no workspace */
    struct proto_segment *segments; /* PROTO_SEGMENTS_MAX: the step's table */
};

_Static_assert(SRV_PLACES <= ENG_TEAMS_MAX, "each has a team");

/* The workspace of that number, made if there is none: 0, or PCCD_E_NOMEM. [loop] */
int srv_workspace_init(struct srv_workspace workspaces[SRV_RUNNERS_MAX], uint32_t number);
void srv_workspace_deinit(struct srv_workspace workspaces[SRV_RUNNERS_MAX]);

/* That of the calling thread. [compute] */
static inline struct srv_workspace *
srv_workspace_of_thread(struct srv_workspace workspaces[SRV_RUNNERS_MAX])
{
    return &workspaces[eng_payer()->number];
}

#endif

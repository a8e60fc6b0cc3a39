/* desk.h - what each thread that computes has for itself.
 *
 * Room:     service. May include: compute.h, the engine's and the protocol's headers.
 * Does:     keep what one job at a time needs: the table of a step's segments, the
 *           encoder of its answer, the processors of its team.
 * Threads:  made and freed on [loop]; each belongs to one thread that computes, or to
 *           [loop] while nothing is computed.
 */
#ifndef SRV_DESK_H
#define SRV_DESK_H

#include "codec.h"
#include "compute.h"
#include "memory.h"
#include "place.h"
#include "shm.h"

struct srv_desk {
    struct eng_places places;      /* processors that may be used; constant */
    struct proto_encoder *encoder; /* of answers that are sent from here; NULL: no desk */
    struct proto_segment *segments; /* PROTO_SEGMENTS_MAX: the step's table */
};

_Static_assert(SRV_RUNNERS_MAX <= ENG_TEAMS_MAX, "each has a team");

/* The desk of that number, made if there is none: 0, or PCCD_E_NOMEM. [loop] */
int srv_desk_init(struct srv_desk desks[SRV_RUNNERS_MAX], uint32_t number);
void srv_desk_deinit(struct srv_desk desks[SRV_RUNNERS_MAX]);

/* That of the calling thread. [compute] */
static inline struct srv_desk *srv_desk_of_thread(struct srv_desk desks[SRV_RUNNERS_MAX])
{
    return &desks[eng_payer()->number];
}

#endif

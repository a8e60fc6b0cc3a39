/* desk.c - what each thread that computes has for itself.
 *
 * Room:     service. See desk.h.
 * Does:     allocate it when a thread is started, not before.
 * Threads:  [loop]
 */
#include "desk.h"

#include <stdlib.h>

#include "pccd_types.h"
#include "proto_limits.h"

int srv_desk_init(struct srv_desk desks[SRV_RUNNERS_MAX], uint32_t number)
{
    struct srv_desk *desk = &desks[number];
    if (desk->encoder != NULL) {
        return 0;
    }
    struct proto_encoder *encoder = malloc(sizeof *encoder);
    struct proto_segment *segments = malloc(PROTO_SEGMENTS_MAX * sizeof *segments);
    if (encoder == NULL || segments == NULL) {
        free(encoder);
        free(segments);
        return PCCD_E_NOMEM;
    }
    if (number == 0) {
        eng_places_init(&desk->places);
    } else {
        eng_places_for_team(&desks[0].places, number, &desk->places);
    }
    desk->encoder = encoder;
    desk->segments = segments;
    return 0;
}

void srv_desk_deinit(struct srv_desk desks[SRV_RUNNERS_MAX])
{
    for (uint32_t i = 0; i < SRV_RUNNERS_MAX; i++) {
        free(desks[i].encoder);
        free(desks[i].segments);
    }
}

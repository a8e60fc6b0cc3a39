/* workspace.c - what each thread that computes has for itself. */
#include "workspace.h"

#include <stdlib.h>

#include "pccd_types.h"
#include "proto_limits.h"

int srv_workspace_init(struct srv_workspace workspaces[SRV_RUNNERS_MAX], uint32_t number)
{
    struct srv_workspace *workspace = &workspaces[number];
    if (workspace->encoder != NULL) {
        return 0;
    }
    bool has_team = number < SRV_PLACES;
    struct proto_encoder *encoder = malloc(sizeof *encoder);
    struct proto_segment *segments = malloc(PROTO_SEGMENTS_MAX * sizeof *segments);
    struct eng_affinity *affinity = has_team ? malloc(sizeof *affinity) : NULL;
    if (encoder == NULL || segments == NULL || (has_team && affinity == NULL)) {
        free(encoder);
        free(segments);
        free(affinity);
        return PCCD_E_NOMEM;
    }
    if (number == 0) {
        eng_affinity_init(affinity);
    } else if (has_team) {
        eng_affinity_for_team(workspaces[0].affinity, number, affinity);
    }
    *workspace = (struct srv_workspace){affinity, encoder, segments};
    return 0;
}

void srv_workspace_deinit(struct srv_workspace workspaces[SRV_RUNNERS_MAX])
{
    for (uint32_t i = 0; i < SRV_RUNNERS_MAX; i++) {
        free(workspaces[i].affinity);
        free(workspaces[i].encoder);
        free(workspaces[i].segments);
    }
}

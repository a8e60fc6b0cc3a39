/* workspace.c - what each thread that computes has for itself.
 *
 * Room:     service. See workspace.h.
 * Does:     allocate it when a thread is started, not before.
 * Threads:  [loop]
 */
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
    struct proto_encoder *encoder = malloc(sizeof *encoder);
    struct proto_segment *segments = malloc(PROTO_SEGMENTS_MAX * sizeof *segments);
    if (encoder == NULL || segments == NULL) {
        free(encoder);
        free(segments);
        return PCCD_E_NOMEM;
    }
    if (number == 0) {
        eng_affinity_init(&workspace->affinity);
    } else {
        eng_affinity_for_team(&workspaces[0].affinity, number, &workspace->affinity);
    }
    workspace->encoder = encoder;
    workspace->segments = segments;
    return 0;
}

void srv_workspace_deinit(struct srv_workspace workspaces[SRV_RUNNERS_MAX])
{
    for (uint32_t i = 0; i < SRV_RUNNERS_MAX; i++) {
        free(workspaces[i].encoder);
        free(workspaces[i].segments);
    }
}

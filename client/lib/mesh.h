/* mesh.h - uploads a mesh to the daemon. */
#ifndef CLI_MESH_H
#define CLI_MESH_H

#include "client.h"
#include "flight.h"

/* Send all that announces, uploads and commits a mesh with the arrays of `copy`, under
 * the handle `want`, or under any when that is 0: then the announcement alone is waited
 * for. */
int cli_mesh_send(struct cli_flight *flight, const struct registry_mesh *copy,
                  uint32_t want, uint32_t *handle);

#endif

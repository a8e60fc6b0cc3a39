/* mesh.h - the upload of a mesh.
 *
 * Room:     client/lib, private. May include: keep.h.
 * Does:     what restore.c needs of mesh.c.
 * Threads:  [owner].
 */
#ifndef CLI_MESH_H
#define CLI_MESH_H

#include "keep.h"

/* Announce, upload and commit a mesh with the arrays of `copy`, under the handle `want`,
 * or any when that is 0. Nothing half-made is left behind. */
int cli_mesh_make(struct pccd_client *client, const struct cli_kept_mesh *copy,
                  uint32_t want, uint32_t *handle);

#endif

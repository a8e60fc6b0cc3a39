/* near_line.h - where a record of what is near lies in a scene.
 *
 * Threads: one.
 */
#ifndef CTL_NEAR_LINE_H
#define CTL_NEAR_LINE_H

#include "pccd.h"
#include "world.h"

/* At the end of the scene's step that was asked about, 0 or 1; edges of its meshes are
 * known (world_edges). False: the record names what there is not. */
bool near_line(const struct registry_scene *scene, const struct pccd_near *near,
               uint32_t end, double ends[2][3]);

#endif

/* world.h - the meshes, scenes and positions at one point of a recording.
 *
 * Follow the chunks of a recording into a registry: meshes, scenes, objects and the
 * positions at both ends of the last step, exactly as the daemon computes them.
 *
 * Threads: one.
 */
#ifndef CTL_WORLD_H
#define CTL_WORLD_H

#include "error.h"
#include "pccd.h"
#include "reader.h"
#include "registry.h"

/* Follow a chunk that is not a step. PCCD_E_FORMAT when it speaks of what there is not;
 * PCCD_E_NOMEM. Kinds that change nothing are let by. */
int world_follow(struct registry *world, const struct record_view *view,
                 struct ctl_error *error);
/* A step that the daemon took: x0 and x1 of the scene's objects. `slot` is the payload
 * behind `frame`. Nothing changes on failure. */
int world_step(struct registry *world, const struct record_frame *frame,
               const uint8_t *slot, struct ctl_error *error);

/* The edges of a mesh as records number them, made at the first call. */
int world_edges(struct registry_mesh *mesh, struct ctl_error *error);

/* Is a vertex (points 1) or an edge (2) free: an edge that no triangle has, a point that
 * is named and that no triangle and no edge has? Its edges were made (world_edges). */
bool world_is_free(const struct registry_mesh *mesh, uint32_t points, uint32_t feature);
/* Features of a mesh that have so many points: how many, and the vertices of one; NULL if
 * there is none of that index. A vertex is its own. */
uint32_t world_feature_count(const struct registry_mesh *mesh, uint32_t points);
const uint32_t *world_feature(const struct registry_mesh *mesh, uint32_t points,
                              const uint32_t *feature);
/* Of a feature of an object that has these vertices. */
double world_radius(const struct registry_object *object, const uint32_t *v,
                    uint32_t count);

/* ---- Where a record of what is near lies in a scene. */

/* At the end of the scene's step that was asked about, 0 or 1; edges of its meshes are
 * known (world_edges). False: the record names what there is not. */
bool near_line(const struct registry_scene *scene, const struct pccd_near *near,
               uint32_t end, double ends[2][3]);

#endif

/* inspect_pack.h - packs one part of a step (positions, contacts, boxes, events) for the
 * page of `pccdctl inspect`.
 *
 * Threads: one.
 *
 * All append to inspect->data and return a new reference, or NULL without memory.
 */
#ifndef CTL_INSPECT_PACK_H
#define CTL_INSPECT_PACK_H

#include "inspect_data.h"
#include "play.h"

/* [{"handle", "mesh", "x0", "x1", "radius"}] of the step's scene, or both ends of one
 * moment; `meshes` gets those that are not in the file yet. Edges of the scene's meshes
 * are known. */
enum inspect_moment { INSPECT_BEGIN, INSPECT_END, INSPECT_BOTH };
json_t *inspect_pack_objects(struct inspect *inspect, const struct registry_scene *scene,
                             enum inspect_moment moment, json_t *meshes);
/* {"at", "count"} */
json_t *inspect_pack_contacts(struct inspect *inspect, const struct play_step *step);
/* The same of what is near; likewise. */
json_t *inspect_pack_lines(struct inspect *inspect, const struct play_near *near);
/* {"at", "count", "threads", "lost"}, or null: it was not recorded. */
json_t *inspect_pack_events(struct inspect *inspect, const struct step_trace *trace);
/* {TREE: [{"at", "count"}], ..} of what the step used, each level, the root first. */
json_t *inspect_pack_boxes(struct inspect *inspect, const struct play_step *step);

/* [blob, offset] of a section of the step that is being packed. */
json_t *inspect_section(const struct inspect *inspect, size_t offset);

#endif

/* place.h - where the objects are that another daemon would have to be told of.
 *
 * Room:     client/lib, private. May include: keep.h.
 * Does:     read the positions of answered steps out of their slots, as late as possible.
 * Threads:  [owner].
 */
#ifndef CLI_PLACE_H
#define CLI_PLACE_H

#include "keep.h"

/* NULL: there is none of that handle. */
struct cli_kept_scene *cli_keep_scene(struct pccd_client *client, uint32_t handle);
struct cli_kept_object *cli_keep_object(struct cli_kept_scene *scene, uint32_t handle);

/* The object stands where its mesh was registered, whatever steps before `step` said. */
void cli_place_reset(struct cli_kept_object *object, uint64_t step);

/* The step in a slot has been answered and its positions are the last: the slot is KEPT,
 * or free again when nothing is kept. */
void cli_place_answered(struct pccd_client *client, uint32_t slot, uint64_t step);

#endif

/* levels.h - copies the boxes of one level of a scene's tree, so that a user can look at
 * them (`scene.boxes`).
 *
 * Threads: [compute], between steps.
 */
#ifndef ENG_LEVELS_H
#define ENG_LEVELS_H

#include <stdint.h>

#include "pccd_trace.h"

struct eng_scene;

/* The boxes of a level, the root being level 0, as the last step that used the tree left
 * them. Copies the count boxes from the first on that there are; `to` is not looked at
 * with count 0. Returns how many boxes the level has; 0: there is no such level, or no
 * step has made the tree since objects came or went, or one by the other method has put
 * objects into other frames. Boxes are in coordinates: those that
 * were measured in frames are rounded outward once more. wide: O(count), with frames
 * O(features below them); paper: O(nodes down to the level). */
uint32_t eng_level_boxes(const struct eng_scene *scene, enum pccd_tree tree,
                         uint32_t level, uint32_t first, uint32_t count,
                         struct pccd_box *to);

#endif

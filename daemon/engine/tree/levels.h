/* levels.h - the boxes of a level of a scene's hierarchies, to be looked at.
 *
 * Room:     engine. May include: the C library.
 * Does:     copy what the last step left, for who wants to see why it took so long.
 * Does not: change anything, or make what no step has made.
 * Threads:  [compute], between steps.
 */
#ifndef ENG_LEVELS_H
#define ENG_LEVELS_H

#include <stdint.h>

struct eng_scene;

enum eng_tree {
    ENG_TREE_VERTICES = 0, /* of the method wide: nodes of up to 16 children */
    ENG_TREE_EDGES = 1,
    ENG_TREE_FACES = 2,
    ENG_TREE_TRIANGLES = 3, /* of the method paper: binary, over all objects */
    ENG_TREES
};

/* A box at both ends of the step; an empty one, which wide has, has low > high. */
struct eng_level_box {
    float low0[3];
    float high0[3];
    float low1[3];
    float high1[3];
};

/* The boxes of a level, the root being level 0, as the last step that used the tree left
 * them. Copies the count boxes from the first on that there are; `to` is not looked at
 * with count 0. Returns how many boxes the level has; 0: there is no such level, or no
 * step has made the tree since objects came or went, or one by the other method has put
 * objects into other frames. Boxes are in coordinates: those that
 * were measured in frames are rounded outward once more. wide: O(count), with frames
 * O(features below them); paper: O(nodes down to the level). */
uint32_t eng_level_boxes(const struct eng_scene *scene, enum eng_tree tree,
                         uint32_t level, uint32_t first, uint32_t count,
                         struct eng_level_box *to);

#endif

/* wide_faces.h - the faces of one object in the tree of faces of the method `wide`.
 *
 * What method.h says of faces_of, faces_open and faces_index. All objects have the root
 * of the tree; what is not in the object's slots is left out on the way down.
 *
 * Threads: [any] while nothing is refitted.
 */
#ifndef ENG_WIDE_FACES_H
#define ENG_WIDE_FACES_H

#include "faces.h"
#include "wide.h"

void eng_wide_faces_of(const struct eng_scene *scene, uint32_t object_idx, uint32_t end,
                       struct eng_faces *faces);
void eng_wide_faces_open(const struct eng_faces *faces, uint32_t node,
                         struct eng_faces_below *below);

uint32_t eng_wide_faces_index(const struct eng_faces *faces, uint32_t node);

#endif

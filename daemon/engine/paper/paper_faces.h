/* paper_faces.h - the faces of one object in the binary tree of the method `paper`.
 *
 * Threads: [any] while nothing is refitted or rebuilt.
 */
#ifndef ENG_PAPER_FACES_H
#define ENG_PAPER_FACES_H

#include "faces.h"
#include "trees.h"

void eng_paper_faces_of(const struct eng_scene *scene, uint32_t object_idx, uint32_t end,
                        struct eng_faces *faces);
void eng_paper_faces_open(const struct eng_faces *faces, uint32_t node,
                          struct eng_faces_below *below);

uint32_t eng_paper_faces_index(const struct eng_faces *faces, uint32_t node);

#endif

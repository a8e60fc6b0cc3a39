/* faces.h - the faces of one object in the trees of `wide`, as a search for what is near
 * sees them: sixteen boxes at a time.
 *
 * Threads: [any] while nothing is refitted; types only.
 */
#ifndef ENG_FACES_H
#define ENG_FACES_H

#include <stdbool.h>
#include <stdint.h>

#include "boxes.h"

struct eng_scene;

/* Nodes are numbers. */
struct eng_faces {
    const struct eng_scene *scene;
    uint32_t object; /* index */
    uint32_t end;    /* of the step: 0 or 1 */
    uint32_t root;
    uint32_t first; /* slots of the object's faces */
    uint32_t count;
};

/* What is below a node. */
struct eng_faces_below {
    const float (*low)[ENG_WIDE]; /* [axis][child], outward distances (boxes.h) */
    const float (*high)[ENG_WIDE];
    uint32_t children; /* a bit for each that there is: at INFINITY is none, either */
    uint32_t faces;    /* a bit for each of them that is a face */
    uint32_t child[ENG_WIDE];
    _Alignas(64) float own[2][3][ENG_WIDE]; /* room for low and high */
};

/* Below a node there are at most so many levels of opened nodes, itself included. */
#define ENG_FACES_LEVELS_MAX 8u

#endif

/* near_search.h - finds what is nearest in the trees of a method: of two objects, or of a
 * point and an object; and how often a surface winds around a point.
 *
 * Descend from the roots of two objects, the nearest boxes first, and leave out what is
 * certainly farther than the best pair so far. So the pair that is found is the same for
 * every tree, and wherever the search begins.
 *
 * Threads: one thread for one struct eng_near_search; the trees are only read.
 * Source: elementary/BOUNDS.md, "Distances of boxes".
 */
#ifndef ENG_NEAR_SEARCH_H
#define ENG_NEAR_SEARCH_H

#include "method.h"
#include "near_best.h"

/* Nodes of two objects, or leaves, that wait. */
struct eng_near_item {
    float square; /* of their distance: it is not less, but for a margin */
    uint32_t node[2];
    uint8_t leaves; /* bit i: node[i] is a leaf */
};

#define ENG_NEAR_ITEMS (ENG_LEAVES_LEVELS_MAX * ENG_WIDE * ENG_WIDE)

struct eng_near_search {
    const struct eng_method_calls *method;
    struct eng_worker *worker; /* which says when to stop */
    const struct eng_scene *scene;
    uint32_t end; /* of the step: 0 or 1 */
    struct eng_distances distances;
    struct eng_distance_order order;
    struct eng_near_best best;
    bool is_stopped;
    uint32_t steps; /* since the clock was looked at */
    struct eng_leaves leaves[2]; /* of the trees that are gone down */
    struct eng_leaves_below below[2];
    double scale;    /* of the boxes */
    bool has_shift;  /* the boxes of the first object have to be moved .. */
    double shift[3]; /* .. by that, to be beside those of the second */
    double reach;    /* what best said last */
    float limit;     /* squares of distances of boxes that are looked at are less */
    uint64_t box_tests;
    uint32_t item_count;
    struct eng_near_item items[ENG_NEAR_ITEMS];
};

/* Allocate a search. PCCD_E_NOMEM: there is nothing to free. */
int eng_near_search_new(struct eng_near_search **search);
void eng_near_search_free(struct eng_near_search *search);

/* Get ready for a moment: an end of the step whose boxes the method's trees have. */
void eng_near_search_at(struct eng_near_search *search,
                        const struct eng_method_calls *method, struct eng_worker *worker,
                        uint32_t end);

/* Find the pair of two objects whose surfaces are nearest, and within the distance, and
 * keep it in search->best. `first`, NULL or a pair of theirs, is looked at before any
 * other. False: it was stopped. */
bool eng_near_search_objects(struct eng_near_search *search, uint32_t a, uint32_t b,
                             const struct eng_near_limits *limits,
                             const struct eng_near_pair *first);

/* Set *crossings to the number of pairs of an edge of either object and a face of the
 * other that the edge passes through. False: it was stopped. */
bool eng_near_search_crossings(struct eng_near_search *search, uint32_t a, uint32_t b,
                               uint64_t *crossings);

/* Find the nearest of a vertex of one object and the faces of another, which has some; of
 * equally near ones the first. `first`, or ENG_NO_FACE, is looked at before any other. */
#define ENG_NO_FACE UINT32_MAX
bool eng_near_search_vertex(struct eng_near_search *search, uint32_t of_vertex,
                            uint32_t v, uint32_t of_faces, uint32_t first);

/* Set *winding to the winding number of an object's surface around a vertex of another.
 * *is_on: it is on the surface, and the number means nothing; not all such vertices are
 * noticed. False: it was stopped. */
bool eng_near_search_winding(struct eng_near_search *search, uint32_t of_vertex,
                             uint32_t v, uint32_t of_faces, int64_t *winding,
                             bool *is_on);

#endif

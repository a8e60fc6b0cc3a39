/* sah.h - splits a list of items where the surface area heuristic (SAH) expects the least
 * work.
 *
 * Threads: [any]; no allocation.
 * Source: MacDonald and Booth 1990 (the heuristic); Wald 2007 (bins).
 */
#ifndef ENG_SAH_H
#define ENG_SAH_H

#include "median.h"

#define ENG_SAH_BINS 32u

/* Bounds of one item. */
struct eng_sah_box {
    float lo[3];
    float hi[3];
};

struct eng_sah_bin {
    struct eng_sah_box box;
    uint32_t count;
};

/* A split on its way, one pass over the items at a time. */
struct eng_sah {
    const struct eng_sah_box *boxes; /* of the item with id `first_id` and those after */
    uint32_t first_id;
    int pass;
    uint32_t bin_count;
    float lo[3];    /* of the centroids */
    float scale[3]; /* bins for each unit; 0: no extent along this axis */
    int axis;       /* chosen, with the first bin of the right side */
    uint32_t plane;
    uint32_t left; /* the result: items on the left side; 0: no plane divides them */
    struct eng_sah_bin bins[3][ENG_SAH_BINS];
};

void eng_sah_begin(struct eng_sah *sah, uint32_t count);

/* One pass; true: the items are in order, `left` says how many come first. count >= 2. */
bool eng_sah_pass(struct eng_sah *sah, struct eng_split_item *items, uint32_t count);

#endif

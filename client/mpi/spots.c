/* spots.c - where the leaves of objects are at one moment. */
#include "spots.h"

#include <string.h>

#define SPOTS_MAX       1024u /* of a rank, and one more for each object */
#define SPOT_LEAVES_MIN 16u

static void bound(const struct ranks_pairing *pairing, struct ranks_spot *spot)
{
    for (int k = 0; k < 3; k++) {
        spot->low[k] = INFINITY;
        spot->high[k] = -INFINITY;
    }
    for (uint32_t i = 0; i < spot->count; i++) {
        struct ranks_visitor leaf;
        double low[3], high[3];
        ranks_visitor_make(pairing, spot->object, spot->begin + i, &leaf);
        ranks_leaf_bounds(&leaf, low, high);
        for (int k = 0; k < 3; k++) {
            spot->low[k] = fmin(spot->low[k], low[k]);
            spot->high[k] = fmax(spot->high[k], high[k]);
        }
        if (i == spot->count / 2) {
            memcpy(spot->x, leaf.x[0], sizeof spot->x);
        }
    }
}

int ranks_spots_make(const struct ranks_pairing *pairing, struct ranks_spot **spots,
                     uint32_t *count)
{
    struct pccd_mpi *world = pairing->world;
    uint64_t leaves = 0;
    for (uint32_t o = 0; o < world->object_count; o++) {
        leaves += world->objects[o]->own_count;
    }
    uint32_t each = (uint32_t)(leaves / SPOTS_MAX) + 1;
    each = each < SPOT_LEAVES_MIN ? SPOT_LEAVES_MIN : each;
    *spots = ranks_array(leaves / each + world->object_count, sizeof **spots);
    *count = 0;
    if (*spots == NULL) {
        return ranks_no_memory(world);
    }
    for (uint32_t o = 0; o < world->object_count; o++) {
        uint32_t own = world->objects[o]->own_count;
        bool is_asked = ranks_is_asked_with_any(pairing, o);
        for (uint32_t begin = 0; begin < own && is_asked; begin += each) {
            struct ranks_spot *spot = &(*spots)[(*count)++];
            *spot = (struct ranks_spot){.object = o, .begin = begin};
            spot->count = own - begin < each ? own - begin : each;
            bound(pairing, spot);
        }
    }
    return PCCD_OK;
}

/* features.c - the vertices of features, for those who read records. */
#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

#include "parts.h"

static void note_leaf(const struct ranks_leaf *leaf, struct ranks_local *local)
{
    for (uint32_t k = 0; k < 3; k++) {
        if (leaf->side[k] != RANKS_NONE) {
            uint32_t a = leaf->v[k], b = leaf->v[(k + 1) % 3];
            uint32_t *ends = local->ends[ranks_place_of(local->edges, local->edge_count,
                                                        leaf->side[k])];
            ends[0] = a < b ? a : b;
            ends[1] = a < b ? b : a;
        }
    }
    uint32_t at = ranks_place_of(local->triangles, local->triangle_count, leaf->number);
    if (at < local->triangle_count) {
        memcpy(local->corners[at], leaf->v, sizeof leaf->v);
    }
}

static int make_tables(struct pccd_mpi *world, struct ranks_object *object)
{
    struct ranks_local *local = &object->local;
    if (local->ends != NULL && local->corners != NULL) {
        return PCCD_OK;
    }
    free(local->ends);
    free(local->corners);
    local->ends = ranks_array(local->edge_count, sizeof *local->ends);
    local->corners = ranks_array(local->triangle_count, sizeof *local->corners);
    if (local->ends == NULL || local->corners == NULL) {
        return ranks_no_memory(world);
    }
    for (uint32_t i = 0; i < object->own_count; i++) {
        note_leaf(&object->own[i], local);
    }
    for (uint32_t i = 0; i < object->ghost_count; i++) {
        note_leaf(&object->ghosts[i], local);
    }
    return PCCD_OK;
}

int pccd_mpi_feature(struct pccd_mpi *world, uint32_t object, uint32_t points,
                     uint32_t feature, uint32_t vertices[3])
{
    if (world == NULL) {
        return PCCD_E_INVAL;
    }
    if (vertices == NULL) {
        return ranks_missing(&world->link, "vertices");
    }
    struct ranks_object *found = ranks_find_object(world, object);
    if (found == NULL || points < 1 || points > 3) {
        return ranks_fail(&world->link, found == NULL ? PCCD_E_HANDLE : PCCD_E_INVAL,
                          "rank %d: no object %" PRIu32 ", or no feature of %" PRIu32
                          " points",
                          world->link.rank, object, points);
    }
    const struct ranks_local *local = &found->local;
    const uint32_t *numbers = points == 1   ? local->vertices
                              : points == 2 ? local->edges
                                            : local->triangles;
    uint32_t count = points == 1   ? local->vertex_count
                     : points == 2 ? local->edge_count
                                   : local->triangle_count;
    uint32_t at = ranks_place_of(numbers, count, feature);
    if (at == count) {
        return ranks_fail(&world->link, PCCD_E_INDEX,
                          "rank %d: feature %" PRIu32 " of object %" PRIu32
                          " is in none of its records",
                          world->link.rank, feature, object);
    }
    int status = points > 1 ? make_tables(world, found) : PCCD_OK;
    if (status == PCCD_OK) {
        memcpy(vertices,
               points == 1   ? &local->vertices[at]
               : points == 2 ? local->ends[at]
                             : local->corners[at],
               points * sizeof *vertices);
    }
    return status;
}

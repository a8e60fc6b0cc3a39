/* cut.c - the scene in pieces along a curve. */
#include "cut.h"

#include <float.h>
#include <stdlib.h>
#include <string.h>

#include "parts.h"
#include "rank_sort.h"

/* ---- Hilbert's curve in three dimensions: what is near along it is near in space. */

#define BITS 21u

/* Skilling's AxestoTranspose. */
static void transpose(uint32_t x[3])
{
    const uint32_t most = 1u << (BITS - 1);
    for (uint32_t q = most; q > 1; q >>= 1) {
        uint32_t p = q - 1;
        for (int i = 0; i < 3; i++) {
            if (x[i] & q) {
                x[0] ^= p;
            } else {
                uint32_t t = (x[0] ^ x[i]) & p;
                x[0] ^= t;
                x[i] ^= t;
            }
        }
    }
    x[1] ^= x[0];
    x[2] ^= x[1];
    uint32_t t = 0;
    for (uint32_t q = most; q > 1; q >>= 1) {
        t ^= x[2] & q ? q - 1 : 0;
    }
    for (int i = 0; i < 3; i++) {
        x[i] ^= t;
    }
}

/* Return the place of a point on the curve, 63 bits. low, high: of the box that is
 * filled; its longest side is as long as the curve's cube, so that pieces of the curve
 * are about as long as they are wide in a flat box, too. Points beyond it have the place
 * of the nearest in it. */
static uint64_t place_of(const double x[3], const double low[3], const double high[3])
{
    uint32_t cell[3];
    double size = 0;
    for (int k = 0; k < 3; k++) {
        size = high[k] - low[k] > size ? high[k] - low[k] : size;
    }
    for (int k = 0; k < 3; k++) {
        double at = size > 0 ? (x[k] - low[k]) / size * (1u << BITS) : 0;
        cell[k] = at >= (1u << BITS) - 1 ? (1u << BITS) - 1 : at > 0 ? (uint32_t)at : 0;
    }
    transpose(cell);
    uint64_t place = 0;
    for (uint32_t bit = BITS; bit-- > 0;) {
        for (int k = 0; k < 3; k++) {
            place = place << 1 | (cell[k] >> bit & 1u);
        }
    }
    return place;
}

/* ---- where leaves are ------------------------------------------------------------- */

/* A plan for the vertices of own leaves alone, and where they are: x[object]. */
static int fetch_own(struct pccd_mpi *world, double (***x)[3])
{
    int status = PCCD_OK;
    for (uint32_t o = 0; o < world->object_count && status == PCCD_OK; o++) {
        struct ranks_object *object = world->objects[o];
        free(object->ghosts);
        object->ghosts = NULL;
        object->ghost_count = 0;
        free(object->neighbours);
        object->neighbours = NULL;
        object->neighbour_count = 0;
        object->neighbour_rings = 0;
        object->is_built = false;
        status = ranks_local_make(world, object);
    }
    status = ranks_agree_on(&world->link, status);
    if (status == PCCD_OK) {
        status = ranks_plan_make(world);
    }
    return status == PCCD_OK ? ranks_positions_fetch(world, RANKS_LAST_END, x) : status;
}

/* The box of all vertices: low, then -high. */
static int bound(struct pccd_mpi *world, double (*const *x)[3], double box[6])
{
    for (int k = 0; k < 6; k++) {
        box[k] = DBL_MAX;
    }
    for (uint32_t o = 0; o < world->object_count; o++) {
        for (uint32_t i = 0; i < world->objects[o]->local.vertex_count; i++) {
            for (int k = 0; k < 3; k++) {
                box[k] = x[o][i][k] < box[k] ? x[o][i][k] : box[k];
                box[k + 3] = -x[o][i][k] < box[k + 3] ? -x[o][i][k] : box[k + 3];
            }
        }
    }
    int status = ranks_min_doubles(&world->link, box, 6);
    for (int k = 3; k < 6; k++) {
        box[k] = -box[k];
    }
    return status;
}

/* All own leaves and their places, in the order of these. */
static int place_leaves(struct pccd_mpi *world, double (*const *x)[3],
                        const double box[6], uint64_t count,
                        struct ranks_leaf_in_transit *leaves)
{
    uint64_t at = 0;
    int status = PCCD_OK;
    struct ranks_leaf_in_transit *sorted = ranks_array(count, sizeof *sorted);
    struct ranks_key *keys = ranks_array(2 * count, sizeof *keys);
    uint32_t(*corners)[3] = ranks_array(count, sizeof *corners);
    if (sorted == NULL || keys == NULL || corners == NULL) {
        status = ranks_no_memory(world);
    }
    for (uint32_t o = 0; o < world->object_count && status == PCCD_OK; o++) {
        const struct ranks_object *object = world->objects[o];
        status = ranks_local_corners(world, &object->local, object->own,
                                     object->own_count, corners);
        for (uint32_t i = 0; i < object->own_count && status == PCCD_OK; i++, at++) {
            double middle[3];
            for (int k = 0; k < 3; k++) {
                middle[k] = (x[o][corners[i][0]][k] + x[o][corners[i][1]][k] +
                             x[o][corners[i][2]][k]) /
                            3;
            }
            sorted[at] = (struct ranks_leaf_in_transit){
                .place = place_of(middle, box, box + 3),
                .object = o,
                .weight = object->weights != NULL ? object->weights[i] : 1,
                .leaf = object->own[i]};
            keys[at] = (struct ranks_key){sorted[at].place, at};
        }
    }
    if (status == PCCD_OK) {
        const struct ranks_key *order = ranks_sort(keys, keys + count, count);
        for (uint64_t i = 0; i < count; i++) {
            leaves[i] = sorted[order[i].value];
        }
    }
    free(sorted);
    free(keys);
    free(corners);
    return status;
}

/* ---- moving ----------------------------------------------------------------------- */

/* The leaves that came, to their objects, along the curve. */
static int settle(struct pccd_mpi *world, const struct ranks_leaf_in_transit *leaves,
                  uint64_t count)
{
    struct ranks_key *keys = ranks_array(2 * count, sizeof *keys);
    if (keys == NULL) {
        return ranks_no_memory(world);
    }
    for (uint32_t o = 0; o < world->object_count; o++) {
        world->objects[o]->own_count = 0;
    }
    /* By number first, so that what has one place is in one order wherever it was. */
    for (uint64_t i = 0; i < count; i++) {
        keys[i] = (struct ranks_key){leaves[i].leaf.number, i};
        world->objects[leaves[i].object]->own_count++;
    }
    struct ranks_key *sorted = ranks_sort(keys, keys + count, count);
    struct ranks_key *other = sorted == keys ? keys + count : keys;
    for (uint64_t i = 0; i < count; i++) {
        sorted[i].key = leaves[sorted[i].value].place;
    }
    sorted = ranks_sort(sorted, other, count);
    int status = PCCD_OK;
    for (uint32_t o = 0; o < world->object_count && status == PCCD_OK; o++) {
        struct ranks_object *object = world->objects[o];
        free(object->own);
        object->own = ranks_array(object->own_count, sizeof *object->own);
        status = object->own == NULL ? ranks_no_memory(world) : PCCD_OK;
        object->own_count = 0;
    }
    for (uint64_t i = 0; i < count && status == PCCD_OK; i++) {
        const struct ranks_leaf_in_transit *leaf = &leaves[sorted[i].value];
        struct ranks_object *object = world->objects[leaf->object];
        object->own[object->own_count++] = leaf->leaf;
    }
    free(keys);
    return status;
}

/* Each leaf to its rank; *leaves are gone then. */
static int move(struct pccd_mpi *world, struct ranks_leaf_in_transit **leaves,
                uint64_t count, const struct ranks_pieces *pieces)
{
    struct ranks_link *link = &world->link;
    struct ranks_leaf_in_transit *came = NULL;
    uint64_t came_count = 0, slice = 0;
    struct ranks_post post = {.item_bytes = sizeof *came,
                              .items = *leaves,
                              .to = ranks_array(count, sizeof *post.to),
                              .count = count};
    post.is_lost = post.to == NULL;
    *leaves = NULL;
    for (uint64_t i = 0; i < count && !post.is_lost; i++) {
        const struct ranks_leaf_in_transit *leaf = post.items;
        while (leaf[i].place >= pieces->ends[slice]) {
            slice++;
        }
        post.to[i] = pieces->rank[slice];
    }
    int status = ranks_post_deal(link, &post, (void **)&came, &came_count);
    if (status == PCCD_OK) {
        status = ranks_agree_on(link, settle(world, came, came_count));
        link->broken = status; /* leaves may be lost */
    }
    free(came);
    return status;
}

/* The first object of a mesh takes its leaves; another one gets a copy of that one's. */
static int take_leaves(struct pccd_mpi *world)
{
    for (uint32_t o = 0; o < world->object_count; o++) {
        struct ranks_object *object = world->objects[o];
        struct ranks_mesh *mesh = object->mesh;
        if (object->own != NULL) {
            continue;
        }
        if (mesh->leaves != NULL) {
            object->own = mesh->leaves;
            object->own_count = mesh->leaf_count;
            mesh->leaves = NULL;
            continue;
        }
        for (uint32_t other = 0; other < world->object_count; other++) {
            const struct ranks_object *twin = world->objects[other];
            if (twin->mesh == mesh && twin->own != NULL) {
                object->own = ranks_array(twin->own_count, sizeof *object->own);
                if (object->own == NULL) {
                    return ranks_no_memory(world);
                }
                memcpy(object->own, twin->own, twin->own_count * sizeof *object->own);
                object->own_count = twin->own_count;
                break;
            }
        }
    }
    return PCCD_OK;
}

static int cut(struct pccd_mpi *world, double (***x)[3])
{
    struct ranks_link *link = &world->link;
    struct ranks_pieces pieces = {.count = 0};
    double box[6];
    uint64_t count = 0;
    int status = fetch_own(world, x);
    if (status == PCCD_OK) {
        status = bound(world, *x, box);
    }
    if (status != PCCD_OK) {
        return status;
    }
    for (uint32_t o = 0; o < world->object_count; o++) {
        count += world->objects[o]->own_count;
    }
    struct ranks_leaf_in_transit *leaves = ranks_array(count, sizeof *leaves);
    status = leaves == NULL ? ranks_no_memory(world)
                            : place_leaves(world, *x, box, count, leaves);
    status = ranks_agree_on(link, status);
    if (status == PCCD_OK) {
        status = ranks_pieces_find(world, leaves, count, &pieces);
    }
    if (status == PCCD_OK) {
        status = move(world, &leaves, count, &pieces);
    }
    ranks_pieces_deinit(&pieces);
    free(leaves);
    return status;
}

/* Local meshes and the plan of what there is now. */
static int look_around(struct pccd_mpi *world)
{
    int status = PCCD_OK;
    for (uint32_t o = 0; o < world->object_count && status == PCCD_OK; o++) {
        status = ranks_local_make(world, world->objects[o]);
        world->objects[o]->own_vertex_count = world->objects[o]->local.vertex_count;
    }
    status = ranks_agree_on(&world->link, status);
    return status == PCCD_OK ? ranks_plan_make(world) : status;
}

int ranks_cut(struct pccd_mpi *world)
{
    struct ranks_link *link = &world->link;
    double(**x)[3] = NULL;
    world->is_cut = world->is_covered = false;
    int status = ranks_agree_on(link, take_leaves(world));
    if (status == PCCD_OK) {
        status = cut(world, &x);
    }
    ranks_positions_free(world, x);
    if (status == PCCD_OK) {
        status = look_around(world);
    }
    if (status == PCCD_OK) {
        world->is_cut = true;
        world->share.imbalance = 1; /* nothing is known of this one */
        world->share.cuts++;
    }
    return status;
}

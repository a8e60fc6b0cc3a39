/* cut.c - the scene in pieces along a curve.
 *
 * Room:     client/mpi.
 * Does:     find the places of the cuts by a search over all places, without moving
 *           anything; then move each leaf once.
 * Threads:  one.
 * Source:   cut.h.
 */
#include "cut.h"

#include <float.h>
#include <stdlib.h>
#include <string.h>

#include "curve.h"
#include "local.h"
#include "places.h"
#include "rank_sort.h"

#define PLACE_BITS  63u /* of the curve */
#define SEARCH_BITS 4u  /* that one round finds out */
#define ROUND_WAYS  ((1u << SEARCH_BITS) - 1)

/* A leaf under way. */
struct traveller {
    uint64_t place;
    uint64_t below; /* the weight of those before it here */
    uint32_t object, weight;
    struct ranks_leaf leaf;
};

/* ---- where leaves are ------------------------------------------------------------- */

/* Positions of the own leaves' vertices: a plan for them alone, then x[object]. */
static int fetch_own(struct pccd_mpi *world, double (**x)[3])
{
    uint32_t count = world->object_count;
    const double(**given)[3] = ranks_array(count, sizeof *given);
    int status = given == NULL ? ranks_no_memory(world) : PCCD_OK;
    for (uint32_t o = 0; o < count && status == PCCD_OK; o++) {
        struct ranks_object *object = world->objects[o];
        free(object->ghosts);
        object->ghosts = NULL;
        object->ghost_count = 0;
        free(object->neighbours);
        object->neighbours = NULL;
        object->neighbour_count = 0;
        object->neighbour_rings = 0;
        object->is_built = false;
        given[o] = (const double(*)[3])object->x;
        status = ranks_local_make(world, object);
        if (status == PCCD_OK) {
            x[o] = ranks_array(object->local.vertex_count, sizeof *x[o]);
            status = x[o] == NULL ? ranks_no_memory(world) : PCCD_OK;
        }
    }
    status = ranks_agree_on(&world->link, status);
    if (status == PCCD_OK) {
        status = ranks_plan_make(world);
    }
    if (status == PCCD_OK) {
        status = ranks_plan_send(world, given, x);
    }
    free((void *)given);
    return status;
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
                        const double box[6], uint64_t count, struct traveller *leaves)
{
    uint64_t at = 0;
    int status = PCCD_OK;
    struct traveller *sorted = ranks_array(count, sizeof *sorted);
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
            sorted[at] = (struct traveller){
                .place = ranks_curve_place(middle, box, box + 3),
                .object = o,
                .weight = object->weights != NULL ? object->weights[i] : 1,
                .leaf = object->own[i]};
            keys[at] = (struct ranks_key){sorted[at].place, at};
        }
    }
    if (status == PCCD_OK) {
        const struct ranks_key *order = ranks_sort(keys, keys + count, count);
        uint64_t below = 0;
        for (uint64_t i = 0; i < count; i++) {
            leaves[i] = sorted[order[i].value];
            leaves[i].below = below;
            below += leaves[i].weight;
        }
    }
    free(sorted);
    free(keys);
    free(corners);
    return status;
}

/* ---- where to cut ----------------------------------------------------------------- */

/* How many leaves lie below a place. */
static uint64_t count_below(const struct traveller *leaves, uint64_t count,
                            uint64_t place)
{
    uint64_t from = 0, end = count;
    while (from < end) {
        uint64_t middle = from + (end - from) / 2;
        if (leaves[middle].place < place) {
            from = middle + 1;
        } else {
            end = middle;
        }
    }
    return from;
}

/* Their weight. */
static uint64_t weigh_below(const struct traveller *leaves, uint64_t count,
                            uint64_t place)
{
    uint64_t end = count_below(leaves, count, place);
    return end > 0 ? leaves[end - 1].below + leaves[end - 1].weight : 0;
}

/* cuts[r]: the lowest place below which there are r parts in `size` of the weight, or
 * more; found out digit by digit. */
static int find_cuts(struct pccd_mpi *world, const struct traveller *leaves,
                     uint64_t count, uint64_t *cuts)
{
    struct ranks_link *link = &world->link;
    int wanted = link->size - 1;
    uint64_t total = weigh_below(leaves, count, UINT64_MAX);
    uint64_t *sums = ranks_array((uint64_t)link->size * ROUND_WAYS, sizeof *sums);
    int status = ranks_agree_on(link, sums == NULL ? ranks_no_memory(world) : PCCD_OK);
    if (status == PCCD_OK) {
        status = ranks_sum(link, &total, 1);
    }
    memset(cuts, 0, ((size_t)link->size + 1) * sizeof *cuts);
    uint32_t shift = (PLACE_BITS + SEARCH_BITS - 1) / SEARCH_BITS * SEARCH_BITS;
    while (shift > 0 && status == PCCD_OK) {
        shift -= SEARCH_BITS;
        for (int r = 0; r < wanted; r++) {
            for (uint32_t way = 1; way <= ROUND_WAYS; way++) {
                uint64_t place = cuts[r + 1] + ((uint64_t)way << shift);
                sums[(uint32_t)r * ROUND_WAYS + way - 1] =
                    weigh_below(leaves, count, place);
            }
        }
        status = ranks_sum(link, sums, wanted * (int)ROUND_WAYS);
        for (int r = 0; r < wanted && status == PCCD_OK; r++) {
            /* In 128 bits: weights of a long run times ranks. */
            unsigned __int128 part = (unsigned __int128)total * (unsigned)(r + 1);
            uint32_t way = 0;
            while (way < ROUND_WAYS &&
                   (unsigned __int128)sums[(uint32_t)r * ROUND_WAYS + way] *
                           (unsigned)link->size <
                       part) {
                way++;
            }
            cuts[r + 1] += (uint64_t)way << shift;
        }
    }
    cuts[link->size] = UINT64_MAX;
    free(sums);
    return status;
}

/* ---- moving ----------------------------------------------------------------------- */

/* The leaves that came, to their objects, along the curve. */
static int settle(struct pccd_mpi *world, const struct traveller *leaves, uint64_t count)
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
        free(object->weights);
        object->weights = NULL;
        object->own = ranks_array(object->own_count, sizeof *object->own);
        status = object->own == NULL ? ranks_no_memory(world) : PCCD_OK;
        object->own_count = 0;
    }
    for (uint64_t i = 0; i < count && status == PCCD_OK; i++) {
        const struct traveller *leaf = &leaves[sorted[i].value];
        struct ranks_object *object = world->objects[leaf->object];
        object->own[object->own_count++] = leaf->leaf;
    }
    free(keys);
    return status;
}

static int move(struct pccd_mpi *world, const struct traveller *leaves, uint64_t count,
                const uint64_t *cuts)
{
    struct ranks_link *link = &world->link;
    uint64_t *first = ranks_array(2 * ((uint64_t)link->size + 1), sizeof *first);
    struct traveller *came = NULL;
    int status = ranks_agree_on(link, first == NULL ? ranks_no_memory(world) : PCCD_OK);
    if (status == PCCD_OK) {
        uint64_t *first_in = first + link->size + 1;
        for (int r = 0; r < link->size; r++) {
            first[r] = count_below(leaves, count, cuts[r]);
        }
        first[link->size] = count;
        status =
            ranks_deal(link, sizeof *leaves, leaves, first, (void **)&came, first_in);
        if (status == PCCD_OK) {
            status = ranks_agree_on(link, settle(world, came, first_in[link->size]));
            link->broken = status; /* leaves may be lost */
        }
    }
    free(first);
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

static int cut(struct pccd_mpi *world, double (**x)[3], uint64_t *cuts)
{
    struct ranks_link *link = &world->link;
    double box[6];
    uint64_t count = 0;
    int status = fetch_own(world, x);
    if (status == PCCD_OK) {
        status = bound(world, x, box);
    }
    if (status != PCCD_OK) {
        return status;
    }
    for (uint32_t o = 0; o < world->object_count; o++) {
        count += world->objects[o]->own_count;
    }
    struct traveller *leaves = ranks_array(count, sizeof *leaves);
    status = leaves == NULL ? ranks_no_memory(world)
                            : place_leaves(world, x, box, count, leaves);
    status = ranks_agree_on(link, status);
    if (status == PCCD_OK) {
        status = find_cuts(world, leaves, count, cuts);
    }
    if (status == PCCD_OK) {
        status = move(world, leaves, count, cuts);
    }
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
    uint32_t objects = world->object_count;
    double(**x)[3] = calloc((size_t)objects + 1, sizeof *x);
    uint64_t *cuts = ranks_array((uint64_t)link->size + 1, sizeof *cuts);
    int status = x == NULL || cuts == NULL ? ranks_no_memory(world) : take_leaves(world);
    world->is_cut = world->is_covered = false;
    status = ranks_agree_on(link, status);
    if (status == PCCD_OK) {
        status = cut(world, x, cuts);
    }
    for (uint32_t o = 0; o < objects && x != NULL; o++) {
        free(x[o]);
    }
    free((void *)x);
    free(cuts);
    if (status == PCCD_OK) {
        status = look_around(world);
    }
    if (status == PCCD_OK) {
        world->is_cut = true;
        world->share.cuts++;
    }
    return status;
}

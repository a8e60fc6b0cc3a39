/* near_objects.c - what is asked of objects two by two. */
#include "near_objects.h"

#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "answer.h"
#include "clock.h"
#include "parts.h"

/* ---- Where the leaves of objects are at one moment. */

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

/* ---- who is asked ------------------------------------------------------------------ */

bool ranks_is_asked(const struct ranks_pairing *pairing, uint32_t a, uint32_t b)
{
    const struct pccd_mpi *world = pairing->world;
    const uint32_t named[2] = {pairing->near->object_a, pairing->near->object_b};
    const uint32_t asked[2] = {world->objects[a]->handle, world->objects[b]->handle};
    if (a == b) {
        return false;
    }
    for (int side = 0; side < 2; side++) {
        if (named[side] != 0 && asked[0] != named[side] && asked[1] != named[side]) {
            return false;
        }
    }
    return ranks_may_meet(world, a, b);
}

bool ranks_is_asked_with_any(const struct ranks_pairing *pairing, uint32_t a)
{
    bool is_asked = false;
    for (uint32_t b = 0; b < pairing->world->object_count && !is_asked; b++) {
        is_asked = ranks_is_asked(pairing, a, b);
    }
    return is_asked;
}

/* Searches go down the triangles of objects. Of several that have more, the one of the
 * lowest handle is named. */
static int check_triangles(const struct ranks_pairing *pairing)
{
    struct pccd_mpi *world = pairing->world;
    const struct ranks_object *wrong = NULL;
    for (uint32_t o = 0; o < world->object_count; o++) {
        const struct ranks_object *object = world->objects[o];
        const struct pccd_mesh_info *info = &object->mesh->info;
        if (info->free_edge_count + info->free_point_count > 0 &&
            (wrong == NULL || object->handle < wrong->handle) &&
            ranks_is_asked_with_any(pairing, o)) {
            wrong = object;
        }
    }
    return wrong == NULL
               ? PCCD_OK
               : ranks_fail(&world->link, PCCD_E_INVAL,
                            "the mesh of object 0x%" PRIx32
                            " has free edges or points: %s "
                            "is answered for meshes of triangles alone",
                            wrong->handle,
                            pairing->near->what == PCCD_NEAR_DEPTH ? "depth" : "nearest");
}

/* ---- for both ---------------------------------------------------------------------- */

void ranks_ask_rest(const struct ranks_pairing *pairing, struct pccd_near_settings *near)
{
    *near = *pairing->near;
    near->deadline_ns = ranks_stop_rest(&pairing->world->stop);
}

void ranks_visitor_make(const struct ranks_pairing *pairing, uint32_t object,
                        uint32_t leaf, struct ranks_visitor *visitor)
{
    const struct ranks_object *of = pairing->world->objects[object];
    *visitor = (struct ranks_visitor){.object = object, .leaf = of->own[leaf]};
    for (int k = 0; k < 3; k++) {
        uint32_t v = ranks_place_of(of->local.vertices, of->local.vertex_count,
                                    visitor->leaf.v[k]);
        memcpy(visitor->x[k], pairing->x[object][v], sizeof visitor->x[k]);
    }
}

/* Collective: of all local vertices, at the end that is asked for. */
static int fetch(const struct ranks_pairing *pairing)
{
    struct pccd_mpi *world = pairing->world;
    uint32_t objects = world->object_count;
    const double(**given)[3] = calloc((size_t)objects + 1, sizeof *given);
    int status = given == NULL ? ranks_no_memory(world) : PCCD_OK;
    for (uint32_t o = 0; o < objects && status == PCCD_OK; o++) {
        const struct ranks_object *object = world->objects[o];
        given[o] = pairing->near->end == 1 ? object->to : object->from;
        pairing->x[o] = ranks_array(object->local.vertex_count, sizeof **pairing->x);
        status = pairing->x[o] == NULL ? ranks_no_memory(world) : PCCD_OK;
    }
    status = ranks_agree_on(&world->link, status);
    if (status == PCCD_OK) {
        status = ranks_plan_send(world, given, pairing->x);
    }
    free((void *)given);
    return status;
}

/* ---- records ----------------------------------------------------------------------- */

static int keep(struct pccd_mpi *world, const struct pccd_near *records, uint64_t count)
{
    int status = ranks_agree_on(&world->link, ranks_records_reserve(world, count));
    for (uint64_t i = 0; status == PCCD_OK && i < count; i++) {
        if (ranks_record_is_own(world, &records[i])) {
            ((struct pccd_near *)world->records)[world->record_count++] = records[i];
        }
    }
    if (status == PCCD_OK) {
        ranks_records_sort(world->records, world->record_count);
    }
    return status;
}

/* Collective: of the records of all ranks, those whose first feature this rank has. */
static int keep_own(struct pccd_mpi *world, const struct ranks_apart *apart)
{
    uint64_t *first = ranks_array((uint64_t)world->link.size + 1, sizeof *first);
    struct pccd_near *all = NULL;
    int status =
        ranks_agree_on(&world->link, first == NULL ? ranks_no_memory(world) : PCCD_OK);
    if (status == PCCD_OK) {
        status = ranks_spread(&world->link, sizeof *all, apart->records, apart->count,
                              (void **)&all, first);
    }
    if (status == PCCD_OK) {
        status = keep(world, all, first[world->link.size]);
    }
    free(first);
    free(all);
    return status;
}

/* What the deadline or anything else cut short on any rank proves nothing. */
static int agree_on_complete(struct pccd_mpi *world, struct ranks_apart *apart)
{
    uint8_t incomplete = (uint8_t)apart->answer.incomplete;
    int status = ranks_max_bytes(&world->link, &incomplete, 1);
    if (incomplete != PCCD_COMPLETE) {
        apart->count = apart->answer.crossings = 0;
    }
    return status;
}

static int answer_by(const struct ranks_pairing *pairing, struct ranks_apart *apart,
                     struct pccd_answer *answer)
{
    struct pccd_mpi *world = pairing->world;
    int status = fetch(pairing);
    if (status == PCCD_OK) {
        status = pairing->near->what == PCCD_NEAR_NEAREST ? ranks_nearest(pairing, apart)
                                                          : ranks_depth(pairing, apart);
    }
    if (status == PCCD_OK) {
        status = agree_on_complete(world, apart);
    }
    if (status == PCCD_OK) {
        /* Of DEPTH they are with their vertices already. */
        status = pairing->near->what == PCCD_NEAR_DEPTH
                     ? keep(world, apart->records, apart->count)
                     : keep_own(world, apart);
    }
    if (status != PCCD_OK) {
        return status;
    }
    *answer = apart->answer;
    return PCCD_OK;
}

int ranks_near_of_objects(struct pccd_mpi *world, const struct pccd_near_settings *near,
                          struct pccd_answer *answer)
{
    struct ranks_apart apart = {.count = 0};
    struct ranks_pairing pairing = {.world = world, .near = near};
    uint64_t begin_ns = common_now_ns();
    pairing.x = calloc((size_t)world->object_count + 1, sizeof *pairing.x);
    int status = pairing.x == NULL ? ranks_no_memory(world) : check_triangles(&pairing);
    status = ranks_agree_on(&world->link, status);
    if (status == PCCD_OK) {
        status = answer_by(&pairing, &apart, answer);
    }
    for (uint32_t o = 0; o < world->object_count && pairing.x != NULL; o++) {
        free(pairing.x[o]);
    }
    free((void *)pairing.x);
    ranks_apart_deinit(world, &apart);
    if (status == PCCD_OK) {
        answer->times.step = common_now_ns() - begin_ns;
        status = ranks_answer_make_near(world, near, answer);
    }
    return status;
}

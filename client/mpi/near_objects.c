/* near_objects.c - what is asked of objects two by two. */
#include "near_objects.h"

#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

#include "answer.h"
#include "clock.h"
#include "parts.h"

/* Blocks of a rank: each is compared with each one of all ranks. */
#define BLOCKS_MAX 1024u

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

int ranks_check_triangles(struct pccd_mpi *world, const struct pccd_near_settings *near)
{
    const struct ranks_pairing pairing = {.world = world, .near = near};
    const struct ranks_object *wrong = NULL;
    for (uint32_t o = 0; o < world->object_count && wrong == NULL; o++) {
        const struct pccd_mesh_info *info = &world->objects[o]->mesh->info;
        if (info->free_edge_count + info->free_point_count > 0 &&
            ranks_is_asked_with_any(&pairing, o)) {
            wrong = world->objects[o];
        }
    }
    return wrong == NULL
               ? PCCD_OK
               : ranks_fail(
                     &world->link, PCCD_E_INVAL,
                     "the mesh of object 0x%" PRIx32 " has free edges or points: %s "
                     "is answered for meshes of triangles alone",
                     wrong->handle, near->what == PCCD_NEAR_DEPTH ? "depth" : "nearest");
}

/* ---- for both ---------------------------------------------------------------------- */

void ranks_ask_rest(const struct ranks_pairing *pairing, struct pccd_near_settings *near)
{
    *near = *pairing->near;
    near->deadline_ns = ranks_stop_rest(&pairing->world->stop);
}

/* ---- what is wanted ---------------------------------------------------------------- */

/* An own leaf with its corners. */
static void make_remote_leaf(const struct ranks_pairing *pairing, uint32_t object,
                             uint32_t leaf, struct ranks_remote_leaf *remote)
{
    const uint32_t *corners = pairing->boxes.corners[object][leaf];
    *remote = (struct ranks_remote_leaf){
        .object = object, .leaf = pairing->world->objects[object]->own[leaf]};
    for (int k = 0; k < 3; k++) {
        memcpy(remote->x[k], pairing->x[object][corners[k]], sizeof remote->x[k]);
    }
}

/* Room for `more` leaves. PCCD_E_NOMEM. */
static int reserve(struct pccd_mpi *world, uint64_t more, struct ranks_wanted *wanted)
{
    if (wanted->leaf_count + more <= wanted->leaf_capacity) {
        return PCCD_OK;
    }
    uint64_t capacity = 2 * (wanted->leaf_count + more);
    struct ranks_remote_leaf *leaves = realloc(wanted->leaves, capacity * sizeof *leaves);
    if (leaves == NULL) {
        return ranks_no_memory(world);
    }
    wanted->leaves = leaves;
    wanted->leaf_capacity = capacity;
    return PCCD_OK;
}

int ranks_want_own(const struct ranks_pairing *pairing, const struct ranks_block *block,
                   struct ranks_wanted *wanted)
{
    int status = reserve(pairing->world, block->count, wanted);
    for (uint32_t i = 0; i < block->count && status == PCCD_OK; i++) {
        make_remote_leaf(pairing, block->object, block->begin + i,
                         &wanted->leaves[wanted->leaf_count++]);
    }
    return status;
}

int ranks_want(struct pccd_mpi *world, const float box[6], uint32_t object,
               struct ranks_wanted *wanted)
{
    if (wanted->box_count == wanted->box_capacity) {
        uint64_t capacity = 2 * wanted->box_capacity + 16;
        struct ranks_block *boxes = realloc(wanted->boxes, capacity * sizeof *boxes);
        if (boxes == NULL) {
            return ranks_no_memory(world);
        }
        wanted->boxes = boxes;
        wanted->box_capacity = capacity;
    }
    struct ranks_block *block = &wanted->boxes[wanted->box_count++];
    *block = (struct ranks_block){.object = object};
    memcpy(block->box.box, box, sizeof block->box.box);
    return PCCD_OK;
}

static bool is_of(const struct pccd_mpi *world, uint32_t box_object, uint32_t object)
{
    (void)world;
    return box_object == object;
}

static void put(const void *context, uint32_t object, uint32_t leaf, void *item)
{
    make_remote_leaf(context, object, leaf, item);
}

int ranks_want_all(const struct ranks_pairing *pairing, bool are_ghosts,
                   struct ranks_wanted *wanted)
{
    struct pccd_mpi *world = pairing->world;
    const struct ranks_fetch fetch = {.leaves = &pairing->boxes,
                                      .boxes = wanted->boxes,
                                      .box_count = wanted->box_count,
                                      .wants = is_of,
                                      .is_of_self = true,
                                      .put = put,
                                      .context = pairing,
                                      .item_bytes = sizeof(struct ranks_remote_leaf)};
    struct ranks_remote_leaf *came = NULL;
    uint64_t count = 0;
    int status = ranks_fetch_leaves(world, &fetch, (void **)&came, &count);
    if (status == PCCD_OK) {
        status = ranks_agree_on(&world->link, reserve(world, count, wanted));
    }
    for (uint64_t i = 0; i < count && status == PCCD_OK; i++) {
        struct ranks_remote_leaf *leaf = &wanted->leaves[wanted->leaf_count++];
        *leaf = came[i];
        leaf->is_ghost = are_ghosts;
    }
    wanted->box_count = 0;
    free(came);
    return status;
}

void ranks_wanted_deinit(struct ranks_wanted *wanted)
{
    free(wanted->leaves);
    free(wanted->boxes);
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
static int keep_own(struct pccd_mpi *world, const struct ranks_side_scene *side)
{
    uint64_t *first = ranks_array((uint64_t)world->link.size + 1, sizeof *first);
    struct pccd_near *all = NULL;
    int status = ranks_agree_memory(world, first != NULL);
    if (status == PCCD_OK) {
        status = ranks_spread(&world->link, sizeof *all, side->records, side->count,
                              (void **)&all, first);
    }
    if (status == PCCD_OK) {
        status = keep(world, all, first[world->link.size]);
    }
    free(first);
    free(all);
    return status;
}

/* Agree whether the answer is complete: what the deadline or anything else cut short on
 * any rank proves nothing. */
static int agree_on_complete(struct pccd_mpi *world, struct ranks_side_scene *side)
{
    uint8_t incomplete = (uint8_t)side->answer.incomplete;
    int status = ranks_max_bytes(&world->link, &incomplete, 1);
    if (incomplete != PCCD_COMPLETE) {
        side->count = side->answer.crossings = 0;
    }
    return status;
}

static int answer_by(const struct ranks_pairing *pairing, struct ranks_side_scene *side,
                     struct pccd_answer *answer)
{
    struct pccd_mpi *world = pairing->world;
    int status = pairing->near->what == PCCD_NEAR_NEAREST ? ranks_nearest(pairing, side)
                                                          : ranks_depth(pairing, side);
    if (status == PCCD_OK) {
        status = agree_on_complete(world, side);
    }
    if (status == PCCD_OK) {
        /* Of DEPTH they are with their vertices already. */
        status = pairing->near->what == PCCD_NEAR_DEPTH
                     ? keep(world, side->records, side->count)
                     : keep_own(world, side);
    }
    if (status != PCCD_OK) {
        return status;
    }
    *answer = side->answer;
    return PCCD_OK;
}

int ranks_near_of_objects(struct pccd_mpi *world, const struct pccd_near_settings *near,
                          struct pccd_answer *answer)
{
    struct ranks_side_scene side = {.count = 0};
    struct ranks_pairing pairing = {.world = world, .near = near};
    uint64_t begin_ns = common_now_ns();
    int status = ranks_positions_fetch(world, near->at_begin ? RANKS_BEGIN : RANKS_END,
                                       &pairing.x);
    if (status == PCCD_OK) {
        status = ranks_agree_on(
            &world->link,
            ranks_boxes_make_still(world, BLOCKS_MAX,
                                   (const double(*const *)[3])pairing.x, &pairing.boxes));
    }
    if (status == PCCD_OK) {
        status = answer_by(&pairing, &side, answer);
    }
    ranks_positions_free(world, pairing.x);
    ranks_boxes_deinit(&pairing.boxes);
    ranks_side_scene_deinit(world, &side);
    if (status == PCCD_OK) {
        answer->times.step = common_now_ns() - begin_ns;
        status = ranks_answer_make_near(world, near, answer);
    }
    return status;
}

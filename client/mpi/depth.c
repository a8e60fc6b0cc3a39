/* depth.c - how deep the vertices of closed meshes are in others.
 *
 * Find out whether meshes are closed; send the faces that a ray from any vertex may pass
 * through, and edges, and then those that may be nearest to a vertex inside, to the rank
 * that has it.
 *
 * How often a surface winds around a vertex is a sum over its faces. Only those add to it
 * that a ray along +x passes through. So the rank that owns a vertex needs those alone,
 * wherever the other faces are.
 */
#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

#include "near_objects.h"

/* ---- closed meshes ----------------------------------------------------------------- */

/* A face runs through an edge. */
struct run {
    uint32_t edge;
    uint32_t vertex[2]; /* from, to */
};

/* Post the runs of own faces to the rank that counts each edge. */
static void post_runs(const struct ranks_object *object, uint32_t size,
                      struct ranks_post *post)
{
    for (uint32_t i = 0; i < 3 * object->own_count; i++) {
        const struct ranks_leaf *leaf = &object->own[i / 3];
        uint32_t edge = leaf->side[i % 3];
        if (edge != RANKS_NONE) {
            const struct run run = {edge, {leaf->v[i % 3], leaf->v[(i + 1) % 3]}};
            ranks_post_add(post, edge % size, &run);
        }
    }
}

static int compare_runs(const void *a, const void *b)
{
    const struct run *one = a, *other = b;
    return one->edge < other->edge ? -1 : one->edge > other->edge;
}

/* The first edge here that is not run through equally often: open[] are its ends, the
 * lower first, and how often from that and back. RANKS_NONE: there is none. */
static uint32_t find_open(struct run *runs, uint64_t count, uint64_t open[4])
{
    if (count > 1) {
        qsort(runs, count, sizeof *runs, compare_runs);
    }
    for (uint64_t begin = 0, end; begin < count; begin = end) {
        uint64_t up = 0;
        const uint32_t *v = runs[begin].vertex;
        for (end = begin; end < count && runs[end].edge == runs[begin].edge; end++) {
            up += runs[end].vertex[0] < runs[end].vertex[1];
        }
        if (2 * up != end - begin) {
            open[0] = v[0] < v[1] ? v[0] : v[1];
            open[1] = v[0] < v[1] ? v[1] : v[0];
            open[2] = up;
            open[3] = end - begin - up;
            return runs[begin].edge;
        }
    }
    return RANKS_NONE;
}

/* Collective: mesh->closed, by the leaves of an object of that mesh. */
static int find_out(struct pccd_mpi *world, const struct ranks_object *object)
{
    struct ranks_link *link = &world->link;
    uint64_t open[4] = {0}, in_count = 0;
    struct run *in = NULL;
    struct ranks_post post;
    double least = RANKS_NONE;
    ranks_post_begin(&post, sizeof *in, 3 * (uint64_t)object->own_count);
    post_runs(object, (uint32_t)link->size, &post);
    int status = ranks_post_deal(link, &post, (void **)&in, &in_count);
    if (status == PCCD_OK) {
        uint32_t mine = find_open(in, in_count, open);
        least = mine;
        status = ranks_min_doubles(link, &least, 1);
        for (int i = 0; i < 4; i++) {
            open[i] = (double)mine > least ? 0 : open[i];
        }
    }
    if (status == PCCD_OK) { /* one rank knows of that edge */
        status = ranks_sum(link, open, 4);
    }
    if (status == PCCD_OK) {
        struct ranks_mesh *mesh = object->mesh;
        mesh->closed = least < RANKS_NONE ? RANKS_OPEN_MESH : RANKS_CLOSED_MESH;
        for (int i = 0; i < 4; i++) {
            mesh->open[i] = (uint32_t)open[i];
        }
    }
    free(in);
    return status;
}

/* Collective. Of several meshes that are open, that of the lowest handle is named. */
static int check_closed(const struct ranks_pairing *pairing)
{
    struct pccd_mpi *world = pairing->world;
    const struct ranks_object *wrong = NULL;
    int status = PCCD_OK;
    for (uint32_t o = 0; o < world->object_count && status == PCCD_OK && wrong == NULL;
         o++) {
        const struct ranks_object *object = world->objects[o];
        if (!ranks_is_asked_with_any(pairing, o)) {
            continue;
        }
        if (object->mesh->closed == RANKS_MESH_NOT_KNOWN) {
            status = find_out(world, object);
        }
        wrong = object->mesh->closed == RANKS_OPEN_MESH ? object : NULL;
    }
    if (status != PCCD_OK || wrong == NULL) {
        return status;
    }
    const uint32_t *open = wrong->mesh->open;
    return ranks_fail(&world->link, PCCD_E_INVAL,
                      "the mesh of object 0x%" PRIx32 " is not closed: %" PRIu32
                      " of its faces run along the edge from vertex %" PRIu32
                      " to %" PRIu32 ", and %" PRIu32 " back",
                      wrong->handle, open[2], open[0], open[1], open[3]);
}

/* Members that both questions share. */
struct search {
    const struct ranks_pairing *pairing;
    double (*boxes)[6]; /* of all objects: low, and high with the other sign */
    struct ranks_wanted wanted;
};

/* ---- the first question: who is inside --------------------------------------------- */

/* Collective: boxes of all objects. */
static int bound_objects(const struct search *search)
{
    struct pccd_mpi *world = search->pairing->world;
    const struct ranks_boxes *mine = &search->pairing->boxes;
    double(*boxes)[6] = search->boxes;
    for (uint32_t o = 0; o < world->object_count; o++) {
        for (int k = 0; k < 6; k++) {
            boxes[o][k] = INFINITY;
        }
    }
    for (uint32_t i = 0; i < mine->block_count; i++) {
        const struct ranks_block *own = &mine->blocks[i];
        double *box = boxes[own->object];
        for (int k = 0; k < 3; k++) {
            box[k] = fmin(box[k], (double)own->box.box[k]);
            box[k + 3] = fmin(box[k + 3], -(double)own->box.box[k + 3]);
        }
    }
    return ranks_min_doubles(&world->link, boxes[0], (int)(6 * world->object_count));
}

static bool meets(const float box[6], const double other[6])
{
    bool is_met = true;
    for (int k = 0; k < 3; k++) {
        is_met =
            is_met && (double)box[k] <= -other[k + 3] && other[k] <= (double)box[k + 3];
    }
    return is_met;
}

/* Own blocks that may have a vertex inside another object, or an edge through a face, are
 * wanted; so is what a ray from the block meets of that object. */
static int want_rays(struct search *search)
{
    const struct ranks_pairing *pairing = search->pairing;
    struct pccd_mpi *world = pairing->world;
    int status = PCCD_OK;
    for (uint32_t i = 0; i < pairing->boxes.block_count && status == PCCD_OK; i++) {
        const struct ranks_block *own = &pairing->boxes.blocks[i];
        uint64_t before = search->wanted.box_count;
        for (uint32_t b = 0; b < world->object_count && status == PCCD_OK; b++) {
            float ray[6];
            memcpy(ray, own->box.box, sizeof ray);
            if (meets(ray, search->boxes[b]) && ranks_is_asked(pairing, own->object, b)) {
                ray[3] = INFINITY;
                status = ranks_want(world, ray, b, &search->wanted);
            }
        }
        if (search->wanted.box_count > before && status == PCCD_OK) {
            status = ranks_want_own(pairing, own, &search->wanted);
        }
    }
    return status;
}

/* ---- the second one: how deep ------------------------------------------------------ */

#define RECORDS_OF_BOX 16u

/* Want what may be as near to vertices inside as the face that is known, some of them at
 * a time. */
static int want_balls(struct search *search, const struct ranks_side_scene *inside)
{
    struct pccd_mpi *world = search->pairing->world;
    int status = PCCD_OK;
    for (uint64_t i = 0, next; i < inside->count && status == PCCD_OK; i = next) {
        const struct pccd_near *first = &inside->records[i];
        float box[6];
        ranks_box_begin(box);
        for (next = i; next < inside->count && next < i + RECORDS_OF_BOX; next++) {
            const struct pccd_near *record = &inside->records[next];
            float ball[6];
            double x[3];
            if (record->object_a != first->object_a ||
                record->object_b != first->object_b) {
                break;
            }
            ranks_side_scene_vertex(world, inside, record->object_a, record->feature_a,
                                    x);
            for (int k = 0; k < 3; k++) {
                ball[k] = ranks_float_below(x[k]);
                ball[k + 3] = ranks_float_above(x[k]);
            }
            ranks_box_grow(ball, record->d_hi);
            ranks_box_add(box, ball);
        }
        status = ranks_want(world, box, ranks_place_of_object(world, first->object_b),
                            &search->wanted);
    }
    return status;
}

/* Collective: all faces that may be the nearest to a vertex inside are among the leaves
 * now; *any: there are such on any rank. */
static int add_balls(struct search *search, const struct ranks_side_scene *inside,
                     bool *any)
{
    struct pccd_mpi *world = search->pairing->world;
    uint8_t has_any = inside->count > 0;
    int status = ranks_agree_on(&world->link, want_balls(search, inside));
    if (status == PCCD_OK) {
        status = ranks_max_bytes(&world->link, &has_any, 1);
    }
    *any = has_any;
    return status == PCCD_OK && has_any
               ? ranks_want_all(search->pairing, true, &search->wanted)
               : status;
}

/* ---- all of it --------------------------------------------------------------------- */

/* Collective: the own leaves that matter, and all that the first question needs. */
static int gather_rays(struct search *search)
{
    struct pccd_mpi *world = search->pairing->world;
    search->boxes = ranks_array(world->object_count, sizeof *search->boxes);
    int status = ranks_agree_memory(world, search->boxes != NULL);
    if (status == PCCD_OK) {
        status = bound_objects(search);
    }
    if (status == PCCD_OK) {
        status = ranks_agree_on(&world->link, want_rays(search));
    }
    return status == PCCD_OK ? ranks_want_all(search->pairing, true, &search->wanted)
                             : status;
}

/* A vertex outside of another object's box is not inside of that, and nobody has sent all
 * faces that its ray meets. */
static void drop_outside(const struct search *search, struct ranks_side_scene *side)
{
    const struct pccd_mpi *world = search->pairing->world;
    uint64_t kept = 0;
    for (uint64_t i = 0; i < side->count; i++) {
        const struct pccd_near *record = &side->records[i];
        const double *box = search->boxes[ranks_place_of_object(world, record->object_b)];
        double x[3];
        bool is_within = true;
        ranks_side_scene_vertex(world, side, record->object_a, record->feature_a, x);
        for (int k = 0; k < 3; k++) {
            is_within = is_within && x[k] >= box[k] && x[k] <= -box[k + 3];
        }
        if (is_within) {
            side->records[kept++] = *record;
        }
    }
    side->count = kept;
}

static int ask(const struct search *search, struct ranks_side_scene *side)
{
    struct pccd_near_settings near;
    ranks_ask_rest(search->pairing, &near);
    int status = ranks_side_scene_ask(search->pairing->world, search->wanted.leaves,
                                      search->wanted.leaf_count, &near, side);
    if (status == PCCD_OK) {
        drop_outside(search, side);
    }
    return status;
}

/* Return whether anything is known to be around a vertex. */
static bool is_inside(const struct ranks_side_scene *inside, uint32_t handle,
                      uint32_t vertex)
{
    uint64_t from = 0, end = inside->count;
    while (from < end) {
        uint64_t middle = from + (end - from) / 2;
        const struct pccd_near *record = &inside->records[middle];
        if (record->object_a < handle ||
            (record->object_a == handle && record->feature_a < vertex)) {
            from = middle + 1;
        } else {
            end = middle;
        }
    }
    return from < inside->count && inside->records[from].object_a == handle &&
           inside->records[from].feature_a == vertex;
}

/* The second question is about vertices that are inside; edges have been counted. */
static void leave_out_answered(struct search *search,
                               const struct ranks_side_scene *inside)
{
    uint64_t kept = 0;
    for (uint64_t i = 0; i < search->wanted.leaf_count; i++) {
        struct ranks_remote_leaf leaf = search->wanted.leaves[i];
        uint32_t handle = search->pairing->world->objects[leaf.object]->handle;
        uint32_t owns = 0;
        for (uint32_t k = 0; k < 3 && !leaf.is_ghost; k++) {
            uint32_t bit = leaf.leaf.owns & RANKS_OWNS_CORNER(k);
            owns |= bit != 0 && is_inside(inside, handle, leaf.leaf.v[k]) ? bit : 0;
        }
        leaf.leaf.owns = owns;
        if (leaf.is_ghost || owns != 0) {
            search->wanted.leaves[kept++] = leaf;
        }
    }
    search->wanted.leaf_count = kept;
}

int ranks_depth(const struct ranks_pairing *pairing, struct ranks_side_scene *side)
{
    struct pccd_mpi *world = pairing->world;
    struct search search = {.pairing = pairing};
    struct ranks_side_scene inside = {.count = 0};
    bool any = false;
    int status = ranks_agree_on(&world->link, check_closed(pairing));
    if (status == PCCD_OK) {
        status = gather_rays(&search);
    }
    if (status == PCCD_OK) {
        status = ask(&search, &inside);
    }
    if (status == PCCD_OK) {
        status = add_balls(&search, &inside, &any);
    }
    if (status == PCCD_OK && any) {
        leave_out_answered(&search, &inside);
        status = ask(&search, side);
        if (status == PCCD_OK) {
            ranks_side_scene_add(side, &inside);
            side->answer.crossings = inside.answer.crossings;
        }
    } else if (status == PCCD_OK) {
        *side = inside;
        inside = (struct ranks_side_scene){.count = 0};
    }
    ranks_side_scene_deinit(world, &inside);
    free(search.boxes);
    ranks_wanted_deinit(&search.wanted);
    return status;
}

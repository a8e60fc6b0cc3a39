/* nearest.c - the nearest pair of each two objects.
 *
 * Bound how far two objects are apart by boxes around some of their leaves; send leaves
 * that are not farther from the other object than that; have the nearest pair of each
 * rank found; decide between these.
 *
 * The nearest pair of two objects is also that of any leaves of theirs of which it is
 * part: so fewer and fewer leaves are asked about, and the answer stays.
 */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "kinds.h"
#include "near_objects.h"

/* Of a square: more than what rounding takes or adds. */
#define SLACK (1 + 0x1p-40)

/* Greatest distance that two objects may have: key is the lower place << 32 | the
 * other. */
struct bound {
    uint64_t key;
    double distance;
};

struct search {
    const struct ranks_pairing *pairing;
    double reach;            /* what is farther apart has no record */
    struct ranks_block *all; /* blocks of all ranks */
    uint64_t *first;         /* [size + 1] of these */
    struct bound *bounds;    /* ascending */
    uint64_t bound_count;
};

static void search_deinit(struct search *search)
{
    free(search->all);
    free(search->first);
    free(search->bounds);
}

/* ---- distances of boxes ------------------------------------------------------------ */

/* The squares of the distances that points of two boxes have at least, and at most. */
static double least_square(const float a[6], const float b[6])
{
    double square = 0;
    for (int k = 0; k < 3; k++) {
        double gap =
            fmax((double)a[k] - (double)b[k + 3], (double)b[k] - (double)a[k + 3]);
        square += gap > 0 ? gap * gap : 0;
    }
    return square;
}

static double most_square(const float a[6], const float b[6])
{
    double square = 0;
    for (int k = 0; k < 3; k++) {
        double far =
            fmax((double)a[k + 3] - (double)b[k], (double)b[k + 3] - (double)a[k]);
        square += far * far;
    }
    return square;
}

/* Return whether a length whose square this is, with rounding, may be as short as a
 * distance. */
static bool is_within(double square, double distance)
{
    return square <= distance * distance * SLACK + 0x1p-1000;
}

/* ---- bounds ------------------------------------------------------------------------ */

/* By how much the radii of an object's features differ at most. */
static double spread_of(const struct ranks_object *object)
{
    return object->settings.radius > 0 ? 0 : object->mesh->radius_max;
}

/* Own blocks of object a beside all others: for each object b the least that they can be
 * apart at most, and at least. */
static void compare_blocks(const struct search *search, uint32_t a, double *most,
                           double *least)
{
    const struct pccd_mpi *world = search->pairing->world;
    const struct ranks_boxes *mine = &search->pairing->boxes;
    for (uint32_t b = 0; b < world->object_count; b++) {
        most[b] = least[b] = INFINITY;
    }
    for (uint32_t i = 0; i < mine->block_count; i++) {
        const struct ranks_block *own = &mine->blocks[i];
        for (uint64_t j = 0; own->object == a && j < search->first[world->link.size];
             j++) {
            const struct ranks_block *other = &search->all[j];
            uint32_t b = other->object;
            most[b] = fmin(most[b], most_square(own->box.box, other->box.box));
            least[b] = fmin(least[b], least_square(own->box.box, other->box.box));
        }
    }
}

static int compare_bounds(const void *a, const void *b)
{
    const struct bound *one = a, *other = b;
    return one->key != other->key             ? (one->key < other->key ? -1 : 1)
           : one->distance != other->distance ? (one->distance < other->distance ? -1 : 1)
                                              : 0;
}

/* Write the bounds that this rank knows to bounds[]. */
static int find_bounds(struct search *search, struct bound **bounds, uint64_t *count)
{
    struct pccd_mpi *world = search->pairing->world;
    uint32_t objects = world->object_count;
    double *most = ranks_array(2 * (uint64_t)objects, sizeof *most);
    *count = 0;
    for (uint32_t a = 0; a < objects && most != NULL; a++) {
        struct bound *more = realloc(*bounds, (*count + objects + 1) * sizeof **bounds);
        if (more == NULL) {
            free(most);
            return ranks_no_memory(world);
        }
        *bounds = more;
        if (world->objects[a]->own_count == 0) {
            continue;
        }
        compare_blocks(search, a, most, most + objects);
        for (uint32_t b = 0; b < objects; b++) {
            if (a < b && most[b] < INFINITY &&
                is_within(most[objects + b], search->reach) &&
                ranks_is_asked(search->pairing, a, b)) {
                /* The surfaces of other features may be nearer than those of the blocks,
                 * though these are not. */
                double distance = (sqrt(most[b]) + spread_of(world->objects[a]) +
                                   spread_of(world->objects[b])) *
                                  SLACK;
                (*bounds)[(*count)++] =
                    (struct bound){(uint64_t)a << 32 | b, fmin(distance, search->reach)};
            }
        }
    }
    free(most);
    return most == NULL ? ranks_no_memory(world) : PCCD_OK;
}

/* Collective: of all ranks, the least for each two objects. */
static int agree_on_bounds(struct search *search)
{
    struct pccd_mpi *world = search->pairing->world;
    struct ranks_link *link = &world->link;
    struct bound *mine = NULL;
    uint64_t count = 0, each = 0;
    uint64_t *first = ranks_array((uint64_t)link->size + 1, sizeof *first);
    int status =
        first == NULL ? ranks_no_memory(world) : find_bounds(search, &mine, &count);
    status = ranks_agree_on(link, status);
    if (status == PCCD_OK) {
        status = ranks_spread(link, sizeof *mine, mine, count, (void **)&search->bounds,
                              first);
    }
    if (status == PCCD_OK && first[link->size] > 0) {
        qsort(search->bounds, first[link->size], sizeof *search->bounds, compare_bounds);
        for (uint64_t i = 0; i < first[link->size]; i++) {
            if (i == 0 || search->bounds[i].key != search->bounds[each - 1].key) {
                search->bounds[each++] = search->bounds[i];
            }
        }
    }
    search->bound_count = each;
    free(mine);
    free(first);
    return status;
}

/* Return how far two objects are apart at most; negative: they need not be looked at. */
static double bound_of(const struct search *search, uint32_t a, uint32_t b)
{
    uint64_t key = (uint64_t)a << 32 | b, from = 0, end = search->bound_count;
    while (from < end) {
        uint64_t middle = from + (end - from) / 2;
        if (search->bounds[middle].key < key) {
            from = middle + 1;
        } else {
            end = middle;
        }
    }
    return from < search->bound_count && search->bounds[from].key == key
               ? search->bounds[from].distance
               : -1;
}

/* ---- leaves ------------------------------------------------------------------------ */

/* Two objects are compared by the ranks that own leaves of the lower one: leaves of the
 * higher one come to them, and their own ones stay. Of an own block: which objects it is
 * near to, near[object_count], by how far they are from its own at most, row[]. */
static void find_near(const struct search *search, const struct ranks_block *own,
                      const double *row, bool *near)
{
    const struct pccd_mpi *world = search->pairing->world;
    memset(near, 0, world->object_count * sizeof *near);
    for (uint64_t i = 0; i < search->first[world->link.size]; i++) {
        const struct ranks_block *other = &search->all[i];
        double distance = row[other->object];
        near[other->object] =
            near[other->object] ||
            (distance >= 0 &&
             is_within(least_square(own->box.box, other->box.box), distance));
    }
}

/* The row of an object: of those that are higher. */
static void look_up(const struct search *search, uint32_t object, double *row)
{
    const struct pccd_mpi *world = search->pairing->world;
    for (uint32_t o = 0; o < world->object_count; o++) {
        row[o] = object < o ? bound_of(search, object, o) : -1;
    }
}

/* Want what this rank compares: own blocks, and what is near to them of higher
 * objects. */
static int want(const struct search *search, struct ranks_wanted *wanted)
{
    struct pccd_mpi *world = search->pairing->world;
    const struct ranks_boxes *mine = &search->pairing->boxes;
    double *row = ranks_array(world->object_count, sizeof *row);
    bool *near = ranks_array(world->object_count, sizeof *near);
    int status = row == NULL || near == NULL ? ranks_no_memory(world) : PCCD_OK;
    for (uint32_t i = 0; i < mine->block_count && status == PCCD_OK; i++) {
        const struct ranks_block *own = &mine->blocks[i];
        bool is_near = false;
        if (i == 0 || own->object != own[-1].object) {
            look_up(search, own->object, row);
        }
        find_near(search, own, row, near);
        for (uint32_t o = 0; o < world->object_count && status == PCCD_OK; o++) {
            float box[6];
            memcpy(box, own->box.box, sizeof box);
            if (near[o]) {
                ranks_box_grow(box, row[o] * SLACK);
                status = ranks_want(world, box, o, wanted);
                is_near = true;
            }
        }
        if (is_near && status == PCCD_OK) {
            status = ranks_want_own(search->pairing, own, wanted);
        }
    }
    free(row);
    free(near);
    return status;
}

/* ---- the last choice --------------------------------------------------------------- */

/* The rank that decides about two objects, by their handles. */
static int judge_of(const struct pccd_mpi *world, const struct pccd_near *record)
{
    uint64_t low = record->object_a, high = record->object_b;
    if (low > high) {
        low = record->object_b;
        high = record->object_a;
    }
    uint64_t mixed = (high << 32 | low) * UINT64_C(0x9e3779b97f4a7c15);
    return (int)((mixed >> 32) % (uint64_t)world->link.size);
}

/* Collective: for each record, a leaf of either side goes to the rank that decides. */
static int send_to_judges(struct pccd_mpi *world, const struct ranks_side_scene *found,
                          struct ranks_remote_leaf **in, uint64_t *in_count)
{
    struct ranks_remote_leaf leaf;
    struct ranks_post post;
    ranks_post_begin(&post, sizeof leaf, 2 * found->count);
    for (uint64_t i = 0; i < found->count; i++) {
        const struct pccd_near *record = &found->records[i];
        const uint32_t *points = common_kinds[record->kind].points;
        const uint32_t judge = (uint32_t)judge_of(world, record);
        ranks_side_scene_find(found, ranks_place_of_object(world, record->object_a),
                              points[0], record->feature_a, &leaf);
        ranks_post_add(&post, judge, &leaf);
        ranks_side_scene_find(found, ranks_place_of_object(world, record->object_b),
                              points[1], record->feature_b, &leaf);
        ranks_post_add(&post, judge, &leaf);
    }
    return ranks_post_deal(&world->link, &post, (void **)in, in_count);
}

/* Keep the records of two objects that this rank judges; of the others it has not all
 * candidates. */
static void keep_judged(const struct pccd_mpi *world, struct ranks_side_scene *side)
{
    uint64_t kept = 0;
    for (uint64_t i = 0; i < side->count; i++) {
        if (judge_of(world, &side->records[i]) == world->link.rank) {
            side->records[kept++] = side->records[i];
        }
    }
    side->count = kept;
}

/* ---- all of it --------------------------------------------------------------------- */

/* However far away: the nearest of what is here. */
static int find_here(const struct search *search, struct ranks_side_scene *found)
{
    struct ranks_wanted wanted = {.leaf_count = 0};
    struct pccd_near_settings near;
    int status = ranks_agree_on(&search->pairing->world->link, want(search, &wanted));
    if (status == PCCD_OK) {
        status = ranks_want_all(search->pairing, false, &wanted);
    }
    if (status == PCCD_OK) {
        ranks_ask_rest(search->pairing, &near);
        near.distance = INFINITY;
        near.gap = 0;
        status = ranks_side_scene_ask(search->pairing->world, wanted.leaves,
                                      wanted.leaf_count, &near, found);
    }
    ranks_wanted_deinit(&wanted);
    return status;
}

static int decide(const struct search *search, const struct ranks_side_scene *found,
                  struct ranks_side_scene *side)
{
    struct pccd_mpi *world = search->pairing->world;
    struct ranks_remote_leaf *leaves = NULL;
    struct pccd_near_settings near;
    uint64_t count = 0;
    int status = send_to_judges(world, found, &leaves, &count);
    if (status == PCCD_OK) {
        ranks_ask_rest(search->pairing, &near);
        status = ranks_side_scene_ask(world, leaves, count, &near, side);
    }
    free(leaves);
    if (status == PCCD_OK) {
        keep_judged(world, side);
        ranks_side_scene_add(side, found);
    }
    return status;
}

/* Find how far apart two objects may be at most and have a record, whatever radii they
 * have. PCCD_E_LIMIT, as in one process. */
static int find_reach(const struct ranks_pairing *pairing, double *reach)
{
    struct pccd_mpi *world = pairing->world;
    double most = 0;
    for (uint32_t o = 0; o < world->object_count; o++) {
        const struct ranks_object *object = world->objects[o];
        most = fmax(most, object->settings.radius > 0 ? object->settings.radius
                                                      : object->mesh->radius_max);
    }
    *reach = pairing->near->distance;
    if (most > 0) {
        *reach = nextafter(2 * most + *reach, INFINITY);
    }
    return *reach <= 1e18 || *reach == INFINITY
               ? PCCD_OK
               : ranks_fail(&world->link, PCCD_E_LIMIT,
                            "distance and the radii of a pair are together beyond 1e18");
}

int ranks_nearest(const struct ranks_pairing *pairing, struct ranks_side_scene *side)
{
    struct pccd_mpi *world = pairing->world;
    struct search search = {.pairing = pairing};
    struct ranks_side_scene found = {.count = 0};
    int status = find_reach(pairing, &search.reach);
    search.first = ranks_array((uint64_t)world->link.size + 1, sizeof *search.first);
    if (status == PCCD_OK && search.first == NULL) {
        status = ranks_no_memory(world);
    }
    status = ranks_agree_on(&world->link, status);
    if (status == PCCD_OK) {
        status =
            ranks_spread(&world->link, sizeof *search.all, pairing->boxes.blocks,
                         pairing->boxes.block_count, (void **)&search.all, search.first);
    }
    if (status == PCCD_OK) {
        status = agree_on_bounds(&search);
    }
    if (status == PCCD_OK) {
        status = find_here(&search, &found);
    }
    if (status == PCCD_OK) {
        status = decide(&search, &found, side);
    }
    ranks_side_scene_deinit(world, &found);
    search_deinit(&search);
    return status;
}

/* nearest.c - the nearest pair of each two objects.
 *
 * Bound how far two objects are apart by distances of some of their vertices; send leaves
 * that are not farther from the other object than that; have the nearest pair of each
 * rank found; decide between these.
 *
 * The nearest pair of two objects is also that of any leaves of theirs of which it is
 * part: so fewer and fewer leaves are asked about, and the answer stays.
 */
#include <math.h>
#include <stdlib.h>

#include "kinds.h"
#include "near_objects.h"

/* Of a square: more than what rounding takes or adds. */
#define SLACK (1 + 0x1p-40)

/* How far two objects are apart at most: key is the place of the one with the lower
 * handle << 32 | the other's. */
struct bound {
    uint64_t key;
    double distance;
};

struct search {
    const struct ranks_pairing *pairing;
    double reach; /* what is farther apart has no record */
    struct ranks_spot *mine, *all;
    uint64_t *first; /* [size + 1] of all; those of this rank are mine, too */
    uint32_t mine_count;
    struct bound *bounds; /* ascending */
    uint64_t bound_count;
    /* Of the own spot that is looked at and each other object: how far they are apart at
     * most, and which of the two has the lower handle. */
    double *row;
    bool *is_lower;
};

static void search_deinit(struct search *search)
{
    free(search->mine);
    free(search->all);
    free(search->first);
    free(search->bounds);
    free(search->row);
    free(search->is_lower);
}

/* ---- distances of boxes ------------------------------------------------------------ */

/* The square of a distance that two boxes have at least. */
static double square_between(const double low_a[3], const double high_a[3],
                             const double low_b[3], const double high_b[3])
{
    double square = 0;
    for (int k = 0; k < 3; k++) {
        double gap = fmax(low_a[k] - high_b[k], low_b[k] - high_a[k]);
        square += gap > 0 ? gap * gap : 0;
    }
    return square;
}

/* May what is between be as short as a distance? */
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

/* Own spots of object a beside all others: for each object b with a higher handle the
 * least distance of their vertices, and of their boxes. */
static void compare_spots(const struct search *search, uint32_t a, double *nearest,
                          double *gap)
{
    const struct pccd_mpi *world = search->pairing->world;
    for (uint32_t b = 0; b < world->object_count; b++) {
        nearest[b] = gap[b] = INFINITY;
    }
    for (uint32_t i = 0; i < search->mine_count; i++) {
        const struct ranks_spot *mine = &search->mine[i];
        for (uint64_t j = 0; mine->object == a && j < search->first[world->link.size];
             j++) {
            const struct ranks_spot *other = &search->all[j];
            double square = square_between(mine->x, mine->x, other->x, other->x);
            double between =
                square_between(mine->low, mine->high, other->low, other->high);
            nearest[other->object] = fmin(nearest[other->object], square);
            gap[other->object] = fmin(gap[other->object], between);
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

/* What this rank knows, to bounds[]. */
static int find_bounds(struct search *search, struct bound **bounds, uint64_t *count)
{
    struct pccd_mpi *world = search->pairing->world;
    uint32_t objects = world->object_count;
    double *nearest = ranks_array(2 * (uint64_t)objects, sizeof *nearest);
    *count = 0;
    for (uint32_t a = 0; a < objects && nearest != NULL; a++) {
        struct bound *more = realloc(*bounds, (*count + objects + 1) * sizeof **bounds);
        if (more == NULL) {
            free(nearest);
            return ranks_no_memory(world);
        }
        *bounds = more;
        if (world->objects[a]->own_count == 0) {
            continue;
        }
        compare_spots(search, a, nearest, nearest + objects);
        for (uint32_t b = 0; b < objects; b++) {
            if (ranks_is_lower(world, a, b) && nearest[b] < INFINITY &&
                is_within(nearest[objects + b], search->reach) &&
                ranks_is_asked(search->pairing, a, b)) {
                /* The surfaces of other features may be nearer than those of the two
                 * vertices, though these are not. */
                double distance = (sqrt(nearest[b]) + spread_of(world->objects[a]) +
                                   spread_of(world->objects[b])) *
                                  SLACK;
                (*bounds)[(*count)++] =
                    (struct bound){(uint64_t)a << 32 | b, fmin(distance, search->reach)};
            }
        }
    }
    free(nearest);
    return nearest == NULL ? ranks_no_memory(world) : PCCD_OK;
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

/* How far two objects are apart at most; negative: they need not be looked at. */
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

/* Spots that a leaf may have to come to. */
struct target {
    const struct ranks_spot *spot;
    double distance;
};

/* Two objects are compared by the ranks that own leaves of the lower one: leaves of the
 * higher one come to them, and their own ones stay. So a leaf goes to rank r for the
 * spots of lower objects there, and stays for the spots of higher ones anywhere. */
static uint32_t find_targets(const struct search *search, const struct ranks_spot *mine,
                             int r, struct target *targets)
{
    const struct pccd_mpi *world = search->pairing->world;
    uint32_t count = 0;
    bool stays = r == world->link.rank;
    uint64_t begin = stays ? 0 : search->first[r];
    uint64_t end = stays ? search->first[world->link.size] : search->first[r + 1];
    for (uint64_t i = begin; i < end; i++) {
        const struct ranks_spot *other = &search->all[i];
        bool is_there = i >= search->first[r] && i < search->first[r + 1];
        double distance = search->row[other->object];
        if (distance >= 0 && (search->is_lower[other->object] ? is_there : stays) &&
            is_within(square_between(mine->low, mine->high, other->low, other->high),
                      distance)) {
            targets[count++] = (struct target){other, distance};
        }
    }
    return count;
}

/* The row of an object. */
static void look_up(const struct search *search, uint32_t object)
{
    const struct pccd_mpi *world = search->pairing->world;
    for (uint32_t o = 0; o < world->object_count; o++) {
        search->is_lower[o] = ranks_is_lower(world, o, object);
        search->row[o] = o == object           ? -1
                         : search->is_lower[o] ? bound_of(search, o, object)
                                               : bound_of(search, object, o);
    }
}

static bool is_near_any(const struct ranks_visitor *leaf, const struct target *targets,
                        uint32_t count)
{
    double low[3], high[3];
    ranks_leaf_bounds(leaf, low, high);
    for (uint32_t i = 0; i < count; i++) {
        if (is_within(
                square_between(low, high, targets[i].spot->low, targets[i].spot->high),
                targets[i].distance)) {
            return true;
        }
    }
    return false;
}

/* Which own leaves go to rank r: counts, or with out != NULL writes them. */
static uint64_t choose_for(const struct search *search, int r, struct target *targets,
                           struct ranks_visitor *out)
{
    struct ranks_visitor leaf;
    uint64_t count = 0;
    for (uint32_t i = 0; i < search->mine_count; i++) {
        const struct ranks_spot *mine = &search->mine[i];
        if (i == 0 || mine->object != mine[-1].object) {
            look_up(search, mine->object);
        }
        uint32_t target_count = find_targets(search, mine, r, targets);
        for (uint32_t k = 0; k < mine->count && target_count > 0; k++) {
            ranks_visitor_make(search->pairing, mine->object, mine->begin + k, &leaf);
            if (is_near_any(&leaf, targets, target_count)) {
                if (out != NULL) {
                    out[count] = leaf;
                }
                count++;
            }
        }
    }
    return count;
}

/* Collective: the leaves that this rank compares. */
static int exchange(struct search *search, struct ranks_visitor **in, uint64_t *in_count)
{
    struct pccd_mpi *world = search->pairing->world;
    int size = world->link.size;
    uint64_t *first = ranks_array(2 * ((uint64_t)size + 1), sizeof *first), count = 0;
    struct target *targets = ranks_array(search->first[size], sizeof *targets);
    struct ranks_visitor *out = NULL;
    search->row = ranks_array(world->object_count, sizeof *search->row);
    search->is_lower = ranks_array(world->object_count, sizeof *search->is_lower);
    bool is_short = first == NULL || targets == NULL || search->row == NULL ||
                    search->is_lower == NULL;
    for (int pass = 0; pass < 2 && !is_short; pass++, count = 0) {
        for (int r = 0; r < size; r++) {
            first[r] = count;
            count += choose_for(search, r, targets, out != NULL ? out + count : NULL);
        }
        first[size] = count;
        if (pass == 0) {
            out = ranks_array(count, sizeof *out);
            is_short = out == NULL;
        }
    }
    int status =
        ranks_agree_on(&world->link, is_short ? ranks_no_memory(world) : PCCD_OK);
    if (status == PCCD_OK) {
        status = ranks_deal(&world->link, sizeof *out, out, first, (void **)in,
                            first + size + 1);
        *in_count = first[2 * size + 1];
    }
    free(first);
    free(targets);
    free(out);
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
static int send_to_judges(struct pccd_mpi *world, const struct ranks_apart *found,
                          struct ranks_visitor **in, uint64_t *in_count)
{
    int size = world->link.size;
    uint64_t *first = calloc(2 * ((size_t)size + 1), sizeof *first);
    struct ranks_visitor *out = ranks_array(2 * found->count, sizeof *out);
    int status = ranks_agree_on(
        &world->link, first == NULL || out == NULL ? ranks_no_memory(world) : PCCD_OK);
    if (status == PCCD_OK) {
        uint64_t count = 0;
        for (int r = 0; r < size; r++) {
            first[r] = count;
            for (uint64_t i = 0; i < found->count; i++) {
                const struct pccd_near *record = &found->records[i];
                const uint32_t *points = common_kinds[record->kind].points;
                if (judge_of(world, record) == r) {
                    ranks_apart_find(found,
                                     ranks_place_of_object(world, record->object_a),
                                     points[0], record->feature_a, &out[count++]);
                    ranks_apart_find(found,
                                     ranks_place_of_object(world, record->object_b),
                                     points[1], record->feature_b, &out[count++]);
                }
            }
        }
        first[size] = count;
        status = ranks_deal(&world->link, sizeof *out, out, first, (void **)in,
                            first + size + 1);
        *in_count = first[2 * size + 1];
    }
    free(first);
    free(out);
    return status;
}

/* Of the two objects of other records, this rank has not all candidates. */
static void keep_judged(const struct pccd_mpi *world, struct ranks_apart *apart)
{
    uint64_t kept = 0;
    for (uint64_t i = 0; i < apart->count; i++) {
        if (judge_of(world, &apart->records[i]) == world->link.rank) {
            apart->records[kept++] = apart->records[i];
        }
    }
    apart->count = kept;
}

/* ---- all of it --------------------------------------------------------------------- */

/* However far away: the nearest of what is here. */
static int find_here(struct search *search, struct ranks_apart *found)
{
    struct ranks_visitor *leaves = NULL;
    struct pccd_near_settings near;
    uint64_t count = 0;
    int status = exchange(search, &leaves, &count);
    if (status == PCCD_OK) {
        ranks_ask_rest(search->pairing, &near);
        near.distance = INFINITY;
        near.gap = 0;
        status = ranks_apart_ask(search->pairing->world, leaves, count, &near, found);
    }
    free(leaves);
    return status;
}

static int decide(const struct search *search, const struct ranks_apart *found,
                  struct ranks_apart *apart)
{
    struct pccd_mpi *world = search->pairing->world;
    struct ranks_visitor *leaves = NULL;
    struct pccd_near_settings near;
    uint64_t count = 0;
    int status = send_to_judges(world, found, &leaves, &count);
    if (status == PCCD_OK) {
        ranks_ask_rest(search->pairing, &near);
        status = ranks_apart_ask(world, leaves, count, &near, apart);
    }
    free(leaves);
    if (status == PCCD_OK) {
        keep_judged(world, apart);
        ranks_apart_add(apart, found);
    }
    return status;
}

/* How far apart two objects may be at most and have a record, whatever radii they have.
 * PCCD_E_LIMIT, as in one process. */
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

int ranks_nearest(const struct ranks_pairing *pairing, struct ranks_apart *apart)
{
    struct pccd_mpi *world = pairing->world;
    struct search search = {.pairing = pairing};
    struct ranks_apart found = {.count = 0};
    int status = find_reach(pairing, &search.reach);
    if (status == PCCD_OK) {
        status = ranks_spots_make(pairing, &search.mine, &search.mine_count);
    }
    search.first = ranks_array((uint64_t)world->link.size + 1, sizeof *search.first);
    if (status == PCCD_OK && search.first == NULL) {
        status = ranks_no_memory(world);
    }
    status = ranks_agree_on(&world->link, status);
    if (status == PCCD_OK) {
        status = ranks_spread(&world->link, sizeof *search.mine, search.mine,
                              search.mine_count, (void **)&search.all, search.first);
    }
    if (status == PCCD_OK) {
        status = agree_on_bounds(&search);
    }
    if (status == PCCD_OK) {
        status = find_here(&search, &found);
    }
    if (status == PCCD_OK) {
        status = decide(&search, &found, apart);
    }
    ranks_apart_deinit(world, &found);
    search_deinit(&search);
    return status;
}

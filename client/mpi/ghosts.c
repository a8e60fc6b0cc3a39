/* ghosts.c - leaves that ranks have to know of each other.
 *
 * Room:     client/mpi.
 * Does:     compare own leaves with the blocks of others, send, and let libpccd know.
 * Threads:  one.
 * Source:   ghosts.h.
 */
#include "ghosts.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "boxes.h"
#include "clock.h"
#include "local.h"
#include "neighbours.h"
#include "places.h"
#include "rank_sort.h"

#define WAY_UNITS (1 << 20)

/* What moves by less than a part of the size of its leaves gets room for so many steps
 * that go on like this one, and as much again on all sides, up to so many of these sizes:
 * so ghosts stay right for some steps, and are not many more. To choose them takes as
 * long as five steps and more. So the room is doubled if vertices have left their boxes
 * when the choice had taken more than a part of the steps for which it was right, and
 * ghosts are few beside what ranks own. It is halved if the choice was cheap. */
#define ROOM_SLOW    0.25
#define ROOM_STEPS   32.0
#define ROOM_PART    1.0
#define ROOM_MAX     8.0 /* times as much */
#define ROOM_DEAR    0.1
#define ROOM_GHOSTS  0.125 /* of what ranks own */
#define SIZE_SAMPLES 1024u

/* What moves fast gets room for one more step, and on all sides for a part of one, at
 * first the least: twice as much each time that vertices have left their boxes when the
 * choice of ghosts had taken more than this part of the steps for which they were right,
 * half as much if it was less than that. */
#define FAST_STEPS_MIN 0.125
#define FAST_STEPS_MAX 4.0
#define FAST_PART      0.5 /* on all sides there is no more */
#define DEAR_PART      0.25
#define CHEAP_PART     0.03

/* A ghost under way. */
struct visitor {
    uint32_t object;
    struct ranks_leaf leaf;
};

/* What choosing ghosts needs for its time. */
struct choice {
    double separation;
    double *ways;                /* [object] what a vertex moves, mean */
    struct ranks_room *rooms;    /* [object] */
    double (**x0)[3], (**x1)[3]; /* [object] of local vertices */
    struct ranks_boxes mine;     /* of own leaves, and their blocks */
    struct ranks_block *all;     /* blocks of all ranks */
    uint64_t *first;             /* [size + 1] of these */
    struct visitor *out;
    uint64_t *out_first;
    struct visitor *in;
    uint64_t *in_first;
};

static void choice_deinit(const struct pccd_mpi *world, struct choice *choice)
{
    for (uint32_t o = 0; o < world->object_count; o++) {
        if (choice->x0 != NULL) {
            free(choice->x0[o]);
        }
        if (choice->x1 != NULL) {
            free(choice->x1[o]);
        }
    }
    free((void *)choice->x0);
    free((void *)choice->x1);
    free(choice->ways);
    free(choice->rooms);
    ranks_boxes_deinit(&choice->mine);
    free(choice->all);
    free(choice->first);
    free(choice->out);
    free(choice->out_first);
    free(choice->in);
    free(choice->in_first);
}

/* ---- how far things go ------------------------------------------------------------ */

/* How far a vertex moves along the axis along which it moves most. */
static double way_of(const struct ranks_object *object, uint32_t i)
{
    const double *from = object->from[i], *to = object->to[i];
    return fmax(fabs(to[0] - from[0]),
                fmax(fabs(to[1] - from[1]), fabs(to[2] - from[2])));
}

/* The mean way of each object's vertices: in units of the longest, so that sums over
 * ranks are whole numbers and the same everywhere. */
static int find_ways(struct pccd_mpi *world, double *ways)
{
    uint32_t objects = world->object_count;
    uint64_t *sums = ranks_array(objects, sizeof *sums);
    int status =
        ranks_agree_on(&world->link, sums == NULL ? ranks_no_memory(world) : PCCD_OK);
    for (uint32_t o = 0; o < objects && status == PCCD_OK; o++) {
        const struct ranks_object *object = world->objects[o];
        ways[o] = 0;
        for (uint32_t i = 0; i < object->mesh->vertex_count; i++) {
            ways[o] = fmin(ways[o], -way_of(object, i));
        }
    }
    if (status == PCCD_OK) {
        status = ranks_min_doubles(&world->link, ways, (int)objects);
    }
    for (uint32_t o = 0; o < objects && status == PCCD_OK; o++) {
        const struct ranks_object *object = world->objects[o];
        sums[o] = 0;
        for (uint32_t i = 0; i < object->mesh->vertex_count && ways[o] < 0; i++) {
            sums[o] += (uint64_t)(way_of(object, i) / -ways[o] * WAY_UNITS);
        }
    }
    if (status == PCCD_OK) {
        status = ranks_sum(&world->link, sums, (int)objects);
    }
    for (uint32_t o = 0; o < objects && status == PCCD_OK; o++) {
        double mean = (double)sums[o] / WAY_UNITS / world->objects[o]->mesh->vertex_total;
        ways[o] = -ways[o] * mean;
    }
    free(sums);
    return status;
}

/* How large leaves of the object are here: the mean side of some. */
static int measure(struct pccd_mpi *world, const struct ranks_object *object,
                   const double (*x)[3], double *size)
{
    uint32_t count = object->own_count < SIZE_SAMPLES ? object->own_count : SIZE_SAMPLES;
    uint32_t(*corners)[3] = ranks_array(count, sizeof *corners);
    int status = corners == NULL ? ranks_no_memory(world)
                                 : ranks_local_corners(world, &object->local, object->own,
                                                       count, corners);
    double sum = 0;
    for (uint32_t i = 0; i < count && status == PCCD_OK; i++) {
        const double *a = x[corners[i][0]], *b = x[corners[i][1]];
        sum += fmax(fabs(a[0] - b[0]), fmax(fabs(a[1] - b[1]), fabs(a[2] - b[2])));
    }
    *size = count > 0 ? sum / count : DBL_MAX;
    free(corners);
    return status;
}

/* From the mean ways of vertices to how much room they get; the smallest size of all
 * ranks counts. */
static int find_rooms(struct pccd_mpi *world, double (*const *x)[3], const double *ways,
                      struct ranks_room *rooms)
{
    uint32_t objects = world->object_count;
    double *sizes = ranks_array(objects, sizeof *sizes);
    int status = sizes == NULL ? ranks_no_memory(world) : PCCD_OK;
    for (uint32_t o = 0; o < objects && status == PCCD_OK; o++) {
        status = measure(world, world->objects[o], (const double(*)[3])x[o], &sizes[o]);
    }
    status = ranks_agree_on(&world->link, status);
    if (status == PCCD_OK) {
        status = ranks_min_doubles(&world->link, sizes, (int)objects);
    }
    for (uint32_t o = 0; o < objects && status == PCCD_OK; o++) {
        bool is_slow = ways[o] < ROOM_SLOW * sizes[o];
        double room =
            is_slow ? world->slow_room * fmin(ROOM_STEPS * ways[o], ROOM_PART * sizes[o])
                    : 0;
        rooms[o].steps = fmax(1 + world->fast_steps - FAST_STEPS_MIN,
                              ways[o] > 0 ? room / ways[o] : 0);
        rooms[o].more = fmax(fmin(world->fast_steps, FAST_PART) * ways[o], room);
    }
    free(sizes);
    return status;
}

/* Of each given vertex of the object: the box within which it may be. */
static int cover(struct pccd_mpi *world, struct ranks_object *object,
                 const struct ranks_room *room)
{
    uint32_t count = object->mesh->vertex_count;
    if (object->cover == NULL) {
        object->cover = ranks_array(count, sizeof *object->cover);
    }
    if (object->cover == NULL) {
        return ranks_no_memory(world);
    }
    for (uint32_t i = 0; i < count; i++) {
        ranks_cover(object->from[i], object->to[i], room, object->cover[i]);
    }
    return PCCD_OK;
}

bool ranks_ghosts_miss(const struct ranks_object *object)
{
    if (object->cover == NULL) {
        return true;
    }
    for (uint32_t i = 0; i < object->mesh->vertex_count; i++) {
        for (int k = 0; k < 3; k++) {
            double a = object->from[i][k], b = object->to[i][k];
            double low = a < b ? a : b, high = a > b ? a : b;
            if (low < (double)object->cover[i][k] ||
                high > (double)object->cover[i][k + 3]) {
                return true;
            }
        }
    }
    return false;
}

/* Positions of all local vertices at both ends. */
static int fetch(struct pccd_mpi *world, struct choice *choice)
{
    uint32_t objects = world->object_count;
    const double(**given)[3] = calloc((size_t)objects + 1, sizeof *given);
    choice->x0 = calloc((size_t)objects + 1, sizeof *choice->x0);
    choice->x1 = calloc((size_t)objects + 1, sizeof *choice->x1);
    choice->ways = ranks_array(objects, sizeof *choice->ways);
    choice->rooms = ranks_array(objects, sizeof *choice->rooms);
    int status = given == NULL || choice->x0 == NULL || choice->x1 == NULL ||
                         choice->ways == NULL || choice->rooms == NULL
                     ? ranks_no_memory(world)
                     : PCCD_OK;
    for (uint32_t o = 0; o < objects && status == PCCD_OK; o++) {
        uint32_t count = world->objects[o]->local.vertex_count;
        choice->x0[o] = ranks_array(count, sizeof **choice->x0);
        choice->x1[o] = ranks_array(count, sizeof **choice->x1);
        status = choice->x0[o] == NULL || choice->x1[o] == NULL ? ranks_no_memory(world)
                                                                : PCCD_OK;
    }
    status = ranks_agree_on(&world->link, status);
    for (int end = 0; end < 2 && status == PCCD_OK; end++) {
        for (uint32_t o = 0; o < objects; o++) {
            given[o] = end == 0 ? world->objects[o]->from : world->objects[o]->to;
        }
        status = ranks_plan_send(world, given, end == 0 ? choice->x0 : choice->x1);
    }
    free((void *)given);
    if (status == PCCD_OK) {
        status = find_ways(world, choice->ways);
    }
    return status == PCCD_OK ? find_rooms(world, choice->x0, choice->ways, choice->rooms)
                             : status;
}

/* ---- who needs what --------------------------------------------------------------- */

/* Which of the own leaves go to rank r: counts, or with out != NULL writes them. */
static uint64_t choose_for(const struct pccd_mpi *world, const struct choice *choice,
                           const struct ranks_block **near, int r, struct visitor *out)
{
    uint64_t count = 0;
    const struct ranks_boxes *mine = &choice->mine;
    for (uint32_t b = 0; b < mine->block_count; b++) {
        const struct ranks_block *block = &mine->blocks[b];
        uint32_t near_count = 0;
        for (uint64_t i = choice->first[r]; i < choice->first[r + 1]; i++) {
            const struct ranks_block *theirs = &choice->all[i];
            if (ranks_boxes_meet(block->box, theirs->box) &&
                ranks_may_meet(world, block->object, theirs->object)) {
                near[near_count++] = theirs;
            }
        }
        const struct ranks_object *object = world->objects[block->object];
        for (uint32_t i = 0; i < block->count && near_count > 0; i++) {
            uint32_t leaf = block->begin + i;
            const float *box = mine->boxes[mine->first[block->object] + leaf];
            uint32_t n = 0;
            while (n < near_count && !ranks_boxes_meet(box, near[n]->box)) {
                n++;
            }
            if (n < near_count) {
                if (out != NULL) {
                    out[count] = (struct visitor){block->object, object->own[leaf]};
                }
                count++;
            }
        }
    }
    return count;
}

/* Of the blocks of each rank those that meet none of this rank's stay out. */
static int choose(struct pccd_mpi *world, struct choice *choice)
{
    struct ranks_link *link = &world->link;
    uint64_t cells = (uint64_t)link->size + 1;
    const struct ranks_block **near =
        ranks_array(choice->first[link->size], sizeof *near);
    choice->out_first = ranks_array(cells, sizeof(uint64_t));
    choice->in_first = ranks_array(cells, sizeof(uint64_t));
    if (near == NULL || choice->out_first == NULL || choice->in_first == NULL) {
        free(near);
        return ranks_no_memory(world);
    }
    for (int pass = 0; pass < 2; pass++) {
        uint64_t count = 0;
        for (int r = 0; r < link->size; r++) {
            choice->out_first[r] = count;
            count += r == link->rank
                         ? 0
                         : choose_for(world, choice, near, r,
                                      choice->out ? choice->out + count : NULL);
        }
        choice->out_first[link->size] = count;
        if (pass == 0) {
            choice->out = ranks_array(count, sizeof *choice->out);
            if (choice->out == NULL) {
                free(near);
                return ranks_no_memory(world);
            }
        }
    }
    free(near);
    return PCCD_OK;
}

/* Blocks far from all of this rank need not be looked at again and again. */
static void forget_far(const struct pccd_mpi *world, struct choice *choice)
{
    float whole[6];
    ranks_box_begin(whole);
    for (uint32_t b = 0; b < choice->mine.block_count; b++) {
        ranks_box_add(whole, choice->mine.blocks[b].box);
    }
    uint64_t kept = 0;
    for (int r = 0; r < world->link.size; r++) {
        uint64_t begin = choice->first[r];
        choice->first[r] = kept;
        for (uint64_t i = begin; i < choice->first[r + 1]; i++) {
            if (ranks_boxes_meet(whole, choice->all[i].box)) {
                choice->all[kept++] = choice->all[i];
            }
        }
    }
    choice->first[world->link.size] = kept;
}

/* ---- those that came -------------------------------------------------------------- */

/* Are these the ghosts that the object has? The same leaf has the same number. */
static bool has_ghosts(const struct ranks_object *object, const struct ranks_leaf *ghosts,
                       uint32_t count)
{
    bool is_same = count == object->ghost_count;
    for (uint32_t i = 0; i < count && is_same; i++) {
        is_same = ghosts[i].number == object->ghosts[i].number;
    }
    return is_same;
}

/* Those of one object that came, and its neighbours, each once and by their numbers. */
static int settle_object(struct pccd_mpi *world, struct ranks_object *object,
                         const struct visitor *in, const struct ranks_key *came,
                         uint64_t came_count)
{
    uint64_t count = came_count + object->neighbour_count;
    struct ranks_key *keys = ranks_array(2 * count, sizeof *keys);
    struct ranks_leaf *ghosts = ranks_array(count, sizeof *ghosts);
    uint32_t each = 0;
    if (keys == NULL || ghosts == NULL) {
        free(keys);
        free(ghosts);
        return ranks_no_memory(world);
    }
    for (uint64_t i = 0; i < count; i++) {
        keys[i] =
            (struct ranks_key){i < came_count ? in[came[i].value].leaf.number
                                              : object->neighbours[i - came_count].number,
                               i};
    }
    const struct ranks_key *sorted = ranks_sort(keys, keys + count, count);
    for (uint64_t i = 0; i < count; i++) {
        uint64_t at = sorted[i].value;
        if (i == 0 || sorted[i].key != sorted[i - 1].key) {
            ghosts[each++] = at < came_count ? in[came[at].value].leaf
                                             : object->neighbours[at - came_count];
        }
    }
    object->is_built = object->is_built && has_ghosts(object, ghosts, each);
    free(object->ghosts);
    free(keys);
    object->ghosts = ghosts;
    object->ghost_count = each;
    return PCCD_OK;
}

/* Ghosts by object. Objects that have the same as before stay as they are. */
static int settle(struct pccd_mpi *world, const struct choice *choice)
{
    uint64_t count = choice->in_first[world->link.size];
    struct ranks_key *keys = ranks_array(2 * count, sizeof *keys);
    if (keys == NULL) {
        return ranks_no_memory(world);
    }
    for (uint64_t i = 0; i < count; i++) {
        keys[i] = (struct ranks_key){choice->in[i].object, i};
    }
    const struct ranks_key *sorted = ranks_sort(keys, keys + count, count);
    uint64_t at = 0;
    int status = PCCD_OK;
    for (uint32_t o = 0; o < world->object_count && status == PCCD_OK; o++) {
        uint64_t begin = at;
        while (at < count && sorted[at].key == o) {
            at++;
        }
        status = settle_object(world, world->objects[o], choice->in, sorted + begin,
                               at - begin);
    }
    free(keys);
    return status;
}

/* Let libpccd have the objects that have changed in any rank. */
static int build(struct pccd_mpi *world)
{
    struct ranks_link *link = &world->link;
    uint32_t objects = world->object_count;
    uint8_t *changed = ranks_array(objects, 1);
    int status = changed == NULL ? ranks_no_memory(world) : PCCD_OK;
    bool any = false;
    for (uint32_t o = 0; o < objects && status == PCCD_OK; o++) {
        struct ranks_object *object = world->objects[o];
        changed[o] = !object->is_built;
        status = changed[o] ? ranks_local_make(world, object) : PCCD_OK;
    }
    status = ranks_agree_on(link, status);
    if (status == PCCD_OK) {
        status = ranks_max_bytes(link, changed, (int)objects);
    }
    for (uint32_t o = 0; o < objects && status == PCCD_OK; o++) {
        any = any || changed[o];
    }
    if (any && status == PCCD_OK) {
        status = ranks_plan_make(world);
    }
    for (uint32_t o = 0; o < objects && status == PCCD_OK; o++) {
        if (changed[o]) {
            status = ranks_local_put(world, world->objects[o]);
        }
    }
    free(changed);
    return status;
}

static int choose_all(struct pccd_mpi *world, struct choice *choice)
{
    struct ranks_link *link = &world->link;
    int status = fetch(world, choice);
    if (status != PCCD_OK) {
        return status;
    }
    for (uint32_t o = 0; o < world->object_count && status == PCCD_OK; o++) {
        status = cover(world, world->objects[o], &choice->rooms[o]);
    }
    if (status == PCCD_OK) {
        status = ranks_boxes_make(world, choice->separation, choice->rooms,
                                  (const double(*const *)[3])choice->x0,
                                  (const double(*const *)[3])choice->x1, &choice->mine);
    }
    choice->first = ranks_array((uint64_t)link->size + 1, sizeof(uint64_t));
    if (status == PCCD_OK && choice->first == NULL) {
        status = ranks_no_memory(world);
    }
    status = ranks_agree_on(link, status);
    if (status == PCCD_OK) {
        status =
            ranks_spread(link, sizeof(struct ranks_block), choice->mine.blocks,
                         choice->mine.block_count, (void **)&choice->all, choice->first);
    }
    if (status != PCCD_OK) {
        return status;
    }
    forget_far(world, choice);
    status = ranks_agree_on(link, choose(world, choice));
    if (status == PCCD_OK) {
        status = ranks_deal(link, sizeof *choice->out, choice->out, choice->out_first,
                            (void **)&choice->in, choice->in_first);
    }
    for (uint32_t o = 0; o < world->object_count && status == PCCD_OK; o++) {
        status = ranks_neighbours_find(world, world->objects[o]);
    }
    return status == PCCD_OK ? ranks_agree_on(link, settle(world, choice)) : status;
}

/* How much room what moves gets from now on. */
static void choose_room(struct pccd_mpi *world, bool has_missed)
{
    if (has_missed && world->choice_ns > DEAR_PART * world->right_ns) {
        world->fast_steps = fmin(2 * world->fast_steps, FAST_STEPS_MAX);
    } else if (has_missed && world->choice_ns < CHEAP_PART * world->right_ns) {
        world->fast_steps = world->fast_steps / 2;
    }
    world->fast_steps = fmax(world->fast_steps, FAST_STEPS_MIN);
    if (has_missed && world->choice_ns > ROOM_DEAR * world->right_ns &&
        world->ghost_part < ROOM_GHOSTS) {
        world->slow_room = fmin(2 * world->slow_room, ROOM_MAX);
    } else if (has_missed && world->choice_ns < CHEAP_PART * world->right_ns) {
        world->slow_room = world->slow_room / 2;
    }
    world->slow_room = fmax(world->slow_room, 1);
}

/* How long the slowest rank took for it, and how many ghosts all have. */
static int learn(struct pccd_mpi *world, uint64_t begin_ns)
{
    uint64_t leaves[2] = {0, 0}; /* own ones, ghosts */
    for (uint32_t o = 0; o < world->object_count; o++) {
        leaves[0] += world->objects[o]->own_count;
        leaves[1] += world->objects[o]->local.leaf_count - world->objects[o]->own_count;
    }
    world->choice_ns = -(double)(common_now_ns() - begin_ns);
    world->right_ns = 0;
    int status = ranks_min_doubles(&world->link, &world->choice_ns, 1);
    world->choice_ns = -world->choice_ns;
    if (status == PCCD_OK) {
        status = ranks_sum(&world->link, leaves, 2);
    }
    world->ghost_part = leaves[0] > 0 ? (double)leaves[1] / (double)leaves[0] : 0;
    return status;
}

int ranks_ghosts_choose(struct pccd_mpi *world, double separation, bool has_missed)
{
    struct choice choice = {.separation = separation};
    uint64_t begin_ns = common_now_ns();
    world->is_covered = false;
    choose_room(world, has_missed);
    int status = choose_all(world, &choice);
    choice_deinit(world, &choice);
    if (status == PCCD_OK) {
        status = build(world);
    }
    if (status == PCCD_OK) {
        status = learn(world, begin_ns);
    }
    if (status == PCCD_OK) {
        world->is_covered = true;
        world->reach = separation;
        world->share.searches++;
    }
    return status;
}

/* rooms.c - how much larger than a step boxes are.
 *
 * Room:     client/mpi.
 * Does:     see how far vertices go, and how large leaves are; weigh what choosing ghosts
 *           takes against what ghosts take.
 * Threads:  one.
 * Source:   rooms.h.
 */
#include "rooms.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>

#include "local.h"

#define WAY_UNITS (1 << 20)

/* To choose ghosts takes 630 ns for each leaf and ghost of a rank, and a unit of work 14
 * (balance.c). Work is counted, not timed, so that other programs that use the processors
 * do not change how many ghosts there are. */
#define CHOICE_WORK 45.0

/* What moves by less than a part of the size of its leaves gets room for so many steps
 * that go on like this one, and as much again on both sides along each axis, up to so
 * many of these sizes: so ghosts stay right for some steps, and are not many more. Along
 * an axis along which little moves it is less, but no less than a part.
 *
 * Twice the room, and they are right for twice as many steps: that saves half of the part
 * of the time that choosing takes. Ghosts are then at most twice as many, and each takes
 * two fifths of the time of an own leaf. So the room is doubled if vertices have left
 * their boxes and choosing had taken more than four fifths of the ghosts' part of the
 * leaves. If it was much less, there are too many ghosts, and the room is halved. */
#define ROOM_SLOW    0.25
#define ROOM_STEPS   32.0
#define ROOM_PART    1.0
#define ASIDE_PART   0.25 /* of the room, along an axis along which little moves */
#define ROOM_MAX     64.0 /* times as much */
#define ROOM_DEAR    0.8
#define ROOM_CHEAP   0.1
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

/* How far a vertex moves along an axis. */
static double way_of(const struct ranks_object *object, uint32_t i, uint32_t axis)
{
    return fabs(object->to[i][axis] - object->from[i][axis]);
}

/* The mean ways of each object's vertices, ways[3 * object + axis]: in units of the
 * longest, so that sums over ranks are whole numbers and the same everywhere. */
static int find_ways(struct pccd_mpi *world, double *ways)
{
    uint32_t count = 3 * world->object_count;
    uint64_t *sums = ranks_array(count, sizeof *sums);
    int status =
        ranks_agree_on(&world->link, sums == NULL ? ranks_no_memory(world) : PCCD_OK);
    for (uint32_t w = 0; w < count && status == PCCD_OK; w++) {
        const struct ranks_object *object = world->objects[w / 3];
        ways[w] = 0;
        for (uint32_t i = 0; i < object->mesh->vertex_count; i++) {
            ways[w] = fmin(ways[w], -way_of(object, i, w % 3));
        }
    }
    if (status == PCCD_OK) {
        status = ranks_min_doubles(&world->link, ways, (int)count);
    }
    for (uint32_t w = 0; w < count && status == PCCD_OK; w++) {
        const struct ranks_object *object = world->objects[w / 3];
        sums[w] = 0;
        for (uint32_t i = 0; i < object->mesh->vertex_count && ways[w] < 0; i++) {
            sums[w] += (uint64_t)(way_of(object, i, w % 3) / -ways[w] * WAY_UNITS);
        }
    }
    if (status == PCCD_OK) {
        status = ranks_sum(&world->link, sums, (int)count);
    }
    for (uint32_t w = 0; w < count && status == PCCD_OK; w++) {
        uint32_t vertices = world->objects[w / 3]->mesh->vertex_total;
        ways[w] = -ways[w] * (double)sums[w] / WAY_UNITS / vertices;
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
static int find_by_ways(struct pccd_mpi *world, double (*const *x)[3], const double *ways,
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
        const double *along = ways + 3 * (size_t)o;
        double way = fmax(along[0], fmax(along[1], along[2]));
        bool is_slow = way < ROOM_SLOW * sizes[o];
        double room =
            is_slow ? world->slow_room * fmin(ROOM_STEPS * way, ROOM_PART * sizes[o]) : 0;
        double steps = way > 0 ? room / way : 0;
        rooms[o].steps = fmax(1 + world->fast_steps - FAST_STEPS_MIN, steps);
        for (int k = 0; k < 3; k++) {
            rooms[o].more[k] = fmax(fmin(world->fast_steps, FAST_PART) * way,
                                    fmax(steps * along[k], ASIDE_PART * room));
        }
    }
    free(sizes);
    return status;
}

int ranks_rooms_find(struct pccd_mpi *world, double (*const *x)[3],
                     struct ranks_room *rooms)
{
    double *ways = ranks_array(3 * (uint64_t)world->object_count, sizeof *ways);
    int status =
        ranks_agree_on(&world->link, ways == NULL ? ranks_no_memory(world) : PCCD_OK);
    if (status == PCCD_OK) {
        status = find_ways(world, ways);
    }
    if (status == PCCD_OK) {
        status = find_by_ways(world, x, ways, rooms);
    }
    free(ways);
    return status;
}

/* How much room what moves gets from now on. */
void ranks_rooms_choose(struct pccd_mpi *world, bool has_missed)
{
    if (has_missed && world->choice_work > DEAR_PART * world->right_work) {
        world->fast_steps = fmin(2 * world->fast_steps, FAST_STEPS_MAX);
    } else if (has_missed && world->choice_work < CHEAP_PART * world->right_work) {
        world->fast_steps = world->fast_steps / 2;
    }
    world->fast_steps = fmax(world->fast_steps, FAST_STEPS_MIN);
    double ghosts_work = world->ghost_part * world->right_work;
    if (has_missed && world->choice_work > ROOM_DEAR * ghosts_work) {
        world->slow_room = fmin(2 * world->slow_room, ROOM_MAX);
    } else if (has_missed && world->choice_work < ROOM_CHEAP * ghosts_work) {
        world->slow_room = world->slow_room / 2;
    }
    world->slow_room = fmax(world->slow_room, 1);
}

/* What it took the rank that has most, and how many ghosts all have. */
int ranks_rooms_learn(struct pccd_mpi *world)
{
    uint64_t leaves[2] = {0, 0}; /* own ones, ghosts */
    for (uint32_t o = 0; o < world->object_count; o++) {
        leaves[0] += world->objects[o]->own_count;
        leaves[1] += world->objects[o]->local.leaf_count - world->objects[o]->own_count;
    }
    world->choice_work = -CHOICE_WORK * (double)(leaves[0] + leaves[1]);
    world->right_work = 0;
    int status = ranks_min_doubles(&world->link, &world->choice_work, 1);
    world->choice_work = -world->choice_work;
    if (status == PCCD_OK) {
        status = ranks_sum(&world->link, leaves, 2);
    }
    world->ghost_part = leaves[0] > 0 ? (double)leaves[1] / (double)leaves[0] : 0;
    return status;
}

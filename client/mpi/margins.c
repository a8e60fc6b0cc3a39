/* margins.c - how much larger than a step boxes are. */
#include "ghosts.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>

#include "parts.h"

#define WAY_UNITS (1 << 20)

/* To choose ghosts takes 600 ns for each leaf and ghost of a rank, and a unit of work 14
 * (balance.c). Work is counted, not timed, so that other programs that use the processors
 * do not change how many ghosts there are. */
#define CHOICE_WORK 43.0

/* Boxes follow what goes on as it went. Whether it does is seen when ghosts are chosen
 * anew: how far vertices are, on the average, from where they would be if they had gone
 * on like in the step for which ghosts were chosen the last time. If that is e * m * m /
 * 2 after m steps, it will be e * n * n / 2 after n; some vertices have twice the mean.
 * What does not go on like that has a box that stands. Ghosts are right for as many steps
 * as the object says that leaves its box first.
 *
 * What moves by less than a part of the size of its leaves has margin on both sides for
 * so many steps, up to one such size. Along an axis along which little moves it is less,
 * but no less than a part.
 *
 * Twice the margin, and ghosts are right for up to twice as many steps: that saves
 * half of the part of the time that choosing takes. Ghosts are then at most twice as
 * many, and each takes two fifths of the time of an own leaf. So the margin is doubled
 * if choosing had taken more than four fifths of the ghosts' part of the leaves when
 * vertices left their boxes. If it was much less, there are too many ghosts, and the
 * margin is halved. It stays if they left far too early: not margin was missing, it
 * was not known how they go. */
#define MARGIN_SLOW  0.25
#define MARGIN_STEPS 32.0
#define MARGIN_LEAST 0.0625 /* of a leaf, where boxes follow */
#define ASIDE_PART   0.25   /* of the margin, along an axis along which little moves */
#define MARGIN_MIN   1.0    /* times as much */
#define MARGIN_MAX   64.0
#define MARGIN_DEAR  0.8
#define MARGIN_CHEAP 0.1
#define SAMPLES      1024u

/* Bounds of the margin of what moves fast, in steps.
 *
 * What moves fast, and not as it went, has the least margin as long as nobody has left
 * it: ghosts are for that one step, and for the same one again. When that has happened,
 * it has margin for a part of a step, at first the least: twice as much each time that
 * the choice of ghosts had taken more than this part of the steps for which they were
 * right, half as much if it was less than that. What moves fast goes on as it went if it
 * will be off by no more than its way in a step, FOLLOW_STEPS later. */
#define FAST_STEPS_MIN  0.125
#define FAST_STEPS_MAX  4.0
#define FAST_STEPS_LAST 16.0 /* times as many, at most, do its boxes follow */
#define FOLLOW_STEPS    2.0
#define DEAR_PART       0.25
#define CHEAP_PART      0.03

/* ---- where vertices go ------------------------------------------------------------ */

static uint32_t sample_count(const struct ranks_object *object)
{
    return object->mesh->vertex_count < SAMPLES ? object->mesh->vertex_count : SAMPLES;
}

/* The given vertex that is the j-th of the samples. */
static uint32_t sample_at(const struct ranks_object *object, uint32_t j)
{
    return (uint32_t)((uint64_t)j * object->mesh->vertex_count / sample_count(object));
}

/* Memory for guesses. */
static int make_guesses(struct pccd_mpi *world)
{
    for (uint32_t o = 0; o < world->object_count; o++) {
        struct ranks_object *object = world->objects[o];
        if (object->guess == NULL) {
            object->guess = ranks_array(sample_count(object), sizeof *object->guess);
        }
        if (object->guess == NULL) {
            return ranks_no_memory(world);
        }
    }
    return PCCD_OK;
}

/* Note where samples are and how they go, for the next time. */
static void guess(const struct pccd_mpi *world)
{
    for (uint32_t o = 0; o < world->object_count; o++) {
        struct ranks_object *object = world->objects[o];
        for (uint32_t j = 0; j < sample_count(object); j++) {
            const uint32_t i = sample_at(object, j);
            for (int k = 0; k < 3; k++) {
                object->guess[j][k] = object->from[i][k];
                object->guess[j][k + 3] = object->to[i][k] - object->from[i][k];
            }
        }
        object->has_guess = true;
    }
}

/* Lengths that are known of how an object goes, each along three axes. */
enum { WAY = 0, GONE = 3, OFF = 6, WAYS = 9 };

/* Return how far the j-th sample goes in this step; or how far it has gone in `steps`
 * since ghosts were chosen; or how far it is from where it would be. */
static double way_of(const struct ranks_object *object, uint32_t steps, uint32_t j,
                     uint32_t which)
{
    const uint32_t i = sample_at(object, j), k = which % 3;
    double to = object->to[i][k], way = to - object->from[i][k];
    if (which >= GONE && object->has_guess) {
        way = to - object->guess[j][k];
        way -= which >= OFF ? steps * object->guess[j][k + 3] : 0;
    }
    return fabs(way);
}

/* The mean ways of each object's vertices, ways[WAYS * object + which]: in units of the
 * longest, so that sums over ranks are whole numbers and the same everywhere. */
static int find_ways(struct pccd_mpi *world, uint32_t steps, double *ways)
{
    uint32_t count = WAYS * world->object_count;
    uint64_t *sums = ranks_array(count, sizeof *sums);
    int status = ranks_agree_memory(world, sums != NULL);
    for (uint32_t w = 0; w < count && status == PCCD_OK; w++) {
        const struct ranks_object *object = world->objects[w / WAYS];
        ways[w] = 0;
        for (uint32_t j = 0; j < sample_count(object); j++) {
            ways[w] = fmax(ways[w], way_of(object, steps, j, w % WAYS));
        }
    }
    if (status == PCCD_OK) {
        status = ranks_max_doubles(&world->link, ways, (int)count);
    }
    for (uint32_t w = 0; w < count && status == PCCD_OK; w++) {
        const struct ranks_object *object = world->objects[w / WAYS];
        uint64_t samples = sample_count(object);
        sums[w] = 0;
        for (uint32_t j = 0; j < samples && ways[w] > 0; j++) {
            sums[w] +=
                (uint64_t)(way_of(object, steps, j, w % WAYS) / ways[w] * WAY_UNITS);
        }
        sums[w] = samples > 0 ? sums[w] * object->mesh->vertex_count / samples : 0;
    }
    if (status == PCCD_OK) {
        status = ranks_sum(&world->link, sums, (int)count);
    }
    for (uint32_t w = 0; w < count && status == PCCD_OK; w++) {
        uint32_t vertices = world->objects[w / WAYS]->mesh->vertex_total;
        ways[w] = ways[w] * (double)sums[w] / WAY_UNITS / vertices;
    }
    free(sums);
    return status;
}

/* From that to the ways and errors of one step. An object of which nothing is known yet,
 * as it is new, or ghosts were chosen in the last step, is not followed. */
static void find_errors(const struct ranks_object *object, double steps, double *ways)
{
    bool is_known = object->has_guess && steps >= 2;
    for (int k = 0; k < 3; k++) {
        ways[GONE + k] = is_known ? ways[GONE + k] / steps : ways[WAY + k];
        ways[OFF + k] =
            is_known ? 2 * ways[OFF + k] / (steps * (steps - 1)) : ways[WAY + k];
    }
}

/* ---- rooms ------------------------------------------------------------------------- */

/* Find how large leaves of the object are here: the mean side of some. */
static int measure(struct pccd_mpi *world, const struct ranks_object *object,
                   const double (*x)[3], double *size)
{
    uint32_t count = object->own_count < SAMPLES ? object->own_count : SAMPLES;
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

static double longest_of(const double *along)
{
    return fmax(along[0], fmax(along[1], along[2]));
}

/* The most margin of an object, whose leaves have that size; along which axes its boxes
 * follow, and for how many steps ghosts are right by this object. */
static double find_steps(const struct pccd_mpi *world, const double *ways, double size,
                         struct ranks_margin *margin, double *most)
{
    double way = longest_of(ways + WAY), steps = INFINITY;
    bool is_slow = way < MARGIN_SLOW * size;
    if (!(way > 0)) {
        *most = 0;
        return steps;
    }
    *most = is_slow ? world->slow_margin * fmin(MARGIN_STEPS * way, size)
                    : world->fast_steps * way;
    for (int k = 0; k < 3; k++) {
        double error = ways[OFF + k], gone = ways[GONE + k];
        double near = error > 0 ? sqrt(*most / error) : INFINITY;
        near = fmax(near, FOLLOW_STEPS);
        bool is_near = is_slow || FOLLOW_STEPS * FOLLOW_STEPS * error <= way;
        margin->follows[k] = is_near && !(error > 0 && near * error / 2 >= gone);
        steps = fmin(steps, margin->follows[k] ? near
                            : gone > 0         ? *most / (2 * gone)
                                               : INFINITY);
    }
    return fmin(steps, is_slow ? MARGIN_STEPS * world->slow_margin
                               : FAST_STEPS_LAST * world->fast_steps);
}

/* Find the margin of an object that may have `most`, if ghosts are right for so many
 * steps. */
static void find_margin(const double *ways, double size, double steps, double most,
                        struct ranks_margin *margin)
{
    double way = longest_of(ways + WAY), error = 0;
    most = fmin(most, 2 * steps * way);
    for (int k = 0; k < 3; k++) {
        error = margin->follows[k] ? fmax(error, ways[OFF + k]) : error;
    }
    for (int k = 0; k < 3; k++) {
        margin->more[k] = way > 0 ? most * fmax(ways[WAY + k] / way, ASIDE_PART) : 0;
        if (margin->follows[k]) {
            margin->more[k] = steps * steps * fmax(ways[OFF + k], ASIDE_PART * error);
            margin->more[k] = fmax(margin->more[k], MARGIN_LEAST * size);
        }
    }
}

/* Return whether an object moves fast, and not as it went. */
static bool is_fast(const double *ways, double size, const struct ranks_margin *margin)
{
    double way = longest_of(ways + WAY);
    return way >= MARGIN_SLOW * size &&
           !(margin->follows[0] && margin->follows[1] && margin->follows[2]);
}

/* From the mean ways of vertices to how much margin they get; the smallest size of all
 * ranks counts. sizes[object], mosts[object]: scratch. */
static int find_by_ways(struct pccd_mpi *world, double (*const *x)[3], const double *ways,
                        double *sizes, double *mosts)
{
    uint32_t objects = world->object_count;
    double steps = INFINITY;
    bool any = false, has_fast = false;
    int status = PCCD_OK;
    for (uint32_t o = 0; o < objects && status == PCCD_OK; o++) {
        status = measure(world, world->objects[o], (const double(*)[3])x[o], &sizes[o]);
    }
    status = ranks_agree_on(&world->link, status);
    if (status == PCCD_OK) {
        status = ranks_min_doubles(&world->link, sizes, (int)objects);
    }
    for (uint32_t o = 0; o < objects && status == PCCD_OK; o++) {
        struct ranks_margin *margin = &world->objects[o]->margin;
        *margin = (struct ranks_margin){.steps = 0};
        steps = fmin(steps, find_steps(world, ways + WAYS * (size_t)o, sizes[o], margin,
                                       &mosts[o]));
        any = any || margin->follows[0] || margin->follows[1] || margin->follows[2];
        has_fast = has_fast || is_fast(ways + WAYS * (size_t)o, sizes[o], margin);
    }
    world->is_once =
        has_fast && !world->is_for_pairs && world->fast_steps <= FAST_STEPS_MIN;
    steps = any ? floor(fmax(steps, FOLLOW_STEPS)) : INFINITY;
    for (uint32_t o = 0; o < objects && status == PCCD_OK; o++) {
        struct ranks_margin *margin = &world->objects[o]->margin;
        find_margin(ways + WAYS * (size_t)o, sizes[o], steps, mosts[o], margin);
        margin->steps = any ? steps : 1;
        margin->is_whole = world->is_for_pairs;
        if (world->is_once) {
            *margin = (struct ranks_margin){.follows = {true, true, true}, .steps = 1};
        }
    }
    world->lasts = any && !world->is_once ? (uint32_t)steps : UINT32_MAX;
    return status;
}

int ranks_margins_find(struct pccd_mpi *world, bool is_still, double (*const *x)[3])
{
    const uint64_t objects = world->object_count;
    const uint32_t steps = world->gone + (is_still ? 0 : 1);
    double *ways = ranks_array((WAYS + 2) * objects, sizeof *ways);
    int status = ways == NULL ? ranks_no_memory(world) : make_guesses(world);
    status = ranks_agree_on(&world->link, status);
    if (status == PCCD_OK) {
        status = find_ways(world, steps, ways);
    }
    for (uint32_t o = 0; o < objects && status == PCCD_OK; o++) {
        find_errors(world->objects[o], steps, ways + WAYS * (size_t)o);
    }
    if (status == PCCD_OK) {
        status = find_by_ways(world, x, ways, ways + WAYS * objects,
                              ways + (WAYS + 1) * objects);
    }
    if (status == PCCD_OK) {
        guess(world);
    }
    free(ways);
    return status;
}

/* Choose how much margin what moves gets from now on. */
void ranks_margins_choose(struct pccd_mpi *world, bool has_missed)
{
    bool was_early = world->lasts < UINT32_MAX && world->gone < world->lasts / 2;
    has_missed = has_missed && !was_early;
    if (has_missed && world->choice_work > DEAR_PART * world->right_work) {
        world->fast_steps = fmin(2 * world->fast_steps, FAST_STEPS_MAX);
    } else if (has_missed && world->choice_work < CHEAP_PART * world->right_work) {
        world->fast_steps = world->fast_steps / 2;
    }
    world->fast_steps = fmax(world->fast_steps, FAST_STEPS_MIN);
    double ghosts_work = world->ghost_part * world->right_work;
    if (has_missed && world->choice_work > MARGIN_DEAR * ghosts_work) {
        world->slow_margin = fmin(2 * world->slow_margin, MARGIN_MAX);
    } else if (has_missed && world->choice_work < MARGIN_CHEAP * ghosts_work) {
        world->slow_margin = world->slow_margin / 2;
    }
    world->slow_margin = fmax(world->slow_margin, MARGIN_MIN);
}

/* Learn what the choice took the rank that has most, and how many ghosts all have. */
int ranks_margins_learn(struct pccd_mpi *world)
{
    uint64_t leaves[2] = {0, 0}; /* own ones, ghosts */
    for (uint32_t o = 0; o < world->object_count; o++) {
        leaves[0] += world->objects[o]->own_count;
        leaves[1] += world->objects[o]->local.leaf_count - world->objects[o]->own_count;
    }
    world->choice_work = CHOICE_WORK * (double)(leaves[0] + leaves[1]);
    world->right_work = 0;
    int status = ranks_max_doubles(&world->link, &world->choice_work, 1);
    if (status == PCCD_OK) {
        status = ranks_sum(&world->link, leaves, 2);
    }
    world->ghost_part = leaves[0] > 0 ? (double)leaves[1] / (double)leaves[0] : 0;
    return status;
}

/* narrow_thick.c - which pairs have a distance to keep, and what it is. */
#include <assert.h>
#include <math.h>
#include <string.h>

#include "kinds.h"
#include "narrow.h"
#include "topology.h"

/* The features of a pair, as their objects have them. */
struct pair {
    const struct eng_object *object[2];
    const uint32_t *points; /* of either feature */
    uint32_t v[4];          /* vertices in the meshes, those of feature a first; unless no
                             * answer depends on them */
};

static bool asks_for_vertices(const struct eng_object *object)
{
    return eng_thickness_is_by_vertex(object) || object->thickness.rest_distance > 0 ||
           object->thickness.rest_rings > 0;
}

static struct pair pair_of(const struct eng_scene *scene, const struct eng_point *points,
                           const uint32_t quad[4], const uint32_t sides[2])
{
    struct pair pair = {{&scene->objects[points[quad[0]].word0 >> 32],
                         &scene->objects[points[quad[sides[0]]].word0 >> 32]},
                        sides,
                        {0}};
    if (asks_for_vertices(pair.object[0]) || asks_for_vertices(pair.object[1])) {
        for (int i = 0; i < 4; i++) {
            pair.v[i] = (uint32_t)points[quad[i]].word1;
        }
    }
    return pair;
}

/* Return whether few edges join the features. */
static bool is_within_rings(const struct pair *pair)
{
    const struct eng_object *object = pair->object[0];
    for (uint32_t i = 0; i < pair->points[0]; i++) {
        for (uint32_t k = 0; k < pair->points[1]; k++) {
            if (eng_rings_join(object->mesh, object->thickness.rest_rings, pair->v[i],
                               pair->v[pair->points[0] + k])) {
                return true;
            }
        }
    }
    return false;
}

/* Return whether an axis is enough to see that points are d apart or more. Differences
 * are rounded up to 2^-53 of themselves. */
static bool are_plainly_apart(const double x[4][3], uint32_t points_a, double d)
{
    const double sure = d * (1 + 4 * ENG_U);
    for (int k = 0; k < 3; k++) {
        double low[2] = {INFINITY, INFINITY};
        double high[2] = {-INFINITY, -INFINITY};
        for (uint32_t i = 0; i < 4; i++) {
            low[i >= points_a] = fmin(low[i >= points_a], x[i][k]);
            high[i >= points_a] = fmax(high[i >= points_a], x[i][k]);
        }
        if (low[0] - high[1] > sure || low[1] - high[0] > sure) {
            return true;
        }
    }
    return false;
}

/* Return whether the features are nearer to each other at rest than the object wants them
 * to be. */
static bool is_near_at_rest(struct eng_distances *distances, enum pccd_kind kind,
                            const struct pair *pair)
{
    const struct eng_object *object = pair->object[0];
    double d = object->thickness.rest_distance;
    double x[4][3];
    for (int i = 0; i < 4; i++) {
        memcpy(x[i], object->mesh->x[pair->v[i]], sizeof x[i]);
    }
    return !are_plainly_apart((const double(*)[3])x, pair->points[0], d) &&
           eng_distance_below(distances, kind, (const double(*)[3])x, d);
}

/* Return whether the pair is left thin for where it is at rest. */
static bool rests(struct eng_narrow_thick *work, enum pccd_kind kind,
                  const struct pair *pair)
{
    const struct eng_object_thickness *thickness = &pair->object[0]->thickness;
    return pair->object[0] == pair->object[1] &&
           ((thickness->rest_rings > 0 && is_within_rings(pair)) ||
            (thickness->rest_distance > 0 &&
             is_near_at_rest(&work->distances, kind, pair)));
}

/* The radii of a pair, or its clearance in the place of the first; whether it has a
 * distance, but for its rest. */
static bool measure(const struct eng_worker *worker, enum pccd_kind kind,
                    const struct eng_point *points, const uint32_t quad[4],
                    double radius[3])
{
    const uint32_t *sides = common_kinds[kind].points;
    radius[0] = radius[1] = 0;
    radius[2] = worker->scene->thickness.separation;
    if (eng_thickness_is_plain(worker->scene)) {
        return true;
    }
    double clearance =
        eng_thickness_clearance(worker->scene, (uint32_t)(points[quad[0]].word0 >> 32),
                                (uint32_t)(points[quad[sides[0]]].word0 >> 32));
    if (clearance >= 0) {
        radius[0] = clearance;
        return clearance + radius[2] > 0;
    }
    struct pair pair = pair_of(worker->scene, points, quad, sides);
    radius[0] = eng_thickness_radius(pair.object[0], pair.v, sides[0]);
    radius[1] = eng_thickness_radius(pair.object[1], pair.v + sides[0], sides[1]);
    return radius[0] > 0 || radius[1] > 0 || radius[2] > 0;
}

/* ---- candidates -------------------------------------------------------------------- */

/* Those that may come within r, to batch.left; others meet at no distance at all. */
static uint32_t leave_beyond(struct eng_worker *worker, const struct eng_pairs *pairs)
{
    struct eng_narrow *narrow = worker->narrow;
    double *reach = narrow->thick->lanes.reach;
    for (uint32_t i = 0; i < pairs->count; i++) {
        reach[i] = eng_thick_reach(pairs->radius[i]);
    }
    return worker->kernels->reject_thick(
        (struct eng_quads){pairs->kind, pairs->points, pairs->quads}, pairs->count, reach,
        narrow->batch.left);
}

/* Those stay that are not left thin for their rest. To find out takes longer than most
 * tests, so it is not asked of pairs that stay beyond r: thin or not, they do not meet.
 * But which are candidates in mode pairs depends on r. */
static void leave_resting(struct eng_worker *worker, struct eng_pairs *pairs)
{
    struct eng_narrow_thick *work = worker->narrow->thick;
    const uint32_t *sides = common_kinds[pairs->kind].points;
    bool is_all = worker->question->mode == PCCD_MODE_PAIRS;
    uint32_t left = is_all ? pairs->count : leave_beyond(worker, pairs);
    uint32_t kept = 0;
    for (uint32_t i = 0; i < left; i++) {
        uint32_t at = is_all ? i : worker->narrow->batch.left[i];
        struct pair pair = pair_of(worker->scene, pairs->points, pairs->quads[at], sides);
        if (rests(work, (enum pccd_kind)pairs->kind, &pair)) {
            work->is_thin[work->number[0][at]] = true;
            continue;
        }
        work->number[0][kept] = work->number[0][at];
        memmove(work->quads[0][kept], work->quads[0][at], sizeof work->quads[0][at]);
        memmove(work->radius[kept++], work->radius[at], sizeof work->radius[at]);
    }
    pairs->count = kept;
    pairs->known = ENG_KNOWN_SIEVED;
}

/* A pair goes to a part. */
static void put(struct eng_narrow_thick *work, const struct eng_pairs *pairs, uint32_t i,
                uint32_t which, struct eng_pairs *part)
{
    memcpy(work->quads[which][part->count], pairs->quads[i], sizeof pairs->quads[i]);
    work->number[which][part->count++] = i;
}

void eng_narrow_split(struct eng_worker *worker, const struct eng_pairs *pairs,
                      struct eng_pairs parts[2])
{
    struct eng_narrow_thick *work = worker->narrow->thick;
    assert(pairs->count <= ENG_CHUNK_MAX);
    for (uint32_t which = 0; which < 2; which++) {
        parts[which] = *pairs;
        parts[which].quads = (const uint32_t(*)[4])work->quads[which];
        parts[which].count = 0;
    }
    parts[0].radius = (const double(*)[3])work->radius;
    parts[1].known = ENG_KNOWN_BOXES;
    for (uint32_t i = 0; i < pairs->count; i++) {
        work->is_thin[i] = !measure(worker, (enum pccd_kind)pairs->kind, pairs->points,
                                    pairs->quads[i], work->radius[parts[0].count]);
        if (!work->is_thin[i]) {
            put(work, pairs, i, 0, &parts[0]);
        }
    }
    if (worker->scene->thickness.may_rest) {
        leave_resting(worker, &parts[0]);
    }
    for (uint32_t i = 0; i < pairs->count; i++) {
        if (work->is_thin[i]) {
            put(work, pairs, i, 1, &parts[1]);
        }
    }
    work->candidates += pairs->count - parts[1].count;
}

/* ---- what is near ------------------------------------------------------------------ */

/* Return whether the distance of a pair at the end that is asked for is at most the
 * sum. */
static bool is_within(struct eng_worker *worker, const struct eng_pairs *pairs,
                      uint32_t number, const double radius[3])
{
    struct eng_narrow_thick *work = worker->narrow->thick;
    const enum pccd_kind kind = (enum pccd_kind)pairs->kind;
    struct eng_thick_query query = {.query = {.kind = kind}};
    struct eng_hit hit;
    for (int i = 0; i < 4; i++) {
        const struct eng_point *point = &pairs->points[pairs->quads[number][i]];
        const double *x = worker->question->end == 0 ? point->x0 : point->x1;
        memcpy(query.query.x[0][i], x, sizeof query.query.x[0][i]);
        memcpy(query.query.x[1][i], x, sizeof query.query.x[1][i]);
    }
    if (radius[0] == 0 && radius[1] == 0) {
        return eng_distance_within(&work->distances, kind,
                                   (const double(*)[3])query.query.x[0], radius[2]);
    }
    memcpy(query.radius, radius, sizeof query.radius);
    return eng_thick_solve(&work->thick, &worker->exact, &query, 1, 1, &hit);
}

bool eng_narrow_is_within(struct eng_worker *worker, const struct eng_pairs *pairs,
                          uint32_t number, struct eng_distance *found)
{
    const struct eng_question *asked = worker->question;
    struct eng_narrow_thick *work = worker->narrow->thick;
    const enum pccd_kind kind = (enum pccd_kind)pairs->kind;
    const uint32_t *quad = pairs->quads[number];
    const uint32_t *sides = common_kinds[kind].points;
    struct pair pair = pair_of(worker->scene, pairs->points, quad, sides);
    bool is_bound = asked->verb == PCCD_NEAR_VERTICES;
    double radius[3] = {eng_thickness_radius(pair.object[0], pair.v, sides[0]),
                        eng_thickness_radius(pair.object[1], pair.v + sides[0], sides[1]),
                        asked->distance};
    if (found->lo > eng_thick_reach(radius)) {
        return false;
    }
    if (rests(work, kind, &pair)) {
        if (!is_bound) {
            return false;
        }
        radius[0] = radius[1] = 0;
    }
    double most = eng_thick_reach(radius);
    if (found->lo > most || (found->hi > most * (1 - 16 * ENG_U) &&
                             !is_within(worker, pairs, number, radius))) {
        return false;
    }
    if (is_bound) {
        found->lo =
            fmax(eng_difference_down(found->lo, eng_sum_up(radius[0], radius[1])), 0);
    }
    return true;
}

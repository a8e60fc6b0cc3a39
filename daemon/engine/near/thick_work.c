/* thick_work.c - pairs that meet at a distance. */
#include "thick_work.h"

#include <assert.h>
#include <math.h>
#include <string.h>

#include "finding.h"
#include "kinds.h"
#include "memory.h"
#include "rings.h"
#include "topology.h"

static bool should_stop(void *owner)
{
    return eng_worker_should_stop(owner);
}

int eng_thick_work_reserve(struct eng_worker *worker)
{
    if (worker->thick_work) {
        return PCCD_OK;
    }
    struct eng_thick_work *work = eng_alloc(1, sizeof *work);
    if (!work) {
        return PCCD_E_NOMEM;
    }
    int status = eng_thick_init(&work->thick);
    if (status == PCCD_OK) {
        status = eng_distances_init(&work->distances);
        if (status != PCCD_OK) {
            eng_thick_deinit(&work->thick);
        }
    }
    if (status != PCCD_OK) {
        eng_free(work);
        return status;
    }
    work->batch.should_stop = should_stop;
    work->batch.owner = worker;
    worker->thick_work = work;
    return PCCD_OK;
}

void eng_thick_work_free(struct eng_worker *worker)
{
    if (worker->thick_work) {
        eng_thick_deinit(&worker->thick_work->thick);
        eng_distances_deinit(&worker->thick_work->distances);
        eng_free(worker->thick_work);
        worker->thick_work = NULL;
    }
}

uint64_t eng_thick_work_bytes(const struct eng_worker *worker)
{
    return worker->thick_work ? sizeof *worker->thick_work + eng_thick_exact_bytes() +
                                    eng_numbers_bytes()
                              : 0;
}

void eng_thick_work_begin(struct eng_worker *worker)
{
    struct eng_thick_work *work = eng_thick_work_of(worker);
    work->candidates = 0;
    work->survivors = 0;
    work->batch.exact = 0;
}

/* ---- mode pairs -------------------------------------------------------------------- */

/* Of the exact sum of x[count], at most 8: is it above 0? By sums without rests that do
 * not overlap, the largest last (Shewchuk: Adaptive precision floating-point arithmetic,
 * 1997). */
static bool is_sum_above_0(const double *x, int count)
{
    double part[8];
    int parts = 0;
    for (int i = 0; i < count; i++) {
        double sum = x[i];
        for (int k = 0; k < parts; k++) {
            double rest = eng_rest_of_difference(sum, -part[k]);
            sum += part[k];
            part[k] = rest;
        }
        part[parts++] = sum;
    }
    while (parts > 0 && part[parts - 1] == 0) {
        parts--;
    }
    return parts > 0 && part[parts - 1] > 0;
}

/* Is `high` above `low` by more than r? */
static bool is_beyond(double high, double low, const double radius[3])
{
    const double terms[5] = {high, -low, -radius[0], -radius[1], -radius[2]};
    double r = radius[0] + radius[1] + radius[2];
    double more = (high - low) - r;
    double margin = 8 * ENG_U * (fabs(high) + fabs(low) + r);
    return fabs(more) > margin ? more > 0 : is_sum_above_0(terms, 5);
}

bool eng_thick_is_apart(const struct eng_point *const points[4], uint32_t points_a,
                        uint32_t points_b, const double radius[3])
{
    for (int k = 0; k < 3; k++) {
        double low[2][2] = {{INFINITY, INFINITY}, {INFINITY, INFINITY}}; /* side, end */
        double high[2][2] = {{-INFINITY, -INFINITY}, {-INFINITY, -INFINITY}};
        for (uint32_t i = 0; i < points_a + points_b; i++) {
            uint32_t side = i >= points_a;
            low[side][0] = fmin(low[side][0], points[i]->x0[k]);
            low[side][1] = fmin(low[side][1], points[i]->x1[k]);
            high[side][0] = fmax(high[side][0], points[i]->x0[k]);
            high[side][1] = fmax(high[side][1], points[i]->x1[k]);
        }
        for (int a = 0; a < 2; a++) {
            if (is_beyond(low[a][0], high[1 - a][0], radius) &&
                is_beyond(low[a][1], high[1 - a][1], radius)) {
                return true;
            }
        }
    }
    return false;
}

/* Those of the pairs taken that are not left out. */
static void keep_pairs(struct eng_worker *worker, enum pccd_kind kind,
                       const struct eng_point *points, uint32_t count, eng_names_fn names)
{
    const struct eng_thick_work *work = eng_thick_work_of(worker);
    const uint32_t *sides = common_kinds[kind].points;
    for (uint32_t i = 0; i < count; i++) {
        const uint32_t *quad = work->quads[i];
        const struct eng_point *const all[4] = {&points[quad[0]], &points[quad[1]],
                                                &points[quad[2]], &points[quad[3]]};
        if (!eng_thick_is_apart(all, sides[0], sides[1], work->radius[i])) {
            struct pccd_pair pair;
            names(worker, kind, &work->pair[i], 1, &pair);
            eng_found_add(&worker->found, &pair); /* a full list says so itself */
        }
    }
}

/* ---- contacts ---------------------------------------------------------------------- */

static void keep_contacts(struct eng_worker *worker, enum pccd_kind kind,
                          const struct eng_point *points, uint32_t count, bool is_sifted,
                          eng_names_fn names)
{
    struct eng_thick_work *work = eng_thick_work_of(worker);
    const struct eng_thick_question question = {.kind = kind,
                                                .is_sifted = is_sifted,
                                                .tolerance = worker->question->tolerance,
                                                .t_end = worker->time_bound,
                                                .approach = worker->question->approach};
    uint32_t hits = eng_thick_batch_test(
        worker->kernels, &question, points, (const uint32_t(*)[4])work->quads,
        (const double(*)[3])work->radius, count, &work->thick, &work->batch);
    worker->record.tests += count;
    work->survivors += work->batch.survivors;
    worker->tally.survivors += work->batch.survivors;
    for (uint32_t i = 0; i < hits && !eng_stop_is_set(worker->stop); i++) {
        struct pccd_pair pair;
        names(worker, kind, &work->pair[work->batch.index[i]], 1, &pair);
        eng_test_keep(worker, &pair, &work->batch.hits[i]);
    }
}

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

/* Do few edges join the features? */
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

/* Is an axis enough to see that points are d apart or more? Differences are rounded up to
 * 2^-53 of themselves. */
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

/* Are the features nearer to each other at rest than the object wants them to be? */
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

/* Is the pair left thin for where it is at rest? */
static bool rests(struct eng_thick_work *work, enum pccd_kind kind,
                  const struct pair *pair)
{
    const struct eng_object_thickness *thickness = &pair->object[0]->thickness;
    return pair->object[0] == pair->object[1] &&
           ((thickness->rest_rings > 0 && is_within_rings(pair)) ||
            (thickness->rest_distance > 0 &&
             is_near_at_rest(&work->distances, kind, pair)));
}

/* The radii of a pair; whether it has a distance, but for its rest. */
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
    struct pair pair = pair_of(worker->scene, points, quad, sides);
    radius[0] = eng_thickness_radius(pair.object[0], pair.v, sides[0]);
    radius[1] = eng_thickness_radius(pair.object[1], pair.v + sides[0], sides[1]);
    return radius[0] > 0 || radius[1] > 0 || radius[2] > 0;
}

/* ---- what is near ------------------------------------------------------------------ */

/* Is the distance of the pair at the end that is asked for at most the sum? */
static bool is_within(struct eng_thick_work *work, enum pccd_kind kind,
                      const struct eng_point *points, const uint32_t quad[4],
                      uint32_t end, const double radius[3], struct eng_exact *contacts)
{
    struct eng_thick_query query = {.query = {.kind = kind}};
    struct eng_hit hit;
    for (int i = 0; i < 4; i++) {
        const struct eng_point *point = &points[quad[i]];
        const double *x = end == 0 ? point->x0 : point->x1;
        memcpy(query.query.x[0][i], x, sizeof query.query.x[0][i]);
        memcpy(query.query.x[1][i], x, sizeof query.query.x[1][i]);
    }
    if (radius[0] == 0 && radius[1] == 0) {
        return eng_distance_within(&work->distances, kind,
                                   (const double(*)[3])query.query.x[0], radius[2]);
    }
    memcpy(query.radius, radius, sizeof query.radius);
    return eng_thick_solve(&work->thick, contacts, &query, 1, 1, &hit);
}

bool eng_thick_is_near(struct eng_worker *worker, enum pccd_kind kind,
                       const struct eng_point *points, const uint32_t quad[4],
                       struct eng_distance *found)
{
    const struct eng_question *asked = worker->question;
    struct eng_thick_work *work = eng_thick_work_of(worker);
    const uint32_t *sides = common_kinds[kind].points;
    struct pair pair = pair_of(worker->scene, points, quad, sides);
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
    if (found->lo > most ||
        (found->hi > most * (1 - 16 * ENG_U) &&
         !is_within(work, kind, points, quad, asked->end, radius, &worker->exact))) {
        return false;
    }
    if (is_bound) {
        found->lo =
            fmax(eng_difference_down(found->lo, eng_sum_up(radius[0], radius[1])), 0);
    }
    return true;
}

/* ---- candidates -------------------------------------------------------------------- */

/* Of the pairs taken: those that may come within r; others meet at no distance at all. */
static uint32_t leave_beyond(struct eng_worker *worker, enum pccd_kind kind,
                             const struct eng_point *points, uint32_t taken)
{
    struct eng_thick_work *work = eng_thick_work_of(worker);
    for (uint32_t i = 0; i < taken; i++) {
        work->reach[i] = eng_thick_reach((const double *)work->radius[i]);
    }
    return worker->kernels->reject_thick(common_kinds[kind].points[0], points,
                                         (const uint32_t(*)[4])work->quads, taken,
                                         work->reach, work->left);
}

/* Of the pairs taken those stay that are not left thin for their rest. To find out takes
 * longer than most tests, so it is not asked of pairs that stay beyond r: thin or not,
 * they do not meet. But which are candidates in mode pairs depends on r. */
static uint32_t leave_resting(struct eng_worker *worker, enum pccd_kind kind,
                              const struct eng_point *points, uint32_t taken)
{
    struct eng_thick_work *work = eng_thick_work_of(worker);
    bool is_all = worker->question->mode == PCCD_MODE_PAIRS;
    uint32_t left = is_all ? taken : leave_beyond(worker, kind, points, taken);
    uint32_t kept = 0;
    for (uint32_t i = 0; i < left; i++) {
        uint32_t at = is_all ? i : work->left[i];
        struct pair pair =
            pair_of(worker->scene, points, work->quads[at], common_kinds[kind].points);
        if (rests(work, kind, &pair)) {
            work->is_thin[work->pair[at]] = true;
            continue;
        }
        work->pair[kept] = work->pair[at];
        memmove(work->quads[kept], work->quads[at], sizeof work->quads[at]);
        memmove(work->radius[kept++], work->radius[at], sizeof work->radius[at]);
    }
    return kept;
}

uint32_t eng_thick_test(struct eng_worker *worker, enum pccd_kind kind,
                        const struct eng_point *points, const uint32_t (*quads)[4],
                        uint32_t count, bool is_sifted, eng_names_fn names)
{
    struct eng_thick_work *work = eng_thick_work_of(worker);
    uint32_t rest = 0;
    uint32_t taken = 0;
    assert(count <= ENG_CHUNK_MAX && worker->scene->thickness.is_on);
    for (uint32_t i = 0; i < count; i++) {
        const uint32_t *quad = quads[i];
        work->is_thin[i] = !measure(worker, kind, points, quad, work->radius[taken]);
        if (!work->is_thin[i]) {
            memcpy(work->quads[taken], quad, sizeof work->quads[taken]);
            work->pair[taken++] = i;
        }
    }
    if (worker->scene->thickness.may_rest) {
        taken = leave_resting(worker, kind, points, taken);
    }
    for (uint32_t i = 0; i < count; i++) {
        work->rest[rest] = i;
        rest += work->is_thin[i];
    }
    work->candidates += count - rest;
    if (worker->question->mode == PCCD_MODE_PAIRS) {
        keep_pairs(worker, kind, points, taken, names);
    } else if (taken > 0) {
        keep_contacts(worker, kind, points, taken, is_sifted, names);
    }
    return rest;
}

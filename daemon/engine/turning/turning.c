/* turning.c - two objects of which one turns: from candidates to records. */
#include "turning.h"

#include <assert.h>
#include <math.h>
#include <string.h>

#include "decide.h"
#include "kinds.h"
#include "memory.h"
#include "sweep.h"
#include "thickness.h"
#include "vec.h"

/* Tests of boxes of a task: some seconds. What needs more turns so often, or is so near
 * all the time, that it could not be decided, either. */
#define TESTS_MOST (1ull << 28)

/* Two objects turn little where one leaves its chords by no more than that part of a
 * triangle, about, and, but in mode all, goes no farther than that part of the smaller
 * one. */
#define WAY_PART 0.5
#define BOW_PART 0.25

/* A pair as its record names it. */
struct named {
    enum pccd_kind kind;
    const struct eng_turning_side *side[2];
    uint32_t v[2][3]; /* vertices of either feature, in the order of their mesh */
};

/* A pair of features that waits to be decided. */
struct waiting {
    struct eng_sweep_pair found;
    struct named named;
};

/* So many pairs are decided at once where what they find bounds what is asked. */
#define SOONER 8u

struct eng_turning {
    struct eng_turning_side side[2]; /* the first is what the second is seen from */
    struct eng_path path;            /* between them */
    struct eng_path place;           /* of the first in the world */
    struct eng_poses poses;
    struct eng_sweep sweep;
    struct eng_straight *straight;
    double chords[2][12]; /* poses of the second at both ends, if it goes by chords */
    bool by_chords;
    double separation;
    double clearance; /* in the place of the radii; negative: there is none */
    double delta;
    double period; /* what has not met by then never does; INFINITY: it does not repeat */
    struct eng_worker *worker; /* of the task that is performed, or divided */
    bool has_limit;            /* some pairs of the task took too many looks */
    bool only_proves;          /* what is possible is not recorded, and has_limit then */
    bool is_bounded;           /* what comes after the bound of mode first is left out */
    uint32_t looks;            /* at pairs, since should_stop was asked */
    uint32_t waiting_count;
    struct waiting waiting[ENG_TURNING_BATCH];
    struct eng_turning_pair pairs[ENG_TURNING_BATCH];
};

int eng_turning_make(struct eng_turning **turning)
{
    struct eng_turning *made = eng_alloc(1, sizeof *made);
    if (!made) {
        return PCCD_E_NOMEM;
    }
    int status = eng_sweep()->init(&made->sweep);
    if (status == PCCD_OK) {
        status = eng_straight()->make(&made->straight);
    }
    if (status != PCCD_OK) {
        eng_sweep()->deinit(&made->sweep);
        eng_free(made);
        return status;
    }
    made->looks = 0;
    *turning = made;
    return PCCD_OK;
}

void eng_turning_free(struct eng_turning *turning)
{
    if (turning) {
        eng_sweep()->deinit(&turning->sweep);
        eng_straight()->free(turning->straight);
        eng_free(turning);
    }
}

uint64_t eng_turning_bytes(const struct eng_turning *turning)
{
    return turning ? sizeof *turning + eng_sweep()->bytes(&turning->sweep) +
                         eng_straight()->bytes(turning->straight)
                   : 0;
}

/* ---- two objects ------------------------------------------------------------------- */

/* An object that does not turn stands, as far as the path goes; of two that do the one
 * with the lower id. */
static void order_sides(struct eng_turning *turning,
                        const struct eng_turning_objects *objects)
{
    const struct eng_turning_side *side = objects->side;
    bool turns[2] = {side[0].joint != PCCD_NO_JOINT, side[1].joint != PCCD_NO_JOINT};
    assert(turns[0] || turns[1]);
    uint32_t first =
        turns[0] == turns[1] ? side[0].object->id > side[1].object->id : turns[0];
    turning->side[0] = side[first];
    turning->side[1] = side[1 - first];
}

static double size_of(const struct eng_path_box *box)
{
    double size = 0;
    for (int k = 0; k < 3; k++) {
        size = eng_most(size, eng_most(fabs(box->lo[k]), fabs(box->hi[k])));
    }
    return size;
}

static double extent_of(const struct eng_path_box *box)
{
    return eng_most(eng_most(box->hi[0] - box->lo[0], box->hi[1] - box->lo[1]),
                    box->hi[2] - box->lo[2]);
}

static double delta_of(struct eng_turning *turning, double resolution)
{
    const struct eng_path_box *box[2] = {&turning->side[0].body->box,
                                         &turning->side[1].body->box};
    const struct eng_path_pose *pose = eng_poses_at(&turning->poses, 0);
    double size = size_of(box[1]);
    const double from[3] = {pose->m[3], pose->m[7], pose->m[11]};
    double far = eng_size(from) + 2 * size + eng_path_speed(&turning->path, box[1], 0, 1);
    double least = eng_turning_delta_least(eng_most(size_of(box[0]), far),
                                           pose->error[0] + pose->error[1] * size);
    if (resolution == 0) {
        resolution =
            ENG_TURNING_RESOLUTION * eng_most(extent_of(box[0]), extent_of(box[1]));
    }
    return eng_most(resolution, least);
}

/* Least double above two pi. */
#define TURN 0x1.921fb54442d19p+2

/* Return the time after which the two have been wherever they ever are beside each other:
 * one turn, where one joint alone moves them, and the first stands. It is rounded up. */
static double period_of(const struct eng_turning *turning)
{
    const struct eng_path *path = &turning->path;
    const struct eng_body *body = turning->side[0].body;
    return path->count == 1 && path->joints[0].kind == PCCD_JOINT_TURN &&
                   body->boxes[0] == body->boxes[1]
               ? TURN / fabs(path->joints[0].by[0]) * (1 + 0x1p-40)
               : INFINITY;
}

static bool take(void *owner, const struct eng_sweep_pair *found);

/* By so much more than the tolerance a contact may begin after its toi: for rounding. */
#define BEGINS_LATER 0x1p-48

/* Who begins to meet later is not wanted. */
static double end_of(const struct eng_turning *turning)
{
    double bound = turning->is_bounded ? turning->worker->time_bound : INFINITY;
    return eng_least(bound, turning->period);
}

/* Leave out what may come near after the end. A record is kept for its toi, and by then
 * its features need not have come near: they do so within the tolerance. So no record
 * that is kept in the end depends on how soon the bound was known. */
static void take_bound(struct eng_turning *turning)
{
    const double later = turning->worker->question->tolerance + BEGINS_LATER;
    turning->sweep.t_end = end_of(turning) + later;
    turning->sweep.t_last = turning->period + later;
}

static bool should_stop(void *owner)
{
    struct eng_turning *turning = owner;
    bool stops = eng_worker_should_stop(turning->worker);
    take_bound(turning);
    return stops;
}

static double bow_of(const struct eng_path *path, const struct eng_mesh *mesh)
{
    double middle[1][3];
    eng_mesh_middle(mesh, middle[0]);
    return eng_path_bend_of(path, (const double(*)[3])middle, 1, mesh->radius) / 8;
}

struct eng_turning_bend eng_turning_bend_of(const struct eng_path *path,
                                            const struct eng_mesh *mesh)
{
    struct eng_path_box box;
    memcpy(box.lo, mesh->bounds.low, sizeof box.lo);
    memcpy(box.hi, mesh->bounds.high, sizeof box.hi);
    return (struct eng_turning_bend){bow_of(path, mesh),
                                     eng_path_speed(path, &box, 0, 1)};
}

bool eng_turning_bends_little(const struct eng_turning_bend *bend, bool finds_all,
                              const struct eng_mesh *a, const struct eng_mesh *b)
{
    const struct eng_mesh *const meshes[2] = {a, b};
    bool is_little = true;
    for (int i = 0; i < 2; i++) {
        const double size = eng_bounds_size(&meshes[i]->bounds);
        is_little &= (finds_all || bend->way <= WAY_PART * size) &&
                     bend->bow <= BOW_PART * size / sqrt(meshes[i]->leaf_count);
    }
    return is_little;
}

/* Begin to go by chords, if that is wanted. */
static void begin_chords(struct eng_turning *turning,
                         const struct eng_turning_objects *objects)
{
    struct eng_turning_side side[2] = {turning->side[0], turning->side[1]};
    const struct eng_mesh *mesh = side[1].object->mesh;
    turning->by_chords = objects->way != ENG_TURNING_BY_SPANS;
    if (!turning->by_chords) {
        return;
    }
    if (objects->way == ENG_TURNING_BY_BEND) {
        const struct eng_turning_bend bend = eng_turning_bend_of(&turning->path, mesh);
        turning->by_chords = eng_turning_bends_little(&bend, objects->finds_all,
                                                      side[0].object->mesh, mesh);
    }
    double error = 0;
    for (int end = 0; end < 2; end++) {
        const struct eng_path_pose *pose = eng_poses_at(&turning->poses, end);
        memcpy(turning->chords[end], pose->m, sizeof pose->m);
        error = eng_most(error,
                         pose->error[0] + pose->error[1] * size_of(&side[1].body->box));
    }
    if (turning->by_chords) {
        side[1].poses = (const double(*)[12])turning->chords;
        const struct eng_straight_chords chords = {
            .reach = (turning->sweep.keep + bow_of(&turning->path, mesh) + 2 * error) *
                     (1 + 0x1p-40),
            .take = take,
            .owner = turning};
        eng_straight()->begin(turning->straight, side, &chords);
    }
}

int eng_turning_begin(struct eng_turning *turning,
                      const struct eng_turning_objects *objects)
{
    order_sides(turning, objects);
    const struct eng_turning_side *side = turning->side;
    int status =
        eng_path_between(objects->joints, side[0].joint, side[1].joint, &turning->path);
    if (status == PCCD_OK && side[0].joint != PCCD_NO_JOINT) {
        status = eng_path_between(objects->joints, PCCD_NO_JOINT, side[0].joint,
                                  &turning->place);
    }
    if (status != PCCD_OK) {
        return status;
    }
    eng_poses_begin(&turning->poses, &turning->path);
    turning->separation = objects->separation;
    turning->clearance = objects->clearance;
    turning->only_proves = false;
    turning->delta = delta_of(turning, objects->resolution);
    turning->period = period_of(turning);
    double radii = objects->clearance >= 0 ? objects->clearance
                                           : eng_thickness_most(side[0].object) +
                                                 eng_thickness_most(side[1].object);
    radii += objects->separation;
    struct eng_sweep *sweep = &turning->sweep;
    sweep->body[0] = side[0].body;
    sweep->body[1] = side[1].body;
    sweep->poses = &turning->poses;
    sweep->keep = (radii + 4 * turning->delta) * (1 + 0x1p-40);
    sweep->fineness = turning->delta;
    sweep->wants_free = radii > 0;
    sweep->tests_most = objects->tests_most > 0 ? objects->tests_most : TESTS_MOST;
    sweep->take = take;
    sweep->should_stop = should_stop;
    sweep->owner = turning;
    begin_chords(turning, objects);
    if (!turning->by_chords) {
        eng_sweep()->begin(sweep);
    }
    return PCCD_OK;
}

/* ---- a pair of features ------------------------------------------------------------ */

static void name_feature(const struct eng_sweep_pair *found, int i, uint32_t points,
                         const struct eng_mesh *mesh, uint32_t v[3])
{
    const struct eng_face *leaf = &mesh->leaves[found->leaf[i]];
    uint32_t place = found->place[i];
    for (uint32_t k = 0; k < points; k++) {
        v[k] = leaf->v[(place + k) % 3];
    }
    if (points == 2 && v[0] > v[1]) {
        v[0] = leaf->v[(place + 1) % 3];
        v[1] = leaf->v[place];
    }
}

static struct named name(const struct eng_turning *turning,
                         const struct eng_sweep_pair *found)
{
    const uint32_t *points = common_kinds[found->kind].points;
    struct named named = {.kind = found->kind};
    bool is_turned =
        points[0] == points[1] && turning->side[found->side_a].object->id >
                                      turning->side[1 - found->side_a].object->id;
    for (uint32_t i = 0; i < 2; i++) {
        const struct eng_turning_side *side =
            &turning->side[i == 0 ? found->side_a : 1 - found->side_a];
        uint32_t at = is_turned ? 1 - i : i;
        named.side[at] = side;
        name_feature(found, (int)i, points[i], side->body->mesh, named.v[at]);
    }
    return named;
}

static uint32_t feature_of(const struct eng_turning *turning,
                           const struct eng_sweep_pair *found, const struct named *named,
                           int i)
{
    uint32_t points = common_kinds[named->kind].points[i];
    uint32_t from =
        named->side[0] == &turning->side[found->side_a] ? (uint32_t)i : 1 - (uint32_t)i;
    return points == 1 ? named->v[i][0]
           : points == 2
               ? eng_mesh_edge(named->side[i]->body->mesh, named->v[i][0], named->v[i][1])
               : found->leaf[from];
}

/* Return whether somebody else looks for the pair (mesh.h). */
static bool is_foreign(const struct eng_turning *turning,
                       const struct eng_sweep_pair *found, const struct named *named)
{
    const struct eng_mesh *mesh = named->side[0]->body->mesh;
    uint32_t points = common_kinds[named->kind].points[0];
    return eng_mesh_has_foreign(mesh) &&
           eng_mesh_is_foreign(mesh, (enum pccd_tree)(points - 1),
                               feature_of(turning, found, named, 0));
}

static void make_query(const struct eng_turning *turning,
                       const struct eng_sweep_pair *found, const struct named *named,
                       struct eng_turning_pair *pair)
{
    uint32_t count = 0;
    pair->kind = named->kind;
    pair->turning = named->side[0] == &turning->side[1] ? 0 : 1;
    for (uint32_t i = 0; i < 2; i++) {
        const struct eng_turning_side *side = named->side[i];
        uint32_t points = common_kinds[named->kind].points[i];
        for (uint32_t k = 0; k < points; k++, count++) {
            for (int end = 0; end < 2; end++) {
                memcpy(pair->x[end][count], side->body->x[end][named->v[i][k]],
                       sizeof pair->x[end][count]);
            }
        }
        pair->radius[i] = eng_thickness_radius(side->object, named->v[i], points);
    }
    for (; count < 4; count++) {
        memcpy(pair->x[0][count], pair->x[0][count - 1], sizeof pair->x[0][count]);
        memcpy(pair->x[1][count], pair->x[1][count - 1], sizeof pair->x[1][count]);
    }
    if (turning->clearance >= 0) {
        pair->radius[0] = turning->clearance;
        pair->radius[1] = 0;
    }
    pair->radius[2] = turning->separation;
    pair->from = found->span[0];
    pair->to = found->span[1];
}

/* Turn the normal as the first side lies in the world. */
static void turn_normal(const struct eng_turning *turning, struct eng_hit *hit)
{
    if (turning->side[0].joint == PCCD_NO_JOINT) {
        return;
    }
    struct eng_path_pose pose;
    eng_path_pose(&turning->place, hit->toi, &pose);
    const double n[3] = {(double)hit->normal[0], (double)hit->normal[1],
                         (double)hit->normal[2]};
    for (size_t k = 0; k < 3; k++) {
        hit->normal[k] = (float)eng_dot(pose.m + 4 * k, n);
    }
}

static void record(struct eng_turning *turning, const struct waiting *waiting,
                   struct eng_hit *hit)
{
    const struct eng_sweep_pair *found = &waiting->found;
    const struct named *named = &waiting->named;
    struct pccd_pair words = {.kind = named->kind,
                              .object_a = named->side[0]->object->id,
                              .feature_a = feature_of(turning, found, named, 0),
                              .object_b = named->side[1]->object->id,
                              .feature_b = feature_of(turning, found, named, 1)};
    turn_normal(turning, hit);
    eng_record_contact(turning->worker, &words, hit);
}

/* Decide the pairs that wait. Return whether to go on. */
static bool decide(struct eng_turning *turning)
{
    struct eng_worker *worker = turning->worker;
    const uint32_t count = turning->waiting_count;
    const uint64_t looks = turning->sweep.tests_most;
    const struct eng_turning_limits limits = {.delta = turning->delta,
                                              .tolerance = worker->question->tolerance,
                                              .approach = worker->question->approach,
                                              .t_end = end_of(turning),
                                              .looks_max = looks < ENG_TURNING_LOOKS_MAX
                                                               ? (uint32_t)looks
                                                               : ENG_TURNING_LOOKS_MAX,
                                              .should_stop = should_stop,
                                              .owner = turning};
    struct eng_turning_answer answers[ENG_TURNING_BATCH];
    turning->waiting_count = 0;
    eng_turning_decide_all(&turning->poses, turning->pairs, count, &limits, answers);
    for (uint32_t i = 0; i < count; i++) {
        struct eng_turning_answer *answer = &answers[i];
        switch (answer->verdict) {
        case ENG_TURNING_FREE:
            break;
        case ENG_TURNING_MEETS:
            if (turning->only_proves && !(answer->hit.flags & PCCD_PROVED)) {
                turning->has_limit = true;
                break;
            }
            record(turning, &turning->waiting[i], &answer->hit);
            break;
        case ENG_TURNING_LIMIT:
            turning->has_limit = true;
            break;
        case ENG_TURNING_STOPPED: /* then the worker is to stop, too */
            break;
        }
        turning->looks += answer->looks;
    }
    take_bound(turning);
    if (turning->looks >= ENG_TURNING_LOOKS_BETWEEN) { /* of pairs that took fewer each */
        turning->looks = 0;
        (void)should_stop(turning);
    }
    return !eng_stop_is_set(worker->stop);
}

static bool take(void *owner, const struct eng_sweep_pair *found)
{
    struct eng_turning *turning = owner;
    struct eng_worker *worker = turning->worker;
    struct eng_turning_pair *pair = &turning->pairs[turning->waiting_count];
    struct waiting *waiting = &turning->waiting[turning->waiting_count];
    waiting->found = *found;
    waiting->named = name(turning, found);
    if (is_foreign(turning, found, &waiting->named)) {
        return true;
    }
    make_query(turning, found, &waiting->named, pair);
    if (pair->radius[0] + pair->radius[1] + pair->radius[2] == 0 &&
        found->kind != PCCD_VF && found->kind != PCCD_EE) {
        return true;
    }
    eng_count_candidates(worker, found->kind, 1);
    worker->record.tests++;
    turning->waiting_count++;
    /* What has met bounds what is wanted of the rest, but in mode all. */
    const uint32_t most =
        worker->question->mode == PCCD_MODE_ALL ? ENG_TURNING_BATCH : SOONER;
    return turning->waiting_count < most || decide(turning);
}

/* ---- tasks ------------------------------------------------------------------------- */

int eng_turning_split(struct eng_turning *turning, struct eng_worker *worker,
                      uint32_t most, uint64_t *tasks, uint32_t *count)
{
    turning->worker = worker;
    turning->is_bounded = false; /* the tasks are the same whatever has been found */
    take_bound(turning);
    if (turning->by_chords) {
        *count = eng_straight()->split(turning->straight, worker, most, tasks);
        return PCCD_OK;
    }
    *count = eng_sweep()->split(&turning->sweep, most, tasks);
    return turning->sweep.status;
}

static void count(struct eng_turning *turning)
{
    struct eng_worker *worker = turning->worker;
    worker->record.box_tests += turning->sweep.box_tests;
    worker->tally.leaf_pairs += turning->sweep.leaf_tests;
}

int eng_turning_perform(struct eng_turning *turning, struct eng_worker *worker,
                        uint64_t task)
{
    struct eng_sweep *sweep = &turning->sweep;
    turning->worker = worker;
    turning->has_limit = false;
    turning->waiting_count = 0;
    turning->is_bounded = true;
    take_bound(turning);
    if (turning->by_chords) {
        eng_straight()->perform(turning->straight, worker, task);
        (void)decide(turning);
        return turning->has_limit ? PCCD_E_LIMIT : PCCD_OK;
    }
    int status = eng_sweep()->run(sweep, task);
    (void)decide(turning);
    count(turning);
    return status == PCCD_OK && turning->has_limit ? PCCD_E_LIMIT : status;
}

bool eng_turning_try(struct eng_turning *turning, struct eng_worker *worker,
                     uint64_t tests)
{
    struct eng_sweep *sweep = &turning->sweep;
    assert(!turning->by_chords);
    turning->worker = worker;
    turning->has_limit = false;
    turning->waiting_count = 0;
    turning->only_proves = true;
    turning->is_bounded = true;
    take_bound(turning);
    const uint64_t tests_most = sweep->tests_most;
    sweep->tests_most = tests;
    int status = eng_sweep()->run(sweep, ENG_TURNING_ALL);
    (void)decide(turning);
    sweep->tests_most = tests_most;
    turning->only_proves = false;
    count(turning);
    return status == PCCD_OK && !turning->has_limit;
}

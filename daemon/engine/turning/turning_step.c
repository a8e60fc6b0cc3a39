/* turning_step.c - pairs of objects of which one turns, and who tests them. */
#include "turning_step.h"

#include <assert.h>
#include <math.h>
#include <string.h>

#include "coordinates.h"
#include "memory.h"
#include "rigid.h"
#include "straight.h"
#include "thickness.h"
#include "vec.h"
#include "wait.h"

/* Above what rounds off in a box of a few sums. */
#define ROUNDING 0x1p-44

/* More than what is lost below the normal range, of numbers of at most 1e18. */
#define LOST 0x1p-400

/* Parts of the step, at most, of which each has its box. */
#define SPANS_MAX 64u

/* Tests that each couple gets in mode any before one of them gets more. */
#define TRIES 2u
static const uint64_t tests_of_try[TRIES] = {1u << 8, 1u << 12};

/* Objects that do not turn, and pairs of objects, between two looks at the clock: some
 * 50 us. One that turns may take longer alone: a chain of many joints does. */
#define OBJECTS_PER_LOOK 32u
#define PAIRS_PER_LOOK   4096u

/* From so many couples on they are taken as they were found: to sort them takes longer
 * than may pass between two looks, and there are enough for every thread. */
#define SORTED_MOST 16384u

/* ---- memory ------------------------------------------------------------------------ */

void eng_turning_step_deinit(struct eng_turning_step *step)
{
    for (uint32_t i = 0; i < step->part_capacity; i++) {
        eng_body_deinit(&step->parts[i].body);
    }
    eng_free(step->parts);
    eng_free(step->items);
    eng_free(step->keys);
    eng_free(step->joining);
    eng_free(step->couples);
    eng_free(step->tasks);
    memset(step, 0, sizeof *step);
}

uint64_t eng_turning_step_bytes(const struct eng_turning_step *step)
{
    uint64_t bytes =
        (uint64_t)step->part_capacity * sizeof *step->parts +
        (uint64_t)step->item_capacity * (sizeof *step->items + sizeof *step->joining) +
        (uint64_t)step->key_capacity * 2 * sizeof *step->keys +
        (uint64_t)step->couple_capacity * sizeof *step->couples +
        (uint64_t)step->task_capacity * sizeof *step->tasks;
    for (uint32_t i = 0; i < step->part_capacity; i++) {
        bytes += eng_body_bytes(&step->parts[i].body);
    }
    return bytes;
}

static int reserve_keys(struct eng_turning_step *step, uint32_t count)
{
    if (count <= step->key_capacity) {
        return PCCD_OK;
    }
    uint32_t capacity = eng_array_grown(step->key_capacity, count);
    int status = eng_array_grow(&step->keys, 2 * capacity, sizeof *step->keys);
    step->key_capacity = status == PCCD_OK ? capacity : step->key_capacity;
    return status;
}

int eng_turning_step_prepare(struct eng_turning_step *step, const struct eng_scene *scene,
                             bool turns, bool may_be_by_poses,
                             struct eng_worker *const *workers, uint32_t count)
{
    uint32_t capacity = scene->object_capacity;
    int status = PCCD_OK;
    step->scene = scene;
    step->turns = turns;
    step->workers = workers;
    step->worker_count = count;
    if (step->part_capacity < capacity) {
        status = eng_array_grow(&step->parts, capacity, sizeof *step->parts);
        if (status == PCCD_OK) {
            memset(step->parts + step->part_capacity, 0,
                   (capacity - step->part_capacity) * sizeof *step->parts);
            step->part_capacity = capacity;
        }
    }
    if (status == PCCD_OK && step->item_capacity < capacity) {
        status = eng_array_grow(&step->items, capacity, sizeof *step->items);
        if (status == PCCD_OK) {
            status = eng_array_grow(&step->joining, capacity, sizeof *step->joining);
        }
        step->item_capacity = status == PCCD_OK ? capacity : step->item_capacity;
    }
    if (status == PCCD_OK) {
        status = reserve_keys(step, capacity);
    }
    for (uint32_t i = 0; i < count && status == PCCD_OK; i++) {
        if (may_be_by_poses && !workers[i]->straight) {
            status = eng_straight()->make(&workers[i]->straight);
        }
        if (status == PCCD_OK && turns && !workers[i]->turning) {
            status = eng_turning_make(&workers[i]->turning);
        }
    }
    return status;
}

/* ---- where objects are in the step ------------------------------------------------- */

static void widen(struct eng_bounds *box, double by)
{
    for (int k = 0; k < 3; k++) {
        double error = ROUNDING * (fabs(box->low[k]) + fabs(box->high[k]) + by);
        box->low[k] -= by + error;
        box->high[k] += by + error;
    }
}

/* The box of a box under a pose, but for rounding. */
static struct eng_bounds place(const double m[12], const struct eng_bounds *box)
{
    struct eng_bounds placed;
    for (int k = 0; k < 3; k++) {
        const double *row = m + 4 * k;
        double middle = row[3];
        double half = 0;
        for (int i = 0; i < 3; i++) {
            middle += row[i] * (0.5 * box->low[i] + 0.5 * box->high[i]);
            half += fabs(row[i]) * (0.5 * box->high[i] - 0.5 * box->low[i]);
        }
        placed.low[k] = middle - half;
        placed.high[k] = middle + half;
    }
    return placed;
}

static double largest_of(const struct eng_bounds *box)
{
    double largest = 0;
    for (int k = 0; k < 3; k++) {
        largest = fmax(largest, fmax(fabs(box->low[k]), fabs(box->high[k])));
    }
    return largest;
}

/* Set boxes around all that an object sweeps as it turns: around its places at some
 * times, wider by how far it leaves the chords between them. */
static void set_turning(struct eng_turning_step *step, const struct eng_object *object,
                        struct eng_turning_item *item)
{
    const struct eng_mesh *mesh = object->mesh;
    const struct eng_bounds *bounds = &mesh->bounds;
    struct eng_bounds all = ENG_NO_BOUNDS;
    struct eng_path_box box;
    double middle[1][3];
    memcpy(box.lo, bounds->low, sizeof box.lo);
    memcpy(box.hi, bounds->high, sizeof box.hi);
    eng_mesh_middle(mesh, middle[0]);
    int status = eng_path_between(step->scene->joints.items, PCCD_NO_JOINT, object->joint,
                                  &step->path);
    assert(status == PCCD_OK); /* as it was when it was staged */
    (void)status;
    step->parts[item->object].bend = eng_turning_bend_of(&step->path, mesh);
    double sagitta = eng_path_bend(&step->path, &box, 0, 1) / 8;
    double enough = 0.25 * eng_bounds_size(bounds);
    double error = 0;
    uint32_t spans = 1;
    for (; spans < SPANS_MAX && sagitta > enough; spans *= 2) {
        sagitta /= 4;
    }
    for (uint32_t i = 0; i <= spans; i++) {
        struct eng_path_pose pose;
        eng_path_pose(&step->path, (double)i / spans, &pose);
        struct eng_bounds placed = place(pose.m, bounds);
        eng_bounds_unite(&all, &placed);
        error = fmax(error, pose.error[0] + pose.error[1] * largest_of(bounds));
        if (i == 0 || i == spans) {
            common_transform(pose.m, middle[0], item->sphere.middle[i == 0 ? 0 : 1]);
        }
    }
    double rounding = ROUNDING * (largest_of(bounds) + largest_of(&all));
    widen(&all, sagitta + error + rounding);
    item->box = all;
    item->sphere.radius =
        mesh->radius +
        eng_path_bend_of(&step->path, (const double(*)[3])middle, 1, 0) / 8 + error +
        rounding;
}

/* Return at least how much longer than it was a pose makes a vector: the square of that
 * is no eigenvalue of m' m, and so no sum of a row of it. */
static double stretch_of(const double m[12])
{
    double most = 0;
    for (int i = 0; i < 3; i++) {
        double sum = 0;
        for (int k = 0; k < 3; k++) {
            sum += fabs(m[i] * m[k] + m[4 + i] * m[4 + k] + m[8 + i] * m[8 + k]);
        }
        most = fmax(most, sum);
    }
    return sqrt(most);
}

/* Set boxes around an object that goes straight, or stands. */
static void set_straight(const struct eng_object *object, unsigned now,
                         struct eng_turning_item *item)
{
    const struct eng_mesh *mesh = object->mesh;
    item->box = object->bounds[0];
    eng_bounds_unite(&item->box, &object->bounds[1]);
    item->sphere.radius = 0;
    for (unsigned end = 0; end < 2; end++) {
        double *middle = item->sphere.middle[end];
        double radius = 0;
        if (object->has_poses) {
            const double *m = object->poses->last[end];
            double point[3];
            eng_mesh_middle(mesh, point);
            common_transform(m, point, middle);
            radius = stretch_of(m) * mesh->radius +
                     2 * eng_rounding_error(m, &mesh->bounds);
        } else {
            const struct eng_bounds *bounds = &object->bounds[end == 0 ? 1 - now : now];
            double half[3];
            for (int k = 0; k < 3; k++) {
                middle[k] = 0.5 * bounds->low[k] + 0.5 * bounds->high[k];
                half[k] = 0.5 * bounds->high[k] - 0.5 * bounds->low[k];
            }
            radius = sqrt(eng_dot(half, half)) + ROUNDING * largest_of(&item->box);
        }
        item->sphere.radius = fmax(item->sphere.radius, radius);
    }
}

static void set_around(struct eng_turning_step *step, const struct eng_object *object,
                       struct eng_turning_item *item)
{
    double reach = 0.5 * step->separation +
                   fmax(eng_thickness_most(object), object->half_clearance);
    if (object->joint != PCCD_NO_JOINT) {
        set_turning(step, object, item);
    } else {
        set_straight(object, step->scene->now, item);
    }
    widen(&item->box, reach);
    item->sphere.radius = (item->sphere.radius + reach) * (1 + ROUNDING) + LOST;
}

static bool is_apart(const struct eng_bounds *a, const struct eng_bounds *b)
{
    for (int k = 0; k < 3; k++) {
        if (a->low[k] > b->high[k] || b->low[k] > a->high[k]) {
            return true;
        }
    }
    return false;
}

/* Return whether two spheres stay apart: along where one is from the other when they are
 * nearest, at both ends. */
static bool are_spheres_apart(const struct eng_turning_sphere *a,
                            const struct eng_turning_sphere *b)
{
    double from[2][3];
    double way[3];
    double n[3];
    double gap = INFINITY;
    eng_sub(from[0], a->middle[0], b->middle[0]);
    eng_sub(from[1], a->middle[1], b->middle[1]);
    eng_sub(way, from[1], from[0]);
    double square = eng_dot(way, way);
    double t = square > 0 ? -eng_dot(from[0], way) / square : 0;
    t = eng_least(eng_most(t, 0), 1);
    for (int k = 0; k < 3; k++) {
        n[k] = from[0][k] + t * way[k];
    }
    for (int end = 0; end < 2; end++) {
        double terms = 0;
        for (int k = 0; k < 3; k++) {
            terms += fabs(n[k] * from[end][k]);
        }
        gap = eng_least(gap, eng_dot(n, from[end]) - ROUNDING * terms);
    }
    double reach = (a->radius + b->radius) * sqrt(eng_dot(n, n));
    return gap > reach * (1 + ROUNDING) + LOST;
}

/* ---- which pairs of objects may meet ----------------------------------------------- */

/* A number of the same order as a double's. */
static uint64_t key_of(double x)
{
    uint64_t bits;
    double number = x + 0.0; /* no -0 */
    memcpy(&bits, &number, sizeof bits);
    return bits >> 63 ? ~bits : bits | 1ull << 63;
}

/* Return whether it is one of those that the step is about. */
static bool is_sought(const struct eng_turning_step *step,
                      const struct eng_object *object)
{
    return object->joint != PCCD_NO_JOINT ||
           (step->by_poses && object->moves != ENG_STANDS);
}

/* Return whether neither of two objects turns. */
static bool are_straight(const struct eng_turning_step *step, uint32_t a, uint32_t b)
{
    const struct eng_object *objects = step->scene->objects;
    return objects[a].joint == PCCD_NO_JOINT && objects[b].joint == PCCD_NO_JOINT;
}

/* List the objects that the step is about, then those that come near any of these. */
static void list_items(struct eng_turning_step *step, struct eng_worker *worker)
{
    const struct eng_scene *scene = step->scene;
    struct eng_bounds all = ENG_NO_BOUNDS;
    step->item_count = 0;
    for (int sought = 1; sought >= 0; sought--) {
        for (uint32_t i = 0; i < scene->object_capacity; i++) {
            const struct eng_object *object = &scene->objects[i];
            step->parts[i].takes_part = false;
            step->parts[i].wants_fit = false;
            if (!object->mesh || is_sought(step, object) != (sought == 1) ||
                object->bounds[0].low[0] > object->bounds[0].high[0]) {
                continue;
            }
            if ((sought == 1 || i % OBJECTS_PER_LOOK == 0) &&
                eng_worker_should_stop(worker)) {
                return;
            }
            struct eng_turning_item *item = &step->items[step->item_count];
            item->object = i;
            set_around(step, object, item);
            item->is_sought = sought == 1;
            if (sought == 1) {
                eng_bounds_unite(&all, &item->box);
            }
            step->item_count += sought == 1 || !is_apart(&all, &item->box);
        }
    }
}

/* The axis along which the least of them lie one behind another. */
static int axis_of(const struct eng_turning_step *step)
{
    int best = 0;
    double most = -1;
    for (int k = 0; k < 3; k++) {
        double low = INFINITY;
        double high = -INFINITY;
        double sum = 0;
        for (uint32_t i = 0; i < step->item_count; i++) {
            const struct eng_bounds *box = &step->items[i].box;
            low = fmin(low, box->low[k]);
            high = fmax(high, box->high[k]);
            sum += box->high[k] - box->low[k];
        }
        double spread = sum > 0 ? (high - low) / sum : 0;
        best = spread > most ? k : best;
        most = fmax(spread, most);
    }
    return best;
}

/* Return whether boxes of an object that goes straight are those of its mesh, where its
 * poses take them. */
static bool goes_by_poses(const struct eng_turning_step *step,
                          const struct eng_object *object)
{
    return step->by_poses && object->has_poses && object->joint == PCCD_NO_JOINT;
}

/* Return the way to find what meets of two objects, one of which turns. Of what has poses
 * boxes are fitted before the two begin, if it is by spans. */
static enum eng_turning_way way_of(const struct eng_turning_step *step, uint32_t a,
                                   uint32_t b)
{
    const struct eng_scene *scene = step->scene;
    const struct eng_object *const objects[2] = {&scene->objects[a], &scene->objects[b]};
    const struct eng_turning_bend *bend = NULL;
    uint32_t turning = 0;
    bool can = step->mode != PCCD_MODE_ANY && step->tests_most == 0 &&
               step->separation == 0 && !(eng_thickness_clearance(scene, a, b) > 0);
    for (int i = 0; i < 2; i++) {
        const struct eng_object *object = objects[i];
        can &= eng_thickness_most(object) == 0;
        if (object->joint != PCCD_NO_JOINT) {
            bend = &step->parts[i == 0 ? a : b].bend;
            turning++;
        }
    }
    return !can                                ? ENG_TURNING_BY_SPANS
           : step->is_test && (a + b) % 2 != 0 ? ENG_TURNING_BY_CHORDS
           : turning == 2                      ? ENG_TURNING_BY_BEND
           : eng_turning_bends_little(bend, step->mode == PCCD_MODE_ALL,
                                      objects[0]->mesh, objects[1]->mesh)
               ? ENG_TURNING_BY_CHORDS
               : ENG_TURNING_BY_SPANS;
}

static void join(struct eng_turning_step *step, uint32_t object)
{
    if (!step->parts[object].takes_part) {
        step->parts[object].takes_part = true;
        step->joining[step->joining_count++] = object;
    }
}

static uint64_t size_of(const struct eng_turning_step *step,
                        const struct eng_turning_couple *couple)
{
    const struct eng_object *objects = step->scene->objects;
    return (uint64_t)objects[couple->a].mesh->leaf_count +
           objects[couple->b].mesh->leaf_count;
}

/* Two objects may meet. Without memory for more the answer is not complete. */
static void add_couple(struct eng_turning_step *step, uint32_t a, uint32_t b)
{
    if (step->has_failed ||
        eng_array_extend(&step->couples, &step->couple_capacity, step->couple_count + 1,
                         sizeof *step->couples) != PCCD_OK) {
        step->has_failed = true;
        return;
    }
    step->couples[step->couple_count++] = (struct eng_turning_couple){.a = a, .b = b};
    join(step, a);
    join(step, b);
    if (!are_straight(step, a, b) && way_of(step, a, b) == ENG_TURNING_BY_SPANS) {
        step->parts[a].wants_fit = step->parts[b].wants_fit = true;
    }
}

/* By where they begin along the axis: each with those that begin before it ends. */
static void list_couples(struct eng_turning_step *step, struct eng_worker *worker)
{
    int axis = axis_of(step);
    uint32_t looked = PAIRS_PER_LOOK; /* pairs since the clock was */
    for (uint32_t i = 0; i < step->item_count; i++) {
        step->keys[i] = (struct eng_radix_key){key_of(step->items[i].box.low[axis]), i};
    }
    const struct eng_radix_key *keys =
        eng_radix_sort(step->keys, step->keys + step->key_capacity, step->item_count);
    for (uint32_t i = 0; i < step->item_count; i++) {
        const struct eng_turning_item *item = &step->items[keys[i].index];
        for (uint32_t j = i + 1; j < step->item_count; j++) {
            if (looked++ == PAIRS_PER_LOOK) {
                looked = 0;
                if (eng_worker_should_stop(worker)) {
                    return;
                }
            }
            const struct eng_turning_item *other = &step->items[keys[j].index];
            if (other->box.low[axis] > item->box.high[axis]) {
                break;
            }
            if ((item->is_sought || other->is_sought) &&
                !is_apart(&item->box, &other->box) &&
                !are_spheres_apart(&item->sphere, &other->sphere) &&
                eng_masks_allows(&step->scene->masks, item->object, other->object)) {
                add_couple(step, item->object, other->object);
            }
        }
    }
}

/* Bring large ones to the front: they are divided. */
static void choose_divided(struct eng_turning_step *step)
{
    uint64_t total[2] = {0, 0}; /* of those that turn, and of others */
    for (uint32_t i = 0; i < step->couple_count; i++) {
        const struct eng_turning_couple *couple = &step->couples[i];
        total[are_straight(step, couple->a, couple->b)] += size_of(step, couple);
    }
    for (uint32_t i = 0; i < step->couple_count; i++) {
        const struct eng_turning_couple couple = step->couples[i];
        uint64_t all = total[are_straight(step, couple.a, couple.b)];
        uint64_t size = size_of(step, &couple);
        if (size >= ENG_TURNING_LARGE && size * ENG_TURNING_SHARES >= all) {
            step->couples[i] = step->couples[step->divided_count];
            step->couples[step->divided_count++] = couple;
        }
    }
}

/* Large ones first, so that no thread ends with one while others have nothing to do. */
static void sort_couples(struct eng_turning_step *step)
{
    uint32_t count = step->couple_count;
    if (count > SORTED_MOST || reserve_keys(step, count) != PCCD_OK) {
        return; /* as they are: those that are divided come first */
    }
    for (uint32_t i = 0; i < count; i++) {
        const struct eng_turning_couple *couple = &step->couples[i];
        step->keys[i] = (struct eng_radix_key){UINT64_MAX - size_of(step, couple),
                                               (uint64_t)couple->a << 32 | couple->b};
    }
    const struct eng_radix_key *keys =
        eng_radix_sort(step->keys, step->keys + step->key_capacity, count);
    for (uint32_t i = 0; i < count; i++) {
        step->couples[i] = (struct eng_turning_couple){
            .a = (uint32_t)(keys[i].index >> 32), .b = (uint32_t)keys[i].index};
    }
}

void eng_turning_step_begin(struct eng_turning_step *step, bool by_poses,
                            struct eng_worker *worker, uint32_t threads)
{
    const struct eng_question *question = worker->question;
    step->by_poses = by_poses;
    step->separation = question->distance;
    step->resolution = question->resolution;
    step->tests_most = question->turning_tests;
    step->is_test = question->team_always;
    step->mode = question->mode;
    step->couple_count = 0;
    step->divided_count = 0;
    step->joining_count = 0;
    step->has_failed = false;
    step->is_alone = threads == 1;
    atomic_init(&step->next_body, 0);
    atomic_init(&step->next_try, 0);
    atomic_init(&step->next_couple, 0);
    atomic_init(&step->next_task, 0);
    atomic_init(&step->rest, ENG_REST_IS_FREE);
    list_items(step, worker);
    list_couples(step, worker);
    choose_divided(step);
    if (eng_array_fit(&step->tasks, &step->task_capacity,
                      step->divided_count * ENG_TURNING_TASKS,
                      sizeof *step->tasks) != PCCD_OK) {
        step->divided_count = 0;
        step->has_failed = true;
    }
    sort_couples(step);
}

/* ---- by all threads ---------------------------------------------------------------- */

static uint32_t take(atomic_uint *next)
{
    return atomic_fetch_add_explicit(next, 1, memory_order_relaxed);
}

/* Some pairs are not known; without memory no more is tried. */
static void fail(struct eng_worker *worker, int status)
{
    if (status == PCCD_E_LIMIT) {
        eng_worker_lack(worker, PCCD_INCOMPLETE_UNDECIDED);
    } else {
        eng_worker_stop(worker, PCCD_INCOMPLETE_UNDECIDED);
    }
}

static const double (*positions_of(const struct eng_scene *scene,
                                   const struct eng_object *object, unsigned end))[3]
{
    const double(*x)[3] =
        (const double(*)[3])scene->x[end == 0 ? 1 - scene->now : scene->now];
    return x + object->vertices.first;
}

static bool should_stop(void *owner)
{
    return eng_worker_should_stop(owner);
}

/* Have the tree of a mesh, which one thread makes. PCCD_E_AGAIN: the step is to stop, and
 * a later one goes on. */
static int make_tree(struct eng_worker *worker, struct eng_mesh *mesh)
{
    struct eng_wait wait;
    int status = eng_body_tree_prepare(mesh, should_stop, worker);
    if (status == PCCD_E_AGAIN && !eng_worker_should_stop(worker)) {
        eng_wait_begin(&wait, worker);
        while (status == PCCD_E_AGAIN && !eng_worker_should_stop(worker)) {
            eng_wait_moment(&wait);
            status = eng_body_tree_prepare(mesh, should_stop, worker);
        }
        eng_wait_end(&wait);
    }
    return status;
}

/* The boxes of an object: of one that stands those of a step before, if there are. */
static int make_body(struct eng_turning_step *step, struct eng_worker *worker,
                     uint32_t idx)
{
    const struct eng_scene *scene = step->scene;
    const struct eng_object *object = &scene->objects[idx];
    struct eng_turning_part *part = &step->parts[idx];
    struct eng_body *body = &part->body;
    int status = make_tree(worker, object->mesh);
    if (status != PCCD_OK) {
        return status;
    }
    if (object->joint != PCCD_NO_JOINT) {
        eng_body_set(body, object->mesh);
        part->fitted = 0;
        return PCCD_OK;
    }
    if (part->fitted > object->moved_number && body->mesh == object->mesh) {
        body->x[0] = positions_of(scene, object, 0); /* they change places */
        body->x[1] = positions_of(scene, object, 1);
        return PCCD_OK;
    }
    bool stands = object->moved_number < scene->moving.number;
    const double(*x1)[3] = positions_of(scene, object, 1);
    const double(*x0)[3] = stands ? x1 : positions_of(scene, object, 0);
    struct eng_bounds bounds = object->bounds[0];
    eng_bounds_unite(&bounds, &object->bounds[1]);
    if (goes_by_poses(step, object) && !part->wants_fit) {
        eng_body_put(body, object->mesh, x0, x1, &bounds);
        part->fitted = 0;
        return PCCD_OK;
    }
    body->may_lack_lowest = !stands && !part->wants_fit;
    body->should_stop = should_stop;
    body->owner = worker;
    status = eng_body_fit(body, object->mesh, x0, x1, &bounds);
    part->fitted = status == PCCD_OK && stands ? scene->moving.number : 0;
    return status;
}

static void make_bodies(struct eng_turning_step *step, struct eng_worker *worker)
{
    for (uint32_t i = take(&step->next_body);
         i < step->joining_count && !eng_worker_should_stop(worker);
         i = take(&step->next_body)) {
        int status = make_body(step, worker, step->joining[i]);
        if (status != PCCD_OK && status != PCCD_E_AGAIN) {
            fail(worker, status);
        }
    }
}

static int begin_couple(struct eng_turning_step *step, struct eng_worker *worker,
                        const struct eng_turning_couple *couple)
{
    const uint32_t objects[2] = {couple->a, couple->b};
    struct eng_turning_objects both = {
        .joints = step->scene->joints.items,
        .separation = step->separation,
        .clearance = eng_thickness_clearance(step->scene, couple->a, couple->b),
        .resolution = step->resolution,
        .tests_most = step->tests_most,
        .finds_all = step->mode == PCCD_MODE_ALL};
    const bool is_straight = are_straight(step, couple->a, couple->b);
    for (int side = 0; side < 2; side++) {
        const struct eng_object *object = &step->scene->objects[objects[side]];
        both.side[side] = (struct eng_turning_side){
            .object = object,
            .body = &step->parts[objects[side]].body,
            .joint = object->joint,
            .poses = goes_by_poses(step, object)
                         ? (const double(*)[12])object->poses->last
                         : NULL};
    }
    if (is_straight) {
        eng_straight()->begin(worker->straight, both.side, NULL);
        return PCCD_OK;
    }
    both.way = way_of(step, couple->a, couple->b);
    return eng_turning_begin(worker->turning, &both);
}

/* Divide large couples, so that there is something for every thread. */
static void divide(struct eng_turning_step *step, struct eng_worker *worker)
{
    for (uint32_t i = take(&step->next_couple);
         i < step->divided_count && !eng_worker_should_stop(worker);
         i = take(&step->next_couple)) {
        struct eng_turning_couple *couple = &step->couples[i];
        uint64_t *tasks = step->tasks + i * ENG_TURNING_TASKS;
        int status = begin_couple(step, worker, couple);
        if (are_straight(step, couple->a, couple->b)) {
            couple->task_count =
                eng_straight()->split(worker->straight, worker, ENG_TURNING_TASKS, tasks);
        } else if (status == PCCD_OK) {
            status = eng_turning_split(worker->turning, worker, ENG_TURNING_TASKS, tasks,
                                       &couple->task_count);
        }
        if (status != PCCD_OK) {
            fail(worker, status);
        }
    }
}

/* Give each couple a few tests, then more: what is proved soon ends the step. */
static void try_couples(struct eng_turning_step *step, struct eng_worker *worker)
{
    for (uint32_t i = take(&step->next_try);
         i < step->couple_count * TRIES && !eng_worker_should_stop(worker);
         i = take(&step->next_try)) {
        struct eng_turning_couple *couple = &step->couples[i % step->couple_count];
        if (!atomic_load_explicit(&couple->is_known, memory_order_relaxed) &&
            begin_couple(step, worker, couple) == PCCD_OK &&
            eng_turning_try(worker->turning, worker,
                            tests_of_try[i / step->couple_count])) {
            atomic_store_explicit(&couple->is_known, true, memory_order_relaxed);
        }
    }
}

/* Perform a task of a couple that has begun. In mode first a limit may be one that is not
 * met where the earliest time is known (repeat_limited). */
static void perform_task(const struct eng_turning_step *step, struct eng_worker *worker,
                         struct eng_turning_couple *couple, uint64_t task)
{
    if (are_straight(step, couple->a, couple->b)) {
        eng_straight()->perform(worker->straight, worker, task);
        return;
    }
    int status = eng_turning_perform(worker->turning, worker, task);
    if (status == PCCD_E_LIMIT && worker->question->mode == PCCD_MODE_FIRST) {
        atomic_store_explicit(&couple->is_limited, true, memory_order_relaxed);
    } else if (status != PCCD_OK) {
        fail(worker, status);
    }
}

/* Do what no thread has taken yet, couple by couple. */
static void perform_tasks(struct eng_turning_step *step, struct eng_worker *worker)
{
    const uint32_t divided = step->divided_count;
    const uint32_t parts = divided * ENG_TURNING_TASKS; /* the rest are whole */
    uint32_t begun = UINT32_MAX;
    int status = PCCD_OK;
    for (uint32_t i = take(&step->next_task);
         i < parts + (step->couple_count - divided) && !eng_worker_should_stop(worker);
         i = take(&step->next_task)) {
        uint32_t number = i < parts ? i / ENG_TURNING_TASKS : divided + (i - parts);
        struct eng_turning_couple *couple = &step->couples[number];
        if ((i < parts && i % ENG_TURNING_TASKS >= couple->task_count) ||
            atomic_load_explicit(&couple->is_known, memory_order_relaxed)) {
            continue;
        }
        uint64_t begin_ns = eng_worker_slice(worker);
        if (number != begun) {
            status = begin_couple(step, worker, couple);
            begun = number;
        }
        if (status == PCCD_OK) {
            perform_task(step, worker, couple,
                         i < parts ? step->tasks[i] : ENG_TURNING_ALL);
        } else {
            fail(worker, status);
        }
        worker->record.task_units++;
        eng_worker_trace(worker, PCCD_TRACE_UNIT, begin_ns, couple->a, couple->b);
    }
}

/* Mode first: leave out of the answer what is known of a couple, which begins anew. */
static void forget(struct eng_turning_step *step, const struct eng_turning_couple *couple)
{
    const uint64_t a = step->scene->objects[couple->a].id;
    const uint64_t b = step->scene->objects[couple->b].id;
    for (uint32_t i = 0; i < step->worker_count; i++) {
        struct eng_block *block = step->workers[i]->found.first;
        for (; block; block = block->next) {
            struct pccd_contact *contacts = (void *)block->data;
            for (uint32_t k = 0; k < block->count; k++) {
                struct pccd_contact *one = &contacts[k];
                if ((one->object_a == a && one->object_b == b) ||
                    (one->object_a == b && one->object_b == a)) {
                    one->toi = INFINITY; /* later than any bound */
                }
            }
        }
    }
}

/* Do a couple again that met a limit. */
static void repeat(struct eng_turning_step *step, struct eng_worker *worker,
                   struct eng_turning_couple *couple)
{
    const uint64_t number = (uint64_t)(couple - step->couples);
    const bool is_divided = number < step->divided_count;
    const uint64_t whole = ENG_TURNING_ALL;
    const uint64_t *tasks =
        is_divided ? step->tasks + number * ENG_TURNING_TASKS : &whole;
    const uint32_t count = is_divided ? couple->task_count : 1;
    atomic_store_explicit(&couple->is_limited, false, memory_order_relaxed);
    forget(step, couple);
    if (begin_couple(step, worker, couple) == PCCD_OK) { /* as it was before */
        for (uint32_t i = 0; i < count && !eng_worker_should_stop(worker); i++) {
            perform_task(step, worker, couple, tasks[i]);
        }
    }
}

/* Mode first: do couples that met a limit again with the bound that all threads have
 * found, until those that still meet one have begun with the last bound. Then neither the
 * answer nor whether it is complete depends on what threads knew when:
 *
 * A task with a smaller bound does a part of what it does with a larger one, in the same
 * order. So it meets no limit that the other one does not, and finds all of that one's
 * contacts that the smaller bound wants, also where both meet a limit. Let two runs of a
 * step end with bounds s < l. Where the bound of the first one fell below l, a task found
 * a contact with a bound of l or more. With the bound l it finds that contact, too. In
 * the second run it was done last with l, or it met no limit with a larger bound: so this
 * run found the contact, and did not end with l. As the bounds are the same, so are the
 * last tasks of each couple. */
static void repeat_limited(struct eng_turning_step *step, struct eng_worker *worker)
{
    double bound = INFINITY;
    bool is_limited = true;
    while (is_limited && bound > eng_stop_time_bound(worker->stop) &&
           !eng_worker_should_stop(worker)) {
        bound = eng_stop_time_bound(worker->stop);
        is_limited = false;
        for (uint32_t i = 0; i < step->couple_count; i++) {
            struct eng_turning_couple *couple = &step->couples[i];
            if (atomic_load_explicit(&couple->is_limited, memory_order_relaxed)) {
                repeat(step, worker, couple);
                is_limited |=
                    atomic_load_explicit(&couple->is_limited, memory_order_relaxed);
            }
        }
    }
    if (is_limited) {
        fail(worker, PCCD_E_LIMIT);
    }
}

/* Note what is known of all other pairs: before any pair of these is tested. */
static void note_rest(struct eng_turning_step *step, const struct eng_worker *worker)
{
    int mine = worker->proved_seen > 0 ? ENG_REST_MEETS
               : worker->possible_seen > 0 || eng_stop_is_set(worker->stop)
                   ? ENG_REST_IS_OPEN
                   : ENG_REST_IS_FREE;
    int rest = atomic_load_explicit(&step->rest, memory_order_relaxed);
    while (mine > rest && !atomic_compare_exchange_weak_explicit(&step->rest, &rest, mine,
                                                                 memory_order_relaxed,
                                                                 memory_order_relaxed)) {
    }
}

void eng_turning_step_perform(struct eng_turning_step *step, struct eng_worker *worker)
{
    uint64_t begin_ns = common_now_ns();
    uint64_t waited_ns = worker->record.wait_ns;
    if (step->turns) {
        note_rest(step, worker);
    }
    if (step->has_failed) {
        fail(worker, PCCD_E_NOMEM);
    }
    make_bodies(step, worker);
    if (!step->is_alone) {
        eng_wait_for_all(worker);
    }
    if (worker->question->mode == PCCD_MODE_ANY && step->turns) {
        try_couples(step, worker);
    }
    if (step->divided_count > 0) {
        divide(step, worker);
        if (!step->is_alone) {
            eng_wait_for_all(worker);
        }
    }
    perform_tasks(step, worker);
    if (step->by_poses) {
        eng_straight()->end(worker->straight, worker);
    }
    if (step->turns && worker->question->mode == PCCD_MODE_FIRST) {
        if (!step->is_alone) {
            eng_wait_for_all(worker);
        }
        if (worker->thread == 0) {
            repeat_limited(step, worker);
        }
    }
    worker->record.low_ns +=
        common_now_ns() - begin_ns - (worker->record.wait_ns - waited_ns);
}

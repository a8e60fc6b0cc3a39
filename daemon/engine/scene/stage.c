/* stage.c - the positions of a step, one copy from foreign memory.
 *
 * End positions go straight into the buffer that becomes t = 1; the buffer that holds the
 * current positions is not touched before commit, so an aborted step leaves a trace only
 * in where the last one began. Given start positions wait in a third buffer for the
 * commit.
 */
#include "world.h"

#include <assert.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "clock.h"
#include "coordinates.h"
#include "ingest.h"
#include "joints.h"
#include "kernel.h"
#include "memory.h"
#include "moving.h"
#include "question.h"
#include "rigid.h"

void eng_stage_begin(struct eng_scene *scene)
{
    assert(!scene->staging);
    scene->staging = true;
    scene->is_trial = false;
    scene->stage++;
    scene->stage_ns = 0;
    scene->copiers = (struct eng_copiers){1, NULL};
    scene->write_count = 0;
    scene->staged_joints.count = 0;
}

void eng_stage_validate(struct eng_scene *scene)
{
    uint64_t stage = scene->stage;
    eng_stage_begin(scene);
    scene->stage = stage;
    scene->is_trial = true;
}

void eng_stage_share(struct eng_scene *scene, uint32_t threads,
                     const struct eng_affinity *affinity)
{
    scene->copiers = (struct eng_copiers){
        threads < ENG_THREADS_MAX ? threads : ENG_THREADS_MAX, affinity};
}

/* Where the last step began is lost for what was written to: it stands where it is, so
 * that boxes of what does not move stay true. */
static void mend(struct eng_scene *scene, struct eng_object *object)
{
    uint32_t first = object->vertices.first;
    memcpy(scene->x[1 - scene->now] + first, scene->x[scene->now] + first,
           object->vertices.count * sizeof *scene->x[0]);
    object->bounds[1 - scene->now] = object->bounds[scene->now];
}

void eng_stage_abort(struct eng_scene *scene)
{
    bool has_written = scene->staging && !scene->is_trial;
    for (uint32_t i = 0; has_written && i < scene->write_count; i++) {
        mend(scene, &scene->objects[scene->writes[i].object]);
        scene->has_lost_start = true;
    }
    scene->staging = false;
    scene->write_count = 0;
}

static int remember(struct eng_scene *scene, struct eng_write write)
{
    if (scene->write_count == scene->write_capacity) {
        uint32_t capacity = scene->write_capacity ? scene->write_capacity * 2 : 16;
        struct eng_write *writes = eng_realloc(scene->writes, capacity, sizeof *writes);
        if (!writes) {
            return PCCD_E_NOMEM;
        }
        scene->writes = writes;
        scene->write_capacity = capacity;
    }
    scene->writes[scene->write_count++] = write;
    return PCCD_OK;
}

/* Where end positions go. */
static double (*ends_of_staging(const struct eng_scene *scene))[3]
{
    return scene->is_trial ? scene->start : scene->x[1 - scene->now];
}

/* The write that was opened last. */
static struct eng_write *last_write(const struct eng_scene *scene)
{
    return &scene->writes[scene->write_count - 1];
}

static int reserve_start(struct eng_scene *scene)
{
    if (scene->start_capacity >= scene->vertex_capacity) {
        return PCCD_OK;
    }
    double(*start)[3] = eng_alloc(scene->vertex_capacity, sizeof *start);
    if (!start) {
        return PCCD_E_NOMEM;
    }
    /* Vertices are only added between steps: nothing of this step waits in the
     * old one. */
    eng_free(scene->start);
    scene->start = start;
    scene->start_capacity = scene->vertex_capacity;
    return PCCD_OK;
}

/* Check a write, note it, and on the first partial write of this step give the rest of
 * the object its current positions as end positions. */
static int open_write(struct eng_scene *scene, uint32_t object_idx, uint32_t first,
                      uint32_t count, bool has_start)
{
    struct eng_object *object = eng_scene_object(scene, object_idx);
    if (!scene->staging || !object || count == 0 || first > object->vertices.count ||
        count > object->vertices.count - first) {
        return PCCD_E_INVAL;
    }
    int status =
        remember(scene, (struct eng_write){.object = object_idx,
                                           .first = first,
                                           .count = count,
                                           .has_start = has_start,
                                           .bounds = {ENG_NO_BOUNDS, ENG_NO_BOUNDS},
                                           .rounding_reach = {INFINITY, INFINITY},
                                           .joint = PCCD_NO_JOINT});
    if (status == PCCD_OK && (has_start || scene->is_trial)) {
        status = reserve_start(scene);
    }
    if (status != PCCD_OK || scene->is_trial) {
        return status;
    }
    bool whole = count == object->vertices.count;
    if (object->staged != scene->stage && !whole && !object->ends_are_equal) {
        eng_moving_catch_up(scene, object);
    }
    object->staged = scene->stage;
    object->is_previous_overwritten = true;
    object->ends_are_equal = false;
    return PCCD_OK;
}

int eng_stage_x1(struct eng_scene *scene, uint32_t object_idx, enum pccd_format format,
                 uint32_t first, uint32_t count, const void *x1)
{
    uint64_t begin_ns = common_now_ns();
    int status = open_write(scene, object_idx, first, count, false);
    if (status == PCCD_OK) {
        uint32_t v = scene->objects[object_idx].vertices.first + first;
        status = eng_ingest_by_team(ends_of_staging(scene) + v, format, count, x1,
                                    scene->copiers, &last_write(scene)->bounds[1]);
    }
    scene->stage_ns += common_now_ns() - begin_ns;
    return status;
}

int eng_stage_x0x1(struct eng_scene *scene, uint32_t object_idx, enum pccd_format format,
                   uint32_t first, uint32_t count, const void *x0, const void *x1)
{
    uint64_t begin_ns = common_now_ns();
    int status = open_write(scene, object_idx, first, count, true);
    if (status == PCCD_OK) {
        uint32_t v = scene->objects[object_idx].vertices.first + first;
        struct eng_write *write = last_write(scene);
        status = eng_ingest_by_team(scene->start + v, format, count, x0, scene->copiers,
                                    &write->bounds[0]);
        if (status == PCCD_OK) {
            status = eng_ingest_by_team(ends_of_staging(scene) + v, format, count, x1,
                                        scene->copiers, &write->bounds[1]);
        }
    }
    scene->stage_ns += common_now_ns() - begin_ns;
    return status;
}

int eng_stage_map(struct eng_scene *scene, uint32_t object_idx, double (**x0)[3],
                  double (**x1)[3])
{
    struct eng_object *object = eng_scene_object(scene, object_idx);
    assert(!scene->staging);
    if (!object) {
        return PCCD_E_INVAL;
    }
    int status = x0 ? reserve_start(scene) : PCCD_OK;
    if (status != PCCD_OK) {
        return status;
    }
    object->is_previous_overwritten = scene->has_lost_start = true;
    object->ends_are_equal = false;
    *x1 = scene->x[1 - scene->now] + object->vertices.first;
    if (x0) {
        *x0 = scene->start + object->vertices.first;
    }
    return PCCD_OK;
}

/* Positions that are in their place already are checked alone. */
int eng_stage_mapped(struct eng_scene *scene, uint32_t object_idx, bool has_start)
{
    const struct eng_object *object = eng_scene_object(scene, object_idx);
    uint32_t count = object ? object->vertices.count : 0;
    uint64_t begin_ns = common_now_ns();
    int status = open_write(scene, object_idx, 0, count, has_start);
    if (status == PCCD_OK) {
        double(*x0)[3] = scene->start + object->vertices.first;
        double(*x1)[3] = ends_of_staging(scene) + object->vertices.first;
        struct eng_write *write = last_write(scene);
        if (has_start) {
            status = eng_ingest_by_team(x0, PCCD_FORMAT_F64, count, x0, scene->copiers,
                                        &write->bounds[0]);
        }
        if (status == PCCD_OK) {
            status = eng_ingest_by_team(x1, PCCD_FORMAT_F64, count, x1, scene->copiers,
                                        &write->bounds[1]);
        }
    }
    scene->stage_ns += common_now_ns() - begin_ns;
    return status;
}

void eng_stage_unmap(struct eng_scene *scene, uint32_t object_idx)
{
    struct eng_object *object = eng_scene_object(scene, object_idx);
    if (object && !(scene->staging && scene->is_trial)) {
        mend(scene, object);
        scene->has_lost_start = true;
    }
}

/* out = R x + t, checked against the coordinate range like any other input: by the bounds
 * alone, which see all, since no sum of products of numbers up to 1e18 can be a NaN. */
static int transform(double (*restrict out)[3], const double (*restrict x)[3],
                     uint32_t count, const double m[12], struct eng_bounds *bounds)
{
    double own[12]; /* in registers: what is written to `out` cannot change it */
    memcpy(own, m, sizeof own);
    for (uint32_t i = 0; i < count; i++) {
        common_transform(own, x[i], out[i]);
    }
    eng_kernels()->bound_positions((const double(*)[3])out, count, bounds);
    bool bad = false;
    for (int k = 0; k < 3; k++) {
        bad |= !(bounds->low[k] >= -PROTO_COORDINATE_MAX &&
                 bounds->high[k] <= PROTO_COORDINATE_MAX);
    }
    return bad ? PCCD_E_NOTFINITE : PCCD_OK;
}

/* Note the poses of a write that is of a whole object; without memory nobody needs to
 * know them (bodies.h). */
static void remember_poses(struct eng_scene *scene, struct eng_write *write,
                           const double m0[12], const double m1[12])
{
    struct eng_object *object = &scene->objects[write->object];
    if (!object->poses && !scene->is_trial) {
        object->poses = eng_alloc(1, sizeof *object->poses);
    }
    if (object->poses && !scene->is_trial) {
        memcpy(object->poses->staged[0], m0, sizeof object->poses->staged[0]);
        memcpy(object->poses->staged[1], m1, sizeof object->poses->staged[1]);
        write->has_poses = true;
    }
}

/* The vertices of a write are where two transforms take the registered ones. */
static int place(struct eng_scene *scene, struct eng_write *write, const double m0[12],
                 const double m1[12])
{
    const struct eng_object *object = &scene->objects[write->object];
    const double(*rest)[3] = (const double(*)[3])object->mesh->x + write->first;
    uint32_t v = object->vertices.first + write->first;
    int status = transform(scene->start + v, rest, write->count, m0, &write->bounds[0]);
    if (status == PCCD_OK) {
        status = transform(ends_of_staging(scene) + v, rest, write->count, m1,
                           &write->bounds[1]);
    }
    if (status == PCCD_OK && write->count == object->vertices.count) {
        write->rounding_reach[0] = eng_rounding_reach(m0, m1, &object->mesh->bounds);
        write->rounding_reach[1] = eng_rounding_reach(m1, m1, &object->mesh->bounds);
        remember_poses(scene, write, m0, m1);
    }
    return status;
}

int eng_stage_rigid(struct eng_scene *scene, uint32_t object_idx, uint32_t first,
                    uint32_t count, const void *m0, const void *m1)
{
    uint64_t begin_ns = common_now_ns();
    double matrix0[12];
    double matrix1[12];
    int status = open_write(scene, object_idx, first, count, true);
    if (status == PCCD_OK) {
        status = eng_ingest_transform(matrix0, m0);
    }
    if (status == PCCD_OK) {
        status = eng_ingest_transform(matrix1, m1);
    }
    if (status == PCCD_OK) {
        status = place(scene, last_write(scene), matrix0, matrix1);
    }
    scene->stage_ns += common_now_ns() - begin_ns;
    return status;
}

/* Return whether a transform certainly takes a whole mesh to where coordinates may be:
 * half of the limit leaves room for every rounding. */
static bool stays_within(const double m[12], const struct eng_mesh *mesh)
{
    bool stays = mesh->info.isolated_count == 0; /* bounds do not count those */
    for (int k = 0; k < 3; k++) {
        double most = fabs(m[4 * k + 3]);
        for (int i = 0; i < 3; i++) {
            most += fabs(m[4 * k + i]) *
                    fmax(fabs(mesh->bounds.low[i]), fabs(mesh->bounds.high[i]));
        }
        stays = stays && most <= 0.5 * PROTO_COORDINATE_MAX;
    }
    return stays;
}

int eng_stage_on_joint(struct eng_scene *scene, uint32_t object_idx, uint32_t joint)
{
    uint64_t begin_ns = common_now_ns();
    const struct eng_object *object = eng_scene_object(scene, object_idx);
    double ends[2][12];
    int status =
        open_write(scene, object_idx, 0, object ? object->vertices.count : 0, true);
    for (uint32_t end = 0; end < 2 && status == PCCD_OK; end++) {
        common_joint_transform(scene->staged_joints.items, joint, end, ends[end]);
        status = eng_ingest_transform(ends[end], ends[end]);
    }
    if (status == PCCD_OK) {
        struct eng_write *write = last_write(scene);
        write->joint = joint;
        write->waits =
            stays_within(ends[0], object->mesh) && stays_within(ends[1], object->mesh);
        status = write->waits ? PCCD_OK : place(scene, write, ends[0], ends[1]);
    }
    scene->stage_ns += common_now_ns() - begin_ns;
    return status;
}

/* Place what hangs on joints: when the step has read all that is its client's. */
static void place_waiting(struct eng_scene *scene)
{
    for (uint32_t i = 0; i < scene->write_count; i++) {
        struct eng_write *write = &scene->writes[i];
        double ends[2][12];
        if (write->waits) {
            common_joint_transform(scene->staged_joints.items, write->joint, 0, ends[0]);
            common_joint_transform(scene->staged_joints.items, write->joint, 1, ends[1]);
            int status = place(scene, write, ends[0], ends[1]);
            assert(status == PCCD_OK); /* they stay within */
            (void)status;
        }
    }
}

static int compare_writes(const void *a, const void *b)
{
    const struct eng_write *wa = a;
    const struct eng_write *wb = b;
    if (wa->object != wb->object) {
        return wa->object < wb->object ? -1 : 1;
    }
    return wa->first != wb->first ? (wa->first < wb->first ? -1 : 1) : 0;
}

/* Clients write in order as a rule, so the sort, which may allocate, is rare. */
static void sort_writes(struct eng_scene *scene)
{
    for (uint32_t i = 1; i < scene->write_count; i++) {
        if (compare_writes(&scene->writes[i - 1], &scene->writes[i]) > 0) {
            qsort(scene->writes, scene->write_count, sizeof *scene->writes,
                  compare_writes);
            return;
        }
    }
}

bool eng_stage_overlaps(struct eng_scene *scene)
{
    sort_writes(scene);
    for (uint32_t i = 1; i < scene->write_count; i++) {
        const struct eng_write *below = &scene->writes[i - 1];
        const struct eng_write *above = &scene->writes[i];
        if (below->object == above->object &&
            above->first - below->first < below->count) {
            scene->twice = (struct eng_stage_fault){.object_idx = above->object,
                                                    .vertex = above->first};
            return true;
        }
    }
    return false;
}

struct eng_stage_fault eng_stage_twice(const struct eng_scene *scene)
{
    return scene->twice;
}

/* All before what is bad has been copied, by however many threads. */
bool eng_stage_stray(const struct eng_scene *scene, struct eng_stage_fault *stray)
{
    const struct eng_write *write = last_write(scene);
    uint32_t v = scene->objects[write->object].vertices.first + write->first;
    for (uint32_t end = write->has_start ? 0 : 1; end < 2; end++) {
        const double *x = (end == 0 ? scene->start : ends_of_staging(scene))[v];
        uint64_t at = common_first_stray(x, PCCD_FORMAT_F64, write->count);
        for (uint32_t k = 0; k < 3 && at < write->count; k++) {
            if (!common_is_coordinate(x[3 * at + k])) {
                *stray = (struct eng_stage_fault){
                    write->object, write->first + (uint32_t)at,
                    scene->is_trial && write->has_start ? 2 : end, k, x[3 * at + k]};
                return true;
            }
        }
    }
    return false;
}

/* Return whether every vertex of the scene has a given start position. Writes do not
 * overlap. */
static bool starts_are_whole(const struct eng_scene *scene)
{
    uint64_t given = 0;
    uint64_t all = 0;
    for (uint32_t i = 0; i < scene->write_count; i++) {
        given += scene->writes[i].has_start ? scene->writes[i].count : 0;
    }
    for (uint32_t i = 0; i < scene->object_capacity && given > 0; i++) {
        all += scene->objects[i].mesh ? scene->objects[i].vertices.count : 0;
    }
    return given > 0 && given == all;
}

/* Given start positions become the current ones: by changing the buffers' roles if all
 * are given, else by copying. */
static void take_starts(struct eng_scene *scene)
{
    double(*current)[3] = scene->x[scene->now];
    if (starts_are_whole(scene)) {
        assert(scene->start_capacity == scene->vertex_capacity);
        scene->x[scene->now] = scene->start;
        scene->start = current;
        return;
    }
    for (uint32_t i = 0; i < scene->write_count; i++) {
        const struct eng_write *write = &scene->writes[i];
        if (write->has_start) {
            uint32_t v = scene->objects[write->object].vertices.first + write->first;
            memcpy(current + v, scene->start + v, write->count * sizeof *current);
        }
    }
}

/* Bounds of an object whose vertices within `left` go to where those within `come` are,
 * from those before, *bounds. False, and unchanged: one that was farthest out has come
 * nearer, and what is farthest now is not known. */
static bool move_bounds(struct eng_bounds *bounds, const struct eng_bounds *left,
                        const struct eng_bounds *come)
{
    for (int k = 0; k < 3; k++) {
        if ((left->low[k] <= bounds->low[k] && come->low[k] > bounds->low[k]) ||
            (left->high[k] >= bounds->high[k] && come->high[k] < bounds->high[k])) {
            return false;
        }
    }
    eng_bounds_unite(bounds, come);
    return true;
}

/* Bounds of an object at t = 1, where the writes [count] took some of its vertices within
 * `come`; the others stand. False: all have to be looked at. */
static bool follow(const struct eng_scene *scene, const struct eng_object *object,
                   const struct eng_write *writes, uint32_t count,
                   const struct eng_bounds *come, struct eng_bounds *bounds)
{
    const double(*x0)[3] = (const double(*)[3])scene->x[scene->now];
    struct eng_bounds left = ENG_NO_BOUNDS;
    for (uint32_t i = 0; i < count; i++) {
        eng_kernels()->bound_positions(x0 + object->vertices.first + writes[i].first,
                                       writes[i].count, &left);
    }
    *bounds = object->bounds[scene->now];
    return move_bounds(bounds, &left, come);
}

/* The bounds of an object in x[which], of which the writes [count], which are its own,
 * have written: at their start (end 0) or end positions (1). What they tell is enough if
 * they cover the object and all its vertices count; as a rule, too, if the rest of it
 * stands. */
static void measure(struct eng_scene *scene, unsigned which, int end,
                    const struct eng_write *writes, uint32_t count)
{
    struct eng_object *object = &scene->objects[writes->object];
    struct eng_bounds bounds = ENG_NO_BOUNDS;
    uint64_t written = 0;
    for (uint32_t i = 0; i < count; i++) {
        eng_bounds_unite(&bounds, &writes[i].bounds[end]);
        written += end == 1 || writes[i].has_start ? writes[i].count : 0;
    }
    if (written == 0) {
        return;
    }
    const struct eng_bounds come = bounds;
    bool is_told = written == object->vertices.count ||
                   (end == 1 && follow(scene, object, writes, count, &come, &bounds));
    if (!is_told || object->mesh->info.isolated_count > 0) {
        bounds = eng_mesh_measure(object->mesh, (const double(*)[3])scene->x[which] +
                                                    object->vertices.first);
    }
    object->bounds[which] = bounds;
}

/* The joints of the step take the place of those of the last one. */
static void take_joints(struct eng_scene *scene)
{
    struct eng_joints last = scene->joints;
    scene->joints = scene->staged_joints;
    scene->staged_joints = last;
    scene->turning_count = 0;
}

/* The bounds of all objects that were written, whose writes are in order. */
static void measure_written(struct eng_scene *scene)
{
    for (uint32_t i = 0; i < scene->write_count;) {
        uint32_t first = i;
        while (i < scene->write_count &&
               scene->writes[i].object == scene->writes[first].object) {
            i++;
        }
        /* Several are parts: they have none. */
        struct eng_object *object = &scene->objects[scene->writes[first].object];
        memcpy(object->rounding_reach, scene->writes[first].rounding_reach,
               sizeof object->rounding_reach);
        object->is_posed = object->rounding_reach[1] < INFINITY;
        object->has_poses = scene->writes[first].has_poses;
        if (object->has_poses) {
            memcpy(object->poses->last, object->poses->staged,
                   sizeof object->poses->last);
        }
        object->joint = scene->writes[first].joint;
        scene->turning_count += object->joint != PCCD_NO_JOINT;
        measure(scene, scene->now, 0, &scene->writes[first], i - first);
        measure(scene, 1 - scene->now, 1, &scene->writes[first], i - first);
    }
}

int eng_stage_commit(struct eng_scene *scene)
{
    assert(scene->now <= 1 && !(scene->staging && scene->is_trial));
    uint64_t begin_ns = common_now_ns();
    if (!scene->staging) {
        eng_stage_begin(scene);
    }
    if (eng_stage_overlaps(scene)) {
        eng_stage_abort(scene);
        return PCCD_E_SEGMENT;
    }
    place_waiting(scene);
    for (uint32_t i = 0; i < scene->object_capacity; i++) {
        struct eng_object *object = &scene->objects[i];
        if (object->mesh && object->staged != scene->stage && !object->ends_are_equal) {
            eng_moving_catch_up(scene, object);
            object->bounds[1 - scene->now] = object->bounds[scene->now];
            object->rounding_reach[0] = object->rounding_reach[1];
            if (object->has_poses) {
                memcpy(object->poses->last[0], object->poses->last[1],
                       sizeof object->poses->last[0]);
            }
            object->ends_are_equal = true;
        }
        object->is_previous_overwritten = false;
        object->joint = PCCD_NO_JOINT;
    }
    eng_moving_commit(scene);
    take_joints(scene);
    take_starts(scene);
    measure_written(scene);
    scene->now = 1 - scene->now;
    scene->has_lost_start = false;
    scene->staging = false;
    scene->write_count = 0;
    scene->stage_ns += common_now_ns() - begin_ns;
    return PCCD_OK;
}

/* ---- a part of the step ------------------------------------------------------------ */

int eng_part_reserve(struct eng_scene *scene)
{
    struct eng_part *part = &scene->part;
    int status = PCCD_OK;
    if (part->capacity < scene->vertex_capacity) {
        status = eng_array_grow(&part->x[0], scene->vertex_capacity, sizeof *part->x[0]);
        if (status == PCCD_OK) {
            status =
                eng_array_grow(&part->x[1], scene->vertex_capacity, sizeof *part->x[1]);
        }
        part->capacity = status == PCCD_OK ? scene->vertex_capacity : part->capacity;
    }
    if (status == PCCD_OK && part->bound_capacity < scene->object_capacity) {
        status =
            eng_array_grow(&part->bounds, scene->object_capacity, sizeof *part->bounds);
        part->bound_capacity =
            status == PCCD_OK ? scene->object_capacity : part->bound_capacity;
    }
    return status;
}

static double between(double x0, double x1, double t)
{
    double x = t < 1 ? x0 + t * (x1 - x0) : x1;
    return fmin(fmax(x, fmin(x0, x1)), fmax(x0, x1));
}

/* Where the vertices of an object are at t, as which end of the part. */
static void place_object(struct eng_scene *scene, struct eng_object *object, unsigned end,
                         double t)
{
    const double(*x0)[3] = (const double(*)[3])scene->x[1 - scene->now];
    const double(*x1)[3] = (const double(*)[3])scene->x[scene->now];
    unsigned which = end == 1 ? scene->now : 1 - scene->now;
    double(*x)[3] = scene->part.x[which];
    uint32_t first = object->vertices.first;
    for (uint32_t v = first; v < first + object->vertices.count; v++) {
        for (int k = 0; k < 3; k++) {
            x[v][k] = between(x0[v][k], x1[v][k], t);
        }
    }
    object->bounds[which] = eng_mesh_measure(object->mesh, (const double(*)[3])x + first);
}

/* Trade the positions of the whole step for those of the part, or back. Boxes and records
 * go by the number of the motion. */
static void trade(struct eng_scene *scene)
{
    for (int i = 0; i < 2; i++) {
        double(*x)[3] = scene->x[i];
        scene->x[i] = scene->part.x[i];
        scene->part.x[i] = x;
    }
    scene->moving.number += 2;
}

void eng_part_enter(struct eng_scene *scene, const double span[2])
{
    assert(!scene->staging && scene->part.capacity >= scene->vertex_capacity);
    for (uint32_t i = 0; i < scene->object_capacity; i++) {
        struct eng_object *object = &scene->objects[i];
        if (object->mesh) {
            memcpy(scene->part.bounds[i], object->bounds, sizeof object->bounds);
            place_object(scene, object, 0, span[0]);
            place_object(scene, object, 1, span[1]);
        }
    }
    trade(scene);
}

void eng_part_leave(struct eng_scene *scene)
{
    for (uint32_t i = 0; i < scene->object_capacity; i++) {
        struct eng_object *object = &scene->objects[i];
        if (object->mesh) {
            memcpy(object->bounds, scene->part.bounds[i], sizeof object->bounds);
        }
    }
    trade(scene);
}

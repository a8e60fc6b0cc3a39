/* resource.c - what a session holds and the compute thread uses.
 *
 * Room:     service. See resource.h.
 * Does:     reference counts on [loop]; the last reference queues the resource itself as
 *           a job in its session's lane, behind every job that still uses it.
 * Does not: free anything large on [loop]: returning pages takes milliseconds.
 * Threads:  [loop] and [compute], as marked.
 */
#include "resource.h"
#include "diary.h"

#include <stdlib.h>
#include <string.h>

#include "enginemem.h"
#include "invariant.h"
#include "linger.h"
#include "loop.h"
#include "memory.h"
#include "meshes.h"
#include "proto_limits.h"
#include "session.h"
#include "wire.h"

#define PLACED_FIRST 16u

/* ---- references -------------------------------------------------------------------- */

/* [compute] */
static void reap(struct srv_job *job)
{
    struct srv_resource *resource = (struct srv_resource *)job;
    struct srv_session *session = resource->session;
    struct srv_enginemem memory;
    srv_enginemem_begin(&memory, session->user, session->loop->options->engine_bytes_max);
    resource->free_engine(job);
    srv_enginemem_end(&memory);
}

void srv_resource_init(struct srv_resource *resource, struct srv_session *session,
                       srv_job_fn free_engine, srv_job_fn free_rest)
{
    srv_job_init(&resource->reap, reap, free_rest);
    resource->free_engine = free_engine;
    resource->session = session;
    resource->refs = 1;
}

void srv_resource_acquire(struct srv_resource *resource)
{
    srv_assert_loop();
    PCCD_ASSERT(resource->refs > 0);
    resource->refs++;
}

void srv_resource_drop(struct srv_resource *resource)
{
    srv_assert_loop();
    PCCD_ASSERT(resource->refs > 0);
    if (--resource->refs == 0) {
        struct srv_session *session = resource->session;
        session->reap_count++;
        if (resource->is_ring) {
            srv_job_init(&resource->reap, resource->free_engine, resource->reap.done);
            srv_compute_push_reap(&session->loop->pages, &session->page_lane,
                                  &resource->reap);
        } else {
            srv_compute_push_reap(&session->loop->compute, &session->lane,
                                  &resource->reap);
        }
    }
}

/* ---- shapes ------------------------------------------------------------------------ */

static void shape_free_engine(struct srv_job *job)
{
    struct srv_shape *shape = (struct srv_shape *)job;
    eng_mesh_release(shape->engine);
    shape->engine = NULL;
}

static void shape_free_rest(struct srv_job *job)
{
    struct srv_shape *shape = (struct srv_shape *)job;
    struct srv_session *session = shape->resource.session;
    struct srv_loop *loop = session->loop;
    srv_quota_refund(&loop->quota, session->user, SRV_QUOTA_MESHES, 1);
    srv_quota_refund(&loop->quota, session->user, SRV_QUOTA_TRIANGLES,
                     srv_triangle_charge(shape->vertex_count, shape->triangle_count));
    free(shape);
    srv_session_reaped(session);
}

/* The engine allocates later, on [compute], where no room can be made any more. */
static int refuse_tight(struct srv_session *session, uint64_t triangles,
                        struct proto_error *error)
{
    if (!srv_linger_is_tight(session, triangles)) {
        return 0;
    }
    session->loop->quota.is_beyond = false;
    return proto_error_set(error, PCCD_E_QUOTA,
                           "user %u: the engine's memory is held by sessions that end",
                           (unsigned)session->user->uid);
}

/* Charge for one mesh and its triangles, or for nothing. */
static int charge_shape(struct srv_session *session, uint64_t triangles,
                        struct proto_error *error)
{
    struct srv_quota *quota = &session->loop->quota;
    int status = srv_quota_charge(quota, session->user, SRV_QUOTA_MESHES, 1, error);
    if (status != 0) {
        return status;
    }
    status =
        srv_quota_charge(quota, session->user, SRV_QUOTA_TRIANGLES, triangles, error);
    if (status != 0) {
        srv_quota_refund(quota, session->user, SRV_QUOTA_MESHES, 1);
    }
    return status;
}

int srv_shape_admit(struct srv_session *session, uint32_t vertex_count,
                    uint32_t triangle_count, struct srv_shape **shape,
                    struct proto_error *error)
{
    srv_assert_loop();
    if (vertex_count < 1 || vertex_count > PROTO_COUNT_MAX || triangle_count < 1 ||
        triangle_count > PROTO_COUNT_MAX) {
        return proto_error_set(error, PCCD_E_INVAL,
                               "a mesh has 1 to %u vertices and triangles, not %u and %u",
                               PROTO_COUNT_MAX, vertex_count, triangle_count);
    }
    uint64_t triangles = srv_triangle_charge(vertex_count, triangle_count);
    int status = refuse_tight(session, triangles, error);
    if (status == 0) {
        status = charge_shape(session, triangles, error);
    }
    if (status != 0) {
        return status;
    }
    struct srv_shape *new = calloc(1, sizeof *new);
    if (new == NULL) {
        srv_quota_refund(&session->loop->quota, session->user, SRV_QUOTA_MESHES, 1);
        srv_quota_refund(&session->loop->quota, session->user, SRV_QUOTA_TRIANGLES,
                         triangles);
        return proto_error_set(error, PCCD_E_NOMEM, "no memory for a mesh");
    }
    srv_resource_init(&new->resource, session, shape_free_engine, shape_free_rest);
    new->vertex_count = vertex_count;
    new->triangle_count = triangle_count;
    *shape = new;
    return 0;
}

int srv_shape_engine(struct srv_shape *shape, struct eng_mesh **engine)
{
    srv_assert_compute();
    int status = 0;
    if (shape->engine == NULL) {
        status = srv_wire_status(
            eng_mesh_new(shape->vertex_count, shape->triangle_count, &shape->engine));
    }
    *engine = shape->engine;
    return status;
}

/* ---- scenes ------------------------------------------------------------------------ */

static void scene_free_engine(struct srv_job *job)
{
    struct srv_scene *scene = (struct srv_scene *)job;
    eng_scene_free(scene->engine);
    scene->engine = NULL;
    eng_free(scene->placed);
    scene->placed = NULL;
}

/* Refund an object that has left its table already. */
static void object_free(struct srv_object *object)
{
    struct srv_session *owner = object->owner;
    struct srv_loop *loop = owner->loop;
    srv_object_unlink(object);
    srv_quota_refund(&loop->quota, owner->user, SRV_QUOTA_TRIANGLES, object->charge);
    if (object->lent != NULL) {
        srv_resource_drop(&object->lent->resource);
    }
    loop->metrics.counters.objects_now--;
    owner->told.objects--;
    owner->told.triangles -= object->charge;
    free(object);
}

/* Of a scene, at a turn of the loop: some 100 us. */
#define OBJECTS_PER_TURN 1024u

static void free_nothing(struct srv_job *job)
{
    (void)job;
}

static void scene_free_rest(struct srv_job *job)
{
    struct srv_scene *scene = (struct srv_scene *)job;
    struct srv_session *session = scene->resource.session;
    for (uint32_t i = 0; i < OBJECTS_PER_TURN && scene->objects.count > 0; i++) {
        object_free(srv_handles_pop(&scene->objects, &scene->freed));
    }
    if (scene->objects.count > 0) { /* comes back behind what else the loop has to do */
        srv_job_init(job, free_nothing, scene_free_rest);
        srv_compute_push_reap(&session->loop->pages, &session->page_lane, job);
        return;
    }
    srv_handles_deinit(&scene->objects);
    session->loop->metrics.counters.scenes_now--;
    session->scene_count--;
    free(scene);
    srv_session_reaped(session);
}

struct srv_scene *srv_scene_new(struct srv_session *session,
                                const struct eng_scene_settings *settings)
{
    struct srv_scene *scene = calloc(1, sizeof *scene);
    if (scene != NULL) {
        srv_resource_init(&scene->resource, session, scene_free_engine, scene_free_rest);
        srv_handles_init(&scene->objects, PROTO_OBJECTS_PER_SCENE, 0);
        scene->settings = *settings;
        session->loop->metrics.counters.scenes_now++;
        session->scene_count++;
    }
    return scene;
}

void srv_scene_name(struct srv_scene *scene, uint32_t handle)
{
    uint32_t generation = handle >> SRV_HANDLE_INDEX_BITS;
    PCCD_ASSERT(scene->objects.used == 0);
    srv_handles_init(&scene->objects, PROTO_OBJECTS_PER_SCENE,
                     srv_handle_index(handle) +
                         (generation - 1) * PROTO_SCENES_PER_CLIENT);
}

int srv_scene_engine(struct srv_scene *scene, struct eng_scene **engine)
{
    srv_assert_compute();
    int status = 0;
    if (scene->engine == NULL) {
        status = srv_wire_status(eng_scene_new(&scene->settings, &scene->engine));
    }
    *engine = scene->engine;
    return status;
}

int srv_scene_reserve(struct srv_scene *scene, uint32_t handle)
{
    srv_assert_compute();
    uint32_t index = srv_handle_index(handle);
    if (index < scene->placed_count) {
        return 0;
    }
    uint32_t count = scene->placed_count == 0 ? PLACED_FIRST : scene->placed_count;
    while (count <= index) { /* ends: an index has 20 bits */
        count *= 2;
    }
    struct srv_placed *placed = eng_realloc(scene->placed, count, sizeof *placed);
    if (placed == NULL) {
        return PCCD_E_NOMEM;
    }
    memset(placed + scene->placed_count, 0,
           (size_t)(count - scene->placed_count) * sizeof *placed);
    scene->placed = placed;
    scene->placed_count = count;
    return 0;
}

struct srv_placed *srv_scene_find(struct srv_scene *scene, uint32_t handle)
{
    srv_assert_compute();
    uint32_t index = srv_handle_index(handle);
    if (handle == 0 || index >= scene->placed_count ||
        scene->placed[index].handle != handle) {
        return NULL;
    }
    return &scene->placed[index];
}

void srv_scene_count_ignored(struct srv_scene *scene)
{
    srv_assert_compute();
    atomic_store_explicit(&scene->ignored_told, eng_scene_ignored_count(scene->engine),
                          memory_order_relaxed); /* nothing is read because of it */
}

void srv_scene_displace(struct srv_scene *scene, struct srv_placed *placed)
{
    srv_assert_compute();
    scene->has_answer = false;
    scene->changes++;
    srv_diary_gone(scene, placed->handle);
    int status = srv_wire_status(eng_scene_remove(scene->engine, placed->engine_idx));
    PCCD_ASSERT(status == 0); /* the engine has every object that is placed */
    srv_scene_count_ignored(scene);
    *placed = (struct srv_placed){0};
}

int srv_scene_admit(struct srv_scene *scene, struct srv_session *session,
                    const struct srv_seat *seat, struct srv_mesh *mesh, uint32_t *object,
                    struct proto_error *error)
{
    srv_assert_loop();
    struct srv_loop *loop = session->loop;
    uint64_t charge =
        srv_triangle_charge(mesh->current->vertex_count, mesh->current->triangle_count);
    int status = refuse_tight(scene->resource.session, charge, error);
    if (status == 0) {
        status = srv_quota_charge(&loop->quota, session->user, SRV_QUOTA_TRIANGLES,
                                  charge, error);
    }
    if (status != 0) {
        return status;
    }
    struct srv_object *item = calloc(1, sizeof *item);
    uint32_t want = *object;
    status = item == NULL
                 ? proto_error_set(error, PCCD_E_NOMEM, "no memory for an object")
                 : srv_session_handle(session, &scene->objects, "object", item, want,
                                      object, error);
    if (status != 0) {
        free(item);
        srv_quota_refund(&loop->quota, session->user, SRV_QUOTA_TRIANGLES, charge);
        return status;
    }
    item->handle = *object;
    item->charge = charge;
    item->owner = session;
    item->seat = seat;
    item->group = 1; /* as an object begins in the engine */
    item->mask = UINT64_MAX;
    item->self = true;
    if (scene->resource.session->user != session->user) {
        item->lent = mesh->current;
        srv_resource_acquire(&item->lent->resource);
    }
    srv_mesh_link(mesh, item);
    loop->metrics.counters.objects_now++;
    session->told.objects++;
    session->told.triangles += charge;
    return 0;
}

void srv_scene_forget(struct srv_scene *scene, uint32_t object)
{
    struct srv_object *item = srv_handles_remove(&scene->objects, object);
    PCCD_ASSERT(item != NULL);
    object_free(item);
}

void srv_scene_forget_of(struct srv_scene *scene, const struct srv_seat *seat)
{
    uint32_t cursor = 0;
    for (struct srv_object *object;
         (object = srv_handles_next(&scene->objects, &cursor)) != NULL;) {
        if (object->seat == seat) {
            srv_scene_forget(scene, object->handle);
        }
    }
}

void srv_scene_unlink_of(struct srv_scene *scene, const struct srv_seat *seat)
{
    uint32_t cursor = 0;
    for (struct srv_object *object;
         (object = srv_handles_next(&scene->objects, &cursor)) != NULL;) {
        if (object->seat == seat) {
            srv_object_unlink(object);
        }
    }
}

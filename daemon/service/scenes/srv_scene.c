/* srv_scene.c - what the handle of a scene stands for.
 *
 * Charge for each object before it exists, and refund it when it has left. An object
 * costs the memory that it takes, here and in the engine. In a scene of another user,
 * whose memory that is, its triangles are charged, too.
 */
#include "srv_scene.h"

#include <string.h>

#include "enginemem.h"
#include "invariant.h"
#include "proto_limits.h"
#include "service.h"
#include "session.h"

#define PLACED_FIRST 16u

/* Between the first handles of objects of a scene and of the one that takes its place. */
#define HANDLES_APART 64u

static void scene_free_engine(struct srv_job *job)
{
    struct srv_scene *scene = (struct srv_scene *)job;
    eng_scene_free(scene->engine);
    scene->engine = NULL;
    for (uint32_t i = 0; i < scene->placed_count; i++) {
        eng_free(scene->placed[i].name);
    }
    eng_free(scene->placed);
    scene->placed = NULL;
}

/* Refund an object that has left its table already. */
static void object_free(struct srv_object *object)
{
    struct srv_session *owner = object->owner;
    struct srv_service *service = owner->service;
    srv_object_unlink(object);
    if (object->borrowed_shape != NULL) {
        srv_quota_refund(owner->owner.user, SRV_QUOTA_TRIANGLES, object->triangles);
        srv_resource_drop(&object->borrowed_shape->resource);
    }
    service->metrics.counters.objects_now--;
    owner->stats.objects--;
    owner->stats.triangles -= object->triangles;
    srv_enginemem_delete(owner->owner.user, object->name);
    srv_enginemem_delete(owner->owner.user, object);
}

/* Objects of a scene that are dropped at a turn of the loop: some 100 us. */
#define OBJECTS_PER_TURN 1024u

static void free_nothing(struct srv_job *job)
{
    (void)job;
}

static void scene_free_rest(struct srv_job *job)
{
    struct srv_scene *scene = (struct srv_scene *)job;
    struct srv_session *session = srv_session_of(scene->resource.owner);
    for (uint32_t i = 0; i < OBJECTS_PER_TURN && scene->objects.count > 0; i++) {
        object_free(srv_handles_pop(&scene->objects, &scene->freed));
    }
    if (scene->objects.count > 0) { /* comes back behind what else the loop has to do */
        srv_job_init(job, free_nothing, scene_free_rest);
        srv_compute_push_reap(session->owner.pages, &session->owner.page_job_list, job);
        return;
    }
    srv_session_drop_handles(session, &scene->objects);
    session->service->metrics.counters.scenes_now--;
    session->scene_count--;
    srv_enginemem_delete(session->owner.user, scene);
    srv_owner_release(&session->owner);
}

struct srv_scene *srv_scene_new(struct srv_session *session,
                                const struct eng_scene_settings *settings,
                                struct proto_error *error)
{
    struct srv_scene *scene =
        srv_enginemem_new(session->owner.user, sizeof *scene, "a scene", error);
    if (scene != NULL) {
        srv_resource_init(&scene->resource, &session->owner, scene_free_engine,
                          scene_free_rest);
        srv_handles_init(&scene->objects, PROTO_OBJECTS_PER_SCENE, 0);
        scene->settings = *settings;
        session->service->metrics.counters.scenes_now++;
        session->scene_count++;
    }
    return scene;
}

void srv_scene_name(struct srv_scene *scene, uint32_t handle)
{
    uint32_t generation = handle >> SRV_HANDLE_INDEX_BITS;
    uint32_t reuses =
        (generation - 1 + SRV_HANDLE_GENERATION_MAX - SRV_SCENES_GENERATION) %
        SRV_HANDLE_GENERATION_MAX;
    PCCD_ASSERT(scene->objects.used == 0);
    srv_handles_init(&scene->objects, PROTO_OBJECTS_PER_SCENE,
                     srv_handle_index(handle) + reuses * HANDLES_APART);
}

int srv_scene_engine(struct srv_scene *scene, struct eng_scene **engine)
{
    srv_assert_compute();
    int status = 0;
    if (scene->engine == NULL) {
        status = eng_scene_new(&scene->settings, &scene->engine);
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
    atomic_store_explicit(&scene->ignored_pairs, eng_scene_ignored_count(scene->engine),
                          memory_order_relaxed); /* nothing is read because of it */
}

void srv_scene_forget_answers(struct srv_scene *scene)
{
    srv_assert_compute();
    scene->stepped.is_there = false;
    scene->near.is_there = false;
}

void srv_scene_displace(struct srv_scene *scene, struct srv_placed *placed)
{
    srv_assert_compute();
    srv_scene_forget_answers(scene);
    scene->changes++;
    int status = eng_scene_remove(scene->engine, placed->engine_idx);
    PCCD_ASSERT(status == 0); /* the engine has every object that is placed */
    srv_scene_count_ignored(scene);
    eng_free(placed->name);
    *placed = (struct srv_placed){0};
}

/* One that is in no table yet. NULL, with *error set: it would be too much. */
static struct srv_object *object_new(const struct srv_scene *scene,
                                     struct srv_session *session,
                                     const struct srv_member *member,
                                     const struct srv_mesh *mesh,
                                     struct proto_error *error)
{
    struct srv_quota_user *user = session->owner.user;
    bool is_borrowed = scene->resource.owner->user != user;
    uint64_t triangles = srv_shape_charge(&mesh->current->counts);
    if (srv_enginemem_refuse_tight(scene->resource.owner->user, triangles, error) != 0 ||
        (is_borrowed &&
         srv_quota_charge(user, SRV_QUOTA_TRIANGLES, triangles, error) != 0)) {
        return NULL;
    }
    struct srv_object *object =
        srv_enginemem_new(user, sizeof *object, "an object", error);
    if (object == NULL) {
        if (is_borrowed) {
            srv_quota_refund(user, SRV_QUOTA_TRIANGLES, triangles);
        }
        return NULL;
    }
    *object = (struct srv_object){.triangles = triangles,
                                  .owner = session,
                                  .member = member,
                                  .attributes = COMMON_ATTRIBUTES_AT_FIRST};
    if (is_borrowed) {
        object->borrowed_shape = mesh->current;
        srv_resource_acquire(&object->borrowed_shape->resource);
    }
    session->service->metrics.counters.objects_now++;
    session->stats.objects++;
    session->stats.triangles += triangles;
    return object;
}

int srv_scene_admit(struct srv_scene *scene, struct srv_session *session,
                    const struct srv_member *member, struct srv_mesh *mesh,
                    uint32_t *object, struct proto_error *error)
{
    srv_assert_loop();
    struct srv_object *item = object_new(scene, session, member, mesh, error);
    if (item == NULL) {
        return error->code;
    }
    int status = srv_session_handle(srv_session_of(scene->resource.owner),
                                    &scene->objects, "object", item, object, error);
    if (status != 0) {
        object_free(item);
        return status;
    }
    item->handle = *object;
    srv_mesh_link(mesh, item);
    return 0;
}

void srv_scene_forget(struct srv_scene *scene, uint32_t object)
{
    struct srv_object *item = srv_handles_remove(&scene->objects, object);
    PCCD_ASSERT(item != NULL);
    object_free(item);
}

void srv_scene_forget_of(struct srv_scene *scene, const struct srv_member *member)
{
    uint32_t cursor = 0;
    for (struct srv_object *object;
         (object = srv_handles_next(&scene->objects, &cursor)) != NULL;) {
        if (object->member == member) {
            srv_scene_forget(scene, object->handle);
        }
    }
}

void srv_scene_unlink_of(struct srv_scene *scene, const struct srv_member *member)
{
    uint32_t cursor = 0;
    for (struct srv_object *object;
         (object = srv_handles_next(&scene->objects, &cursor)) != NULL;) {
        if (object->member == member) {
            srv_object_unlink(object);
        }
    }
}

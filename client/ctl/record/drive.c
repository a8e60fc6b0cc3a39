/* drive.c - a daemon that does what a recorded session did. */
#include "drive.h"

#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

#include "payload.h"

static int failed(const struct drive *drive, int status, const char *what,
                  struct ctl_error *error)
{
    const char *text = pccd_error_text(drive->client);
    return ctl_error_set(error, status, "%s: %s", what,
                         text[0] != '\0' ? text : pccd_status_text(status));
}

/* The next call makes something under this handle. */
static int expect(uint32_t wanted, uint32_t given, const char *what,
                  struct ctl_error *error)
{
    if (wanted == given) {
        return PCCD_OK;
    }
    return ctl_error_set(error, PCCD_E_HANDLE,
                         "the daemon gives %s 0x%" PRIx32 " for 0x%" PRIx32
                         ": its answers cannot be compared",
                         what, given, wanted);
}

/* ---- meshes, scenes, objects ------------------------------------------------------- */

static int make_scene(struct drive *drive, uint32_t scene, struct ctl_error *error)
{
    uint32_t made = 0;
    pccd_request_handle(drive->client, scene);
    int status = pccd_scene_create(drive->client, NULL, &made);
    if (status != PCCD_OK) {
        return failed(drive, status, "a recorded scene", error);
    }
    return expect(scene, made, "scene", error);
}

/* A mesh of the world, or what it has become: under its handle, or under any if it is
 * destroyed already. */
static int put_mesh(struct drive *drive, struct registry_mesh *mesh,
                    struct ctl_error *error)
{
    const struct pccd_mesh_data data = {.struct_bytes = sizeof data,
                                        .x = mesh->x,
                                        .format = (enum pccd_format)mesh->format,
                                        .vertex_count = mesh->vertex_count,
                                        .triangle_count = mesh->triangle_count,
                                        .triangles = (const uint32_t *)mesh->triangles,
                                        .radii = mesh->radii,
                                        .edges = (const uint32_t *)mesh->named_edges,
                                        .points = mesh->named_points,
                                        .edge_count = mesh->named_edge_count,
                                        .point_count = mesh->named_point_count};
    if (mesh->made_handle == 0) {
        pccd_request_handle(drive->client, mesh->is_destroyed ? 0 : mesh->handle);
    }
    int status = pccd_mesh_put(drive->client, &data, &mesh->made_handle, NULL);
    if (status != PCCD_OK) {
        return failed(drive, status, "a recorded mesh", error);
    }
    return mesh->is_destroyed ? PCCD_OK
                              : expect(mesh->handle, mesh->made_handle, "mesh", error);
}

static int add_object(struct drive *drive, uint32_t scene, uint32_t mesh, uint32_t wanted,
                      struct ctl_error *error)
{
    uint32_t made = 0;
    pccd_request_handle(drive->client, wanted);
    int status = pccd_scene_add(drive->client, scene, mesh, &made);
    if (status != PCCD_OK) {
        return failed(drive, status, "a recorded object", error);
    }
    return expect(wanted, made, "object", error);
}

/* Move an object to where it is: a step of its own, from there to there. */
static int place_object(struct drive *drive, uint32_t scene,
                        const struct registry_object *object, struct ctl_error *error)
{
    const struct pccd_step_settings settings = {
        .struct_bytes = sizeof(struct pccd_step_settings), .mode = PCCD_MODE_ANY};
    struct pccd_answer answer = PCCD_ANSWER_INIT;
    int status =
        pccd_step_x0x1(drive->client, scene, object->handle, object->x1, object->x1,
                       PCCD_FORMAT_F64, object->mesh->vertex_count, &settings, &answer);
    if (status != PCCD_OK) {
        return failed(drive, status, "a recorded place", error);
    }
    pccd_answer_release(drive->client, &answer);
    return PCCD_OK;
}

/* All attributes of an object, as they are. */
static int set_object(struct drive *drive, uint32_t scene,
                      const struct registry_object *object, struct ctl_error *error)
{
    struct pccd_object_settings settings = {.what = PCCD_OBJECT_ALL};
    COMMON_ATTRIBUTES_COPY(&settings, &object->attributes);
    int status = pccd_object_set(drive->client, scene, object->handle, &settings);
    return status == PCCD_OK ? status : failed(drive, status, "a recorded mask", error);
}

static int set_pairs(struct drive *drive, uint32_t scene, const uint8_t *pairs,
                     uint32_t count, bool ignored, struct ctl_error *error)
{
    for (uint32_t i = 0; i < count; i++) {
        uint32_t pair[2];
        memcpy(pair, pairs + i * sizeof pair, sizeof pair);
        int status = pccd_pair_ignore(drive->client, scene, pair[0], pair[1], ignored);
        if (status != PCCD_OK) {
            return failed(drive, status, "a recorded pair", error);
        }
    }
    return PCCD_OK;
}

static int ignore_pair(struct drive *drive, uint32_t scene,
                       const struct registry_pair *pair, struct ctl_error *error)
{
    const uint32_t handles[2] = {pair->a, pair->b};
    return set_pairs(drive, scene, (const uint8_t *)handles, 1, true, error);
}

/* Where the objects of a scene are, and what they may meet. */
static int begin_places(struct drive *drive, struct registry_scene *scene,
                        struct ctl_error *error)
{
    int status = PCCD_OK;
    for (uint32_t i = 0; i < scene->object_count && status == PCCD_OK; i++) {
        const struct registry_object *object = &scene->objects[i];
        status = object->placing != REGISTRY_AS_REGISTERED
                     ? place_object(drive, scene->handle, object, error)
                     : PCCD_OK;
        if (status == PCCD_OK && !common_attributes_are_at_first(&object->attributes)) {
            status = set_object(drive, scene->handle, object, error);
        }
    }
    registry_pairs_settle(&scene->ignored);
    for (uint32_t i = 0; i < scene->ignored.count && status == PCCD_OK; i++) {
        status = ignore_pair(drive, scene->handle, &scene->ignored.said[i], error);
    }
    return status;
}

static int destroy_mesh(struct drive *drive, const struct registry_mesh *mesh,
                        struct ctl_error *error)
{
    int status = pccd_mesh_destroy(drive->client, mesh->made_handle);
    return status == PCCD_OK
               ? status
               : failed(drive, status, "a recorded mesh that is gone", error);
}

/* Objects of a mesh that is gone: of one that is made for them and destroyed again. */
static int add_orphans(struct drive *drive, const struct registry *world,
                       struct registry_mesh *mesh, struct ctl_error *error)
{
    int status = put_mesh(drive, mesh, error);
    for (struct registry_scene *scene = world->scenes; scene != NULL;
         scene = scene->next) {
        for (uint32_t i = 0; i < scene->object_count && status == PCCD_OK; i++) {
            if (scene->objects[i].mesh == mesh) {
                status = add_object(drive, scene->handle, mesh->made_handle,
                                    scene->objects[i].handle, error);
            }
        }
    }
    return status == PCCD_OK ? destroy_mesh(drive, mesh, error) : status;
}

static int begin_meshes(struct drive *drive, const struct registry *world,
                        struct ctl_error *error)
{
    int status = PCCD_OK;
    for (struct registry_mesh *mesh = world->meshes; mesh != NULL && status == PCCD_OK;
         mesh = mesh->next) {
        status = mesh->is_destroyed ? PCCD_OK : put_mesh(drive, mesh, error);
    }
    return status;
}

static int begin_objects(struct drive *drive, const struct registry *world,
                         struct ctl_error *error)
{
    int status = PCCD_OK;
    for (struct registry_scene *scene = world->scenes; scene != NULL && status == PCCD_OK;
         scene = scene->next) {
        status = make_scene(drive, scene->handle, error);
        for (uint32_t i = 0; i < scene->object_count && status == PCCD_OK; i++) {
            const struct registry_object *object = &scene->objects[i];
            if (!object->mesh->is_destroyed) {
                status = add_object(drive, scene->handle, object->mesh->handle,
                                    object->handle, error);
            }
        }
    }
    for (struct registry_mesh *mesh = world->meshes; mesh != NULL && status == PCCD_OK;
         mesh = mesh->next) {
        status = mesh->is_destroyed ? add_orphans(drive, world, mesh, error) : PCCD_OK;
    }
    return status;
}

int drive_begin(struct drive *drive, const struct registry *world,
                struct ctl_error *error)
{
    int status = begin_meshes(drive, world, error);
    if (status == PCCD_OK) {
        status = begin_objects(drive, world, error);
    }
    for (struct registry_scene *scene = world->scenes; scene != NULL && status == PCCD_OK;
         scene = scene->next) {
        status = begin_places(drive, scene, error);
    }
    drive->is_begun = status == PCCD_OK;
    return status;
}

/* ---- the log ----------------------------------------------------------------------- */

static int follow_gone(struct drive *drive, const struct record_view *view,
                       struct ctl_error *error)
{
    struct record_gone gone;
    memcpy(&gone, view->payload, sizeof gone);
    int status = view->kind == RECORD_MESH_GONE
                     ? pccd_mesh_destroy(drive->client, gone.mesh)
                 : view->kind == RECORD_SCENE_GONE
                     ? pccd_scene_destroy(drive->client, gone.scene)
                     : pccd_scene_remove(drive->client, gone.scene, gone.object);
    return status == PCCD_OK ? status
                             : failed(drive, status, "a recorded removal", error);
}

static int follow_pairs(struct drive *drive, const struct record_view *view,
                        struct ctl_error *error)
{
    struct record_pairs pairs;
    memcpy(&pairs, view->payload, sizeof pairs);
    return set_pairs(drive, pairs.scene, (const uint8_t *)view->payload + sizeof pairs,
                     pairs.count, pairs.ignored != 0, error);
}

/* Those of its pairs that ignore each other. */
static int ignore_again(struct drive *drive, struct registry_scene *scene,
                        uint32_t object, struct ctl_error *error)
{
    int status = PCCD_OK;
    registry_pairs_settle(&scene->ignored);
    for (uint32_t i = 0; i < scene->ignored.count && status == PCCD_OK; i++) {
        const struct registry_pair *pair = &scene->ignored.said[i];
        if (pair->a == object || pair->b == object) {
            status = ignore_pair(drive, scene->handle, pair, error);
        }
    }
    return status;
}

/* An object with a mesh of its own, which is destroyed under it. One that is there goes
 * before, and what it may meet is said again. */
static int put_guest(struct drive *drive, struct registry_scene *scene,
                     const struct registry_object *object, struct ctl_error *error)
{
    int status = pccd_scene_remove(drive->client, scene->handle, object->handle);
    if (status != PCCD_OK && status != PCCD_E_HANDLE) {
        return failed(drive, status, "a recorded object", error);
    }
    status = put_mesh(drive, object->mesh, error);
    if (status == PCCD_OK) {
        status = add_object(drive, scene->handle, object->mesh->made_handle,
                            object->handle, error);
    }
    if (status == PCCD_OK) {
        status = destroy_mesh(drive, object->mesh, error);
    }
    if (status == PCCD_OK && !common_attributes_are_at_first(&object->attributes)) {
        status = set_object(drive, scene->handle, object, error);
    }
    return status == PCCD_OK ? ignore_again(drive, scene, object->handle, error) : status;
}

/* The object that a chunk is about. */
static int follow_object(struct drive *drive, const struct registry *world,
                         enum record_kind kind, uint32_t scene_handle, uint32_t handle,
                         struct ctl_error *error)
{
    struct registry_scene *scene = registry_scene(world, scene_handle);
    const struct registry_object *object = registry_object(scene, handle);
    return kind == RECORD_GUEST ? put_guest(drive, scene, object, error)
           : kind == RECORD_FILTER
               ? set_object(drive, scene_handle, object, error)
               : add_object(drive, scene_handle, object->mesh->handle, handle, error);
}

int drive_follow(struct drive *drive, const struct registry *world,
                 const struct record_view *view, struct ctl_error *error)
{
    union {
        struct record_mesh mesh;
        struct record_scene scene;
        struct record_object object;
        struct record_guest guest;
        struct record_filter filter;
    } head = {.mesh = {0}};
    enum record_kind kind = (enum record_kind)view->kind;
    memcpy(&head, view->payload, view->bytes < sizeof head ? view->bytes : sizeof head);
    switch (kind) {
    case RECORD_MESH:
        return put_mesh(drive, registry_mesh(world, head.mesh.mesh), error);
    case RECORD_SCENE:
        return make_scene(drive, head.scene.scene, error);
    case RECORD_OBJECT:
        return follow_object(drive, world, kind, head.object.scene, head.object.object,
                             error);
    case RECORD_GUEST:
        return follow_object(drive, world, kind, head.guest.scene, head.guest.object,
                             error);
    case RECORD_FILTER:
        return follow_object(drive, world, kind, head.filter.scene, head.filter.object,
                             error);
    case RECORD_SCENE_GONE:
    case RECORD_MESH_GONE:
    case RECORD_OBJECT_GONE:
        return follow_gone(drive, view, error);
    case RECORD_PAIRS:
        return follow_pairs(drive, view, error);
    default:
        return PCCD_OK;
    }
}

/* ---- steps ------------------------------------------------------------------------- */

static int submit(struct drive *drive, const struct record_frame *frame,
                  const struct drive_pieces *pieces, const uint8_t *slot, uint64_t *step)
{
    const struct pccd_step_settings settings = {
        .struct_bytes = sizeof(struct pccd_step_settings),
        .mode = (enum pccd_mode)frame->mode,
        .method = (enum pccd_method)frame->method,
        .threads = frame->threads,
        .tuning = drive->tuning,
        .tolerance = frame->tolerance,
        .deadline_ns = frame->deadline_ns,
        .separation = drive->separation.separation,
        .approach = drive->separation.approach,
        .tells_start = drive->tells};
    struct pccd_frame made;
    if (pieces->count == 0) {
        return pccd_submit_still(drive->client, frame->scene, &settings, step);
    }
    int status = drive_pieces_frame(pieces, drive->client, frame->scene, slot, &made);
    return status == PCCD_OK ? pccd_frame_commit(&made, &settings, step) : status;
}

static int submit_near(struct drive *drive, const struct record_near *near,
                       const struct drive_pieces *pieces, const uint8_t *slot,
                       uint64_t *step)
{
    struct pccd_near_settings settings = {.struct_bytes = sizeof settings,
                                          .what = (enum pccd_near_what)near->what,
                                          .distance = near->distance,
                                          .gap = near->gap,
                                          .end = near->end,
                                          .object_a = near->objects[0],
                                          .object_b = near->objects[1],
                                          .threads = near->threads,
                                          .tells_crossings = drive->tells,
                                          .deadline_ns = near->deadline_ns,
                                          .method = (enum pccd_method)near->method};
    struct pccd_frame made;
    memcpy(settings.tuning, drive->tuning, sizeof settings.tuning);
    if (pieces->count == 0) {
        return pccd_submit_near(drive->client, near->scene, NULL, 0, &settings, step);
    }
    int status = drive_pieces_frame(pieces, drive->client, near->scene, slot, &made);
    return status == PCCD_OK ? pccd_frame_commit_near(&made, &settings, step) : status;
}

static int collect(struct drive *drive, const struct pccd_answer *page,
                   struct ctl_error *error)
{
    const void *from = page->contacts;
    size_t each = sizeof(struct pccd_contact);
    if (page->is_near && page->what == PCCD_NEAR_VERTICES) {
        from = page->vertex_bounds;
        each = sizeof(double);
    } else if (page->is_near) {
        from = page->near;
        each = sizeof(struct pccd_near);
    } else if (page->mode == PCCD_MODE_PAIRS) {
        from = page->pairs;
        each = sizeof(struct pccd_pair);
    }
    size_t bytes = (drive->record_count + page->count) * each;
    if (bytes > drive->record_room) {
        void *larger = realloc(drive->records, bytes + bytes / 2);
        if (larger == NULL) {
            return ctl_error_set(error, PCCD_E_NOMEM, "no memory for %" PRIu64 " records",
                                 page->total);
        }
        drive->records = larger;
        drive->record_room = bytes + bytes / 2;
    }
    if (page->count > 0) {
        memcpy((uint8_t *)drive->records + drive->record_count * each, from,
               page->count * each);
    }
    drive->record_count += page->count;
    return PCCD_OK;
}

/* Wait for what was submitted, or could not be, and take its records. */
static int take_answer(struct drive *drive, uint32_t scene, uint64_t step, int submitted,
                       bool collects, struct ctl_error *error)
{
    struct pccd_answer page = {.step = 0};
    int status = submitted;
    drive->record_count = 0;
    if (status == PCCD_OK) {
        status = pccd_wait(drive->client, step, -1, &page);
    }
    drive->answer = page;
    if (status != PCCD_OK) {
        /* What the daemon says of the step is its answer; all else is our failure. */
        return page.step == step && step != 0 ? PCCD_OK
                                              : failed(drive, status, "a step", error);
    }
    status = collects ? collect(drive, &page, error) : PCCD_OK;
    while (status == PCCD_OK && collects && page.cursor < page.total && page.count > 0) {
        pccd_answer_release(drive->client, &page);
        status = pccd_fetch(drive->client, scene, step, page.cursor, &page);
        status = status == PCCD_OK ? collect(drive, &page, error)
                                   : failed(drive, status, "a page of records", error);
    }
    pccd_answer_release(drive->client, &page);
    return status;
}

int drive_step(struct drive *drive, const struct record_frame *frame, const uint8_t *slot,
               bool collects, struct ctl_error *error)
{
    struct drive_pieces pieces;
    uint64_t step = 0;
    int status = drive_pieces_make(&pieces, drive->stands, frame->scene,
                                   frame->segment_count, slot, error);
    if (status != PCCD_OK) {
        return status;
    }
    status = submit(drive, frame, &pieces, slot, &step);
    drive_pieces_deinit(&pieces);
    return take_answer(drive, frame->scene, step, status, collects, error);
}

int drive_near(struct drive *drive, const struct registry *world,
               const struct record_near *near, const uint8_t *slot, bool collects,
               struct ctl_error *error)
{
    /* Where the last movement began, a daemon does not know that has not seen it, or was
     * only told where things are. */
    bool repeats = near->segment_count == 0 && near->end == 0 && drive->knows_no_begin;
    struct drive_pieces pieces;
    uint64_t step = 0;
    int status = repeats ? drive_pieces_repeat(&pieces, world, near->scene, error)
                         : drive_pieces_make(&pieces, drive->stands, near->scene,
                                             near->segment_count, slot, error);
    if (status != PCCD_OK) {
        return status;
    }
    status = submit_near(drive, near, &pieces, slot, &step);
    drive_pieces_deinit(&pieces);
    return take_answer(drive, near->scene, step, status, collects, error);
}

int drive_move(struct drive *drive, const struct record_frame *frame, const uint8_t *slot,
               struct ctl_error *error)
{
    struct record_frame asked = *frame;
    asked.mode = PCCD_MODE_ANY;
    int status = drive_step(drive, &asked, slot, false, error);
    return status == PCCD_OK && drive->answer.status != PCCD_OK
               ? failed(drive, drive->answer.status, "a step of another client", error)
               : status;
}

void drive_deinit(struct drive *drive)
{
    free(drive->records);
    drive->records = NULL;
}

/* replayer.c - a daemon that does what a recorded session did. */
#include "replayer.h"

#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "array.h"
#include "names.h"
#include "payload.h"

#define AT_ONCE 1u /* deadline_ns: move, and look for nothing */

static int failed(const struct replayer *replayer, int status, const char *what,
                  struct ctl_error *error)
{
    const char *text = pccd_error_text(replayer->client);
    return ctl_error_set(error, status, "%s: %s", what,
                         text[0] != '\0' ? text : pccd_status_text(status));
}

/* The daemon was asked to make something under this handle. */
static int judge_made(const struct replayer *replayer, int status, uint32_t wanted,
                      uint32_t made, const char *what, struct ctl_error *error)
{
    if (status != PCCD_OK) {
        char text[32];
        (void)snprintf(text, sizeof text, "a recorded %s", what);
        return failed(replayer, status, text, error);
    }
    return wanted == made
               ? PCCD_OK
               : ctl_error_set(error, PCCD_E_HANDLE,
                               "the daemon gives %s 0x%" PRIx32 " for 0x%" PRIx32
                               ": its answers cannot be compared",
                               what, made, wanted);
}

/* ---- meshes, scenes, objects ------------------------------------------------------- */

/* A mesh, or what it has become: under its handle, or under any if it is destroyed
 * already. */
static int put_mesh(struct replayer *replayer, struct registry_mesh *mesh,
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
        pccd_request_handle(replayer->client, mesh->is_destroyed ? 0 : mesh->handle);
    }
    int status = pccd_mesh_put(replayer->client, &data, &mesh->made_handle, NULL);
    mesh->is_told = status == PCCD_OK && !mesh->is_destroyed;
    return judge_made(replayer, status,
                      mesh->is_destroyed ? mesh->made_handle : mesh->handle,
                      mesh->made_handle, "mesh", error);
}

static int make_scene(struct replayer *replayer, struct registry_scene *scene,
                      struct ctl_error *error)
{
    uint32_t made = 0;
    pccd_request_handle(replayer->client, scene->handle);
    int status = pccd_scene_create(replayer->client, NULL, &made);
    scene->is_made = status == PCCD_OK;
    return judge_made(replayer, status, scene->handle, made, "scene", error);
}

/* All attributes of an object, as they are. */
static int set_object(struct replayer *replayer, const struct registry_scene *scene,
                      struct registry_object *object, struct ctl_error *error)
{
    struct pccd_object_settings settings = {.what = PCCD_OBJECT_ALL};
    COMMON_ATTRIBUTES_COPY(&settings, &object->attributes);
    int status =
        pccd_object_set(replayer->client, scene->handle, object->handle, &settings);
    return status == PCCD_OK ? status
                             : failed(replayer, status, "a recorded mask", error);
}

static int tell_pair(struct replayer *replayer, uint32_t scene,
                     const struct registry_pair *pair, struct ctl_error *error)
{
    int status =
        pair->has_clearance
            ? pccd_pair_clearance(replayer->client, scene, pair->a, pair->b,
                                  pair->clearance)
            : pccd_pair_ignore(replayer->client, scene, pair->a, pair->b, pair->ignored);
    return status == PCCD_OK ? status
                             : failed(replayer, status, "a recorded pair", error);
}

/* Tell what is said of the pairs of a scene; of one object, or of any (0). */
static int tell_pairs_of(struct replayer *replayer, struct registry_scene *scene,
                         uint32_t object, struct ctl_error *error)
{
    int status = PCCD_OK;
    registry_pairs_settle(&scene->pairs);
    for (uint32_t i = 0; i < scene->pairs.count && status == PCCD_OK; i++) {
        const struct registry_pair *pair = &scene->pairs.said[i];
        if (object == 0 || pair->a == object || pair->b == object) {
            status = tell_pair(replayer, scene->handle, pair, error);
        }
    }
    return status;
}

/* An object of a mesh that is told, or is destroyed and told now. One that had another
 * mesh goes before, and what it may meet is said again. */
static int make_object(struct replayer *replayer, struct registry_scene *scene,
                       struct registry_object *object, struct ctl_error *error)
{
    bool is_another = object->is_made;
    uint32_t made = 0;
    int status = is_another
                     ? pccd_scene_remove(replayer->client, scene->handle, object->handle)
                     : PCCD_OK;
    if (status != PCCD_OK) {
        return failed(replayer, status, "a recorded object", error);
    }
    if (object->mesh->made_handle == 0) {
        status = put_mesh(replayer, object->mesh, error);
    }
    if (status != PCCD_OK) {
        return status;
    }
    pccd_request_handle(replayer->client, object->handle);
    status =
        pccd_scene_add(replayer->client, scene->handle, object->mesh->made_handle, &made);
    object->is_made = status == PCCD_OK;
    status = judge_made(replayer, status, object->handle, made, "object", error);
    return status == PCCD_OK && is_another
               ? tell_pairs_of(replayer, scene, object->handle, error)
               : status;
}

static int tell_object(struct replayer *replayer, struct registry_scene *scene,
                       struct registry_object *object, struct ctl_error *error)
{
    bool is_new = !object->is_made || object->mesh->made_handle == 0;
    int status = is_new ? make_object(replayer, scene, object, error) : PCCD_OK;
    if (status == PCCD_OK &&
        !(is_new && common_attributes_are_at_first(&object->attributes))) {
        status = set_object(replayer, scene, object, error);
    }
    object->is_told = status == PCCD_OK;
    return status;
}

static int tell_scene(struct replayer *replayer, struct registry_scene *scene,
                      struct ctl_error *error)
{
    bool is_new = !scene->is_made;
    int status = is_new ? make_scene(replayer, scene, error) : PCCD_OK;
    for (uint32_t i = 0; i < scene->object_count && status == PCCD_OK; i++) {
        if (!scene->objects[i].is_told) {
            status = tell_object(replayer, scene, &scene->objects[i], error);
        }
    }
    if (status == PCCD_OK && is_new) {
        status = tell_pairs_of(replayer, scene, 0, error);
    }
    scene->is_told = status == PCCD_OK;
    return status;
}

/* Meshes that are destroyed, but for the objects that are made of them. */
static int destroy_meshes(struct replayer *replayer, const struct registry *state,
                          struct ctl_error *error)
{
    for (struct registry_mesh *mesh = state->meshes; mesh != NULL; mesh = mesh->next) {
        if (mesh->is_destroyed && !mesh->is_told) {
            int status = pccd_mesh_destroy(replayer->client, mesh->made_handle);
            if (status != PCCD_OK) {
                return failed(replayer, status, "a recorded mesh that is gone", error);
            }
            mesh->is_told = true;
        }
    }
    return PCCD_OK;
}

/* Tell the daemon of all that was made, replaced or set. */
static int tell(struct replayer *replayer, const struct registry *state,
                struct ctl_error *error)
{
    int status = PCCD_OK;
    for (struct registry_mesh *mesh = state->meshes; mesh != NULL && status == PCCD_OK;
         mesh = mesh->next) {
        if (!mesh->is_destroyed && !mesh->is_told) {
            status = put_mesh(replayer, mesh, error);
        }
    }
    for (struct registry_scene *scene = state->scenes; scene != NULL && status == PCCD_OK;
         scene = scene->next) {
        if (!scene->is_told) {
            status = tell_scene(replayer, scene, error);
        }
    }
    if (status == PCCD_OK) {
        status = destroy_meshes(replayer, state, error);
    }
    replayer->is_behind = status != PCCD_OK;
    return status;
}

/* ---- the log ----------------------------------------------------------------------- */

static int tell_gone(struct replayer *replayer, const struct record_view *view,
                     struct ctl_error *error)
{
    struct record_gone gone;
    memcpy(&gone, view->payload, sizeof gone);
    int status = view->kind == RECORD_MESH_GONE
                     ? pccd_mesh_destroy(replayer->client, gone.mesh)
                 : view->kind == RECORD_SCENE_GONE
                     ? pccd_scene_destroy(replayer->client, gone.scene)
                     : pccd_scene_remove(replayer->client, gone.scene, gone.object);
    return status == PCCD_OK ? status
                             : failed(replayer, status, "a recorded removal", error);
}

static int tell_pairs(struct replayer *replayer, const struct record_view *view,
                      struct ctl_error *error)
{
    struct record_pairs head;
    int status = PCCD_OK;
    memcpy(&head, view->payload, sizeof head);
    for (uint32_t i = 0; i < head.count && status == PCCD_OK; i++) {
        const struct registry_pair said = recorded_pair(view, i);
        status = tell_pair(replayer, head.scene, &said, error);
    }
    return status;
}

int replayer_follow(struct replayer *replayer, struct registry *state,
                    const struct record_view *view, struct ctl_error *error)
{
    const uint32_t making = 1u << RECORD_MESH | 1u << RECORD_SCENE | 1u << RECORD_OBJECT |
                            1u << RECORD_GUEST | 1u << RECORD_FILTER;
    const uint32_t taking =
        1u << RECORD_SCENE_GONE | 1u << RECORD_MESH_GONE | 1u << RECORD_OBJECT_GONE;
    bool is_gone = (taking >> view->kind & 1u) != 0;
    bool tells_now = replayer->client != NULL && (is_gone || view->kind == RECORD_PAIRS);
    int status = PCCD_OK;
    /* What goes was there for the daemon, too, and so was what ignores each other. */
    if (tells_now && replayer->is_behind) {
        status = tell(replayer, state, error);
    }
    if (status == PCCD_OK) {
        status = recorded_state_follow(state, view, error);
    }
    replayer->is_behind = replayer->is_behind || (making >> view->kind & 1u) != 0;
    if (status != PCCD_OK || !tells_now) {
        return status;
    }
    return is_gone ? tell_gone(replayer, view, error) : tell_pairs(replayer, view, error);
}

/* ---- what moves -------------------------------------------------------------------- */

static bool add_motion(struct replayer *replayer, uint32_t *count,
                       const struct pccd_motion *motion)
{
    if (!array_reserve((void **)&replayer->motions, *count, &replayer->motion_room,
                       sizeof *replayer->motions)) {
        return false;
    }
    replayer->motions[(*count)++] = *motion;
    return true;
}

/* Give the daemon what an item moves. */
static bool take_segments(struct replayer *replayer, const struct recorded_item *item,
                          uint32_t *count)
{
    bool fits = true;
    for (uint32_t i = 0; i < item->frame.segment_count && fits; i++) {
        struct record_segment segment;
        memcpy(&segment, item->slot + i * sizeof segment, sizeof segment);
        const void *begin = item->slot + segment.offset0;
        const void *end = item->slot + segment.offset1;
        struct pccd_motion motion = {.object = segment.object,
                                     .first = segment.first,
                                     .count = segment.count,
                                     .format = (enum pccd_format)segment.format};
        if (segment.kind == RECORD_RIGID) {
            motion.m0 = begin;
            motion.m1 = end;
        } else if (segment.kind == RECORD_ON_JOINT) {
            fits = recorded_joints_take(&replayer->joints, item->slot, &segment,
                                        &motion.first);
        } else {
            motion.x0 = segment.kind == RECORD_X0X1 ? begin : NULL;
            motion.x1 = end;
        }
        fits = fits && add_motion(replayer, count, &motion);
    }
    return fits;
}

/* All that has ever moved in a scene, to where it is; from where it was before the last
 * step, or from where the daemon has it. */
static bool take_places(struct replayer *replayer, const struct registry_scene *scene,
                        bool from_begin, uint32_t *count)
{
    bool fits = true;
    for (uint32_t i = 0; i < scene->object_count && fits; i++) {
        const struct registry_object *object = &scene->objects[i];
        const struct pccd_motion motion = {.object = object->handle,
                                           .count = object->mesh->vertex_count,
                                           .format = PCCD_FORMAT_F64,
                                           .x0 = from_begin ? object->x0 : NULL,
                                           .x1 = object->x1};
        fits = object->placing == REGISTRY_AS_REGISTERED ||
               add_motion(replayer, count, &motion);
    }
    return fits;
}

static int no_memory(struct ctl_error *error)
{
    return ctl_error_set(error, PCCD_E_NOMEM, "no memory for what a step moves");
}

/* Bring the objects of a scene to where they are. */
static int place(struct replayer *replayer, struct registry_scene *scene,
                 struct ctl_error *error)
{
    const struct pccd_step_settings settings = {
        .struct_bytes = sizeof settings, .mode = PCCD_MODE_ANY, .deadline_ns = AT_ONCE};
    struct pccd_answer answer = PCCD_ANSWER_INIT;
    uint32_t count = 0;
    uint64_t step = 0;
    int status = PCCD_OK;
    if (!take_places(replayer, scene, false, &count)) {
        return no_memory(error);
    }
    if (count > 0) {
        status = pccd_submit(replayer->client, scene->handle, replayer->motions, count,
                             &settings, &step);
        if (status == PCCD_OK) {
            status = pccd_wait(replayer->client, step, -1, &answer);
            pccd_answer_release(replayer->client, &answer);
        }
    }
    if (status != PCCD_OK) {
        return failed(replayer, status, "a recorded place", error);
    }
    scene->is_placed = true;
    return PCCD_OK;
}

/* ---- items ------------------------------------------------------------------------- */

static int submit_step(struct replayer *replayer, const struct recorded_item *item,
                       uint32_t motion_count, uint64_t *step)
{
    const struct pccd_step_settings settings = {
        .struct_bytes = sizeof settings,
        .mode = (enum pccd_mode)item->frame.mode,
        .method = (enum pccd_method)item->frame.method,
        .threads = item->frame.threads,
        .tuning = item->frame.tuning,
        .tolerance = item->frame.tolerance,
        .deadline_ns = item->frame.deadline_ns,
        .separation = item->frame.separation,
        .approach = item->frame.approach,
        .tells_start = item->frame.tells != 0,
        .touching = (enum pccd_touching)item->frame.touching,
        .resolution = item->frame.resolution,
        .joints = replayer->joints.items,
        .joint_count = replayer->joints.count};
    return pccd_submit(replayer->client, item->frame.scene, replayer->motions,
                       motion_count, &settings, step);
}

static int submit_near(struct replayer *replayer, const struct recorded_item *item,
                       uint32_t motion_count, uint64_t *step)
{
    const struct record_frame *near = &item->frame;
    struct pccd_near_settings settings = {.struct_bytes = sizeof settings,
                                          .what = (enum pccd_near_what)near->what,
                                          .distance = near->distance,
                                          .gap = near->gap,
                                          .at_begin = near->end == 0,
                                          .object_a = near->objects[0],
                                          .object_b = near->objects[1],
                                          .threads = item->frame.threads,
                                          .tells_crossings = item->frame.tells != 0,
                                          .deadline_ns = item->frame.deadline_ns,
                                          .method = (enum pccd_method)item->frame.method,
                                          .joints = replayer->joints.items,
                                          .joint_count = replayer->joints.count};
    memcpy(settings.tuning, item->frame.tuning, sizeof settings.tuning);
    return pccd_submit_near(replayer->client, item->frame.scene, replayer->motions,
                            motion_count, &settings, step);
}

static int collect(struct replayer *replayer, const struct pccd_answer *page,
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
    size_t bytes = (replayer->record_count + page->count) * each;
    if (bytes > replayer->record_room) {
        void *larger = realloc(replayer->records, bytes + bytes / 2);
        if (larger == NULL) {
            return ctl_error_set(error, PCCD_E_NOMEM, "no memory for %" PRIu64 " records",
                                 page->total);
        }
        replayer->records = larger;
        replayer->record_room = bytes + bytes / 2;
    }
    if (page->count > 0) {
        memcpy((uint8_t *)replayer->records + replayer->record_count * each, from,
               page->count * each);
    }
    replayer->record_count += page->count;
    return PCCD_OK;
}

/* Wait for what was submitted, or could not be, and take its records. */
static int take_answer(struct replayer *replayer, uint32_t scene, uint64_t step,
                       int submitted, bool collects, struct ctl_error *error)
{
    struct pccd_answer page = {.step = 0};
    int status = submitted;
    replayer->record_count = 0;
    if (status == PCCD_OK) {
        status = pccd_wait(replayer->client, step, -1, &page);
    }
    replayer->answer = page;
    if (status != PCCD_OK) {
        /* What the daemon says of the step is its answer; all else is our failure. */
        return page.step == step && step != 0 ? PCCD_OK
                                              : failed(replayer, status, "a step", error);
    }
    status = collects ? collect(replayer, &page, error) : PCCD_OK;
    while (status == PCCD_OK && collects && page.cursor < page.total && page.count > 0) {
        pccd_answer_release(replayer->client, &page);
        status = pccd_fetch(replayer->client, scene, step, page.cursor, &page);
        status = status == PCCD_OK ? collect(replayer, &page, error)
                                   : failed(replayer, status, "a page of records", error);
    }
    pccd_answer_release(replayer->client, &page);
    return status;
}

int replayer_ask(struct replayer *replayer, struct registry *state,
                 const struct recorded_item *item, bool collects, struct ctl_error *error)
{
    int status = replayer->is_behind ? tell(replayer, state, error) : PCCD_OK;
    struct registry_scene *scene = registry_scene(state, item->frame.scene);
    /* A question about where the last movement began: it is made once more, with it. */
    bool repeats = scene != NULL && item->is_near && item->frame.segment_count == 0 &&
                   common_near_reads_begin(item->frame.what, item->frame.end) &&
                   !scene->has_begin;
    uint32_t count = 0;
    uint64_t step = 0;
    if (status == PCCD_OK && scene != NULL && !scene->is_placed && !repeats) {
        status = place(replayer, scene, error);
    }
    if (status != PCCD_OK) {
        return status;
    }
    recorded_joints_deinit(&replayer->joints);
    if (!(repeats ? take_places(replayer, scene, true, &count)
                  : take_segments(replayer, item, &count))) {
        return no_memory(error);
    }
    status = item->is_near ? submit_near(replayer, item, count, &step)
                           : submit_step(replayer, item, count, &step);
    status = take_answer(replayer, item->frame.scene, step, status, collects, error);
    if (status == PCCD_OK && replayer->answer.status == PCCD_OK && scene != NULL &&
        (count > 0 || !item->is_near)) {
        scene->is_placed = scene->has_begin = true;
    }
    return status;
}

void replayer_deinit(struct replayer *replayer)
{
    free(replayer->records);
    free(replayer->motions);
    recorded_joints_deinit(&replayer->joints);
    *replayer = (struct replayer){.records = NULL};
}

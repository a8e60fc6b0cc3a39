/* scene.c - meshes from files: read together, registered together. */
#include "scene.h"

#include <ctype.h>
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "array.h"
#include "clock.h"
#include "coordinates.h"
#include "ctl.h"
#include "link.h"
#include "shown.h"

static int no_memory(struct ctl_error *error)
{
    return ctl_error_set(error, PCCD_E_NOMEM, "no memory for the scene");
}

/* ---- what a command line says ------------------------------------------------------ */

void scene_take_pair(struct argp_state *state, const struct option_row *row,
                     const char *text, void *to)
{
    if (strchr(text, ',') == NULL) {
        option_misused(state, "--%s: \"%s\" is not two names with a comma between them",
                       row->name, text);
    }
    option_add_text(state, (struct option_arguments *)((char *)to + row->at), text);
}

#define AT(member) offsetof(struct scene_options, member)
static const struct option_row rows[] = {
    CTL_QUESTION,
    {"with", 0, "FILE",
     "Add another object, which stands, or moves along if it has as many frames; may be "
     "repeated",
     OPTION_TEXTS, .at = AT(with)},
    {"no-self", 0, NULL, "Leave out the pairs of each object with itself", OPTION_FLAG,
     .at = AT(has_no_self)},
    {"between", 0, "A,B",
     "Ask about the pairs of these two objects alone, by their names: those of the scene "
     "file, or those of their first files without folder and ending; may be repeated",
     OPTION_OWN, .at = AT(between), .take = scene_take_pair},
    {0}};
#undef AT

const struct option_table scene_table = {.name = "SCENE", .rows = rows};

void scene_options_deinit(struct scene_options *options)
{
    free(options->with.list);
    free(options->between.list);
}

/* ---- what is in it ----------------------------------------------------------------- */

uint32_t scene_find(const struct scene *scene, const char *name)
{
    uint32_t i = 0;
    while (i < scene->object_count && strcmp(scene->objects[i].name, name) != 0) {
        i++;
    }
    return i;
}

uint32_t scene_place_of(const struct scene *scene, uint32_t handle)
{
    uint32_t i = 0;
    while (i < scene->object_count && scene->objects[i].handle != handle) {
        i++;
    }
    return i;
}

int scene_append(struct scene *scene, struct scene_object **object,
                 struct ctl_error *error)
{
    void *objects = scene->objects;
    if (scene->object_count == SCENE_OBJECTS_MAX) {
        return ctl_error_set(error, PCCD_E_LIMIT, "a scene has at most %u objects",
                             SCENE_OBJECTS_MAX);
    }
    if (!array_reserve(&objects, scene->object_count, &scene->object_room,
                       sizeof *scene->objects)) {
        return no_memory(error);
    }
    scene->objects = objects;
    *object = &scene->objects[scene->object_count++];
    **object = (struct scene_object){.unit = 1, .frames = *scene->frames};
    if (scene->settings != NULL) {
        (*object)->settings = *scene->settings;
    }
    return PCCD_OK;
}

static int add_pair(struct scene *scene, const struct scene_pair *pair,
                    struct ctl_error *error)
{
    void *pairs = scene->pairs;
    if (!array_reserve(&pairs, scene->pair_count, &scene->pair_room,
                       sizeof *scene->pairs)) {
        return no_memory(error);
    }
    scene->pairs = pairs;
    scene->pairs[scene->pair_count++] = *pair;
    return PCCD_OK;
}

int scene_ignore(struct scene *scene, uint32_t a, uint32_t b, struct ctl_error *error)
{
    return add_pair(scene, &(struct scene_pair){{a, b}, .is_ignored = true}, error);
}

int scene_keep_clearance(struct scene *scene, uint32_t a, uint32_t b, double clearance,
                         struct ctl_error *error)
{
    return add_pair(scene, &(struct scene_pair){{a, b}, .clearance = clearance}, error);
}

/* A name for an object from a file, which no other one has. */
static char *name_from(const struct scene *scene, const char *path)
{
    const char *slash = strrchr(path, '/');
    const char *file = slash != NULL ? slash + 1 : path;
    const char *dot = strrchr(file, '.');
    size_t length = dot != NULL && dot > file ? (size_t)(dot - file) : strlen(file);
    const char *number = memchr(file, '%', length); /* of a pattern */
    length = number != NULL && number > file ? (size_t)(number - file) : length;
    char *name = malloc(length + 16);
    for (uint32_t i = 1; name != NULL; i++) {
        snprintf(name, length + 16, i == 1 ? "%.*s" : "%.*s-%" PRIu32, (int)length, file,
                 i);
        if (scene_find(scene, name) == scene->object_count) {
            break;
        }
    }
    return name;
}

int scene_add(struct scene *scene, char *const *paths, uint32_t path_count,
              struct ctl_error *error)
{
    char *name = name_from(scene, paths[0]);
    struct scene_object *object;
    int status = name != NULL ? scene_append(scene, &object, error) : no_memory(error);
    if (status != PCCD_OK) {
        free(name);
        return status;
    }
    object->name = name;
    object->paths = calloc(path_count, sizeof *object->paths);
    for (uint32_t i = 0; object->paths != NULL && i < path_count; i++) {
        object->paths[i] = strdup(paths[i]);
        object->path_count += object->paths[i] != NULL;
    }
    return object->path_count == path_count ? PCCD_OK : no_memory(error);
}

/* Find the objects of "A,B", whose names may have commas, too. */
static bool find_two(const struct scene *scene, const char *text, uint32_t pair[2])
{
    for (uint32_t i = 0; i < scene->object_count; i++) {
        size_t length = strlen(scene->objects[i].name);
        if (strncmp(text, scene->objects[i].name, length) == 0 && text[length] == ',') {
            pair[0] = i;
            pair[1] = scene_find(scene, text + length + 1);
            if (pair[1] < scene->object_count) {
                return true;
            }
        }
    }
    return false;
}

/* Return whether one of the pairs is of a and b. */
static bool are_between(const uint32_t (*pairs)[2], size_t count, uint32_t a, uint32_t b)
{
    for (size_t i = 0; i < count; i++) {
        if ((pairs[i][0] == a && pairs[i][1] == b) ||
            (pairs[i][0] == b && pairs[i][1] == a)) {
            return true;
        }
    }
    return false;
}

bool scene_is_met(const struct pccd_object_settings *of,
                  const struct pccd_object_settings *by)
{
    uint64_t group = (of->what & PCCD_OBJECT_GROUP) != 0 ? of->group : 1;
    return (by->what & PCCD_OBJECT_MASK) == 0 || (group & by->mask) != 0;
}

/* Return whether an object may meet one that comes after it; `passed` has room to mark
 * those that the two let pass. */
static bool may_meet_any(const struct scene *scene, uint32_t a, bool *passed)
{
    const struct pccd_object_settings *its = &scene->objects[a].settings;
    bool may = false;
    memset(passed, 0, scene->object_count * sizeof *passed);
    for (size_t i = 0; i < scene->pair_count; i++) {
        const uint32_t *of = scene->pairs[i].objects;
        if (scene->pairs[i].is_ignored && (of[0] == a || of[1] == a)) {
            passed[of[0] == a ? of[1] : of[0]] = true;
        }
    }
    for (uint32_t b = a + 1; b < scene->object_count && !may; b++) {
        const struct pccd_object_settings *other = &scene->objects[b].settings;
        may = !passed[b] && scene_is_met(its, other) && scene_is_met(other, its);
    }
    return may;
}

static bool meets_itself(const struct pccd_object_settings *its)
{
    return (its->what & PCCD_OBJECT_SELF) == 0 || its->self_collision;
}

const char *scene_idle(const struct scene *scene, bool with_self)
{
    bool *passed = calloc(scene->object_count + 1, sizeof *passed);
    bool may = passed == NULL; /* what comes next ends for want of memory, too */
    for (uint32_t a = 0; a < scene->object_count && !may; a++) {
        may = (with_self && meets_itself(&scene->objects[a].settings)) ||
              may_meet_any(scene, a, passed);
    }
    free(passed);
    return may ? NULL : "no two objects may meet, nor one itself: nothing is compared";
}

/* Let all pairs ignore each other, and themselves, that are not given. What is in none
 * meets nothing. */
static int leave_between(struct scene *scene, const uint32_t (*pairs)[2], size_t count,
                         struct ctl_error *error)
{
    int status = PCCD_OK;
    for (uint32_t i = 0; i < scene->object_count; i++) {
        struct pccd_object_settings *settings = &scene->objects[i].settings;
        settings->self_collision =
            meets_itself(settings) && are_between(pairs, count, i, i);
        settings->what |= PCCD_OBJECT_SELF;
        bool is_named = false;
        for (size_t k = 0; k < 2 * count && !is_named; k++) {
            is_named = pairs[k / 2][k % 2] == i;
        }
        if (!is_named) {
            settings->what |= PCCD_OBJECT_MASK;
            settings->mask = 0;
        }
    }
    for (size_t k = 0; k < 4 * count * count && status == PCCD_OK; k++) {
        size_t first = k / (2 * count), second = k % (2 * count);
        uint32_t a = pairs[first / 2][first % 2], b = pairs[second / 2][second % 2];
        if (a < b && !are_between(pairs, count, a, b)) {
            status = scene_ignore(scene, a, b, error);
        }
    }
    return status;
}

static int pick_between(struct scene *scene, const struct option_arguments *between,
                        struct ctl_error *error)
{
    uint32_t(*pairs)[2] = calloc(between->count, sizeof *pairs);
    int status = pairs != NULL ? PCCD_OK : no_memory(error);
    for (size_t i = 0; status == PCCD_OK && i < between->count; i++) {
        if (!find_two(scene, between->list[i], pairs[i])) {
            status = ctl_error_set(error, PCCD_E_INVAL,
                                   "--between: \"%s\" does not name two objects",
                                   tool_shown(between->list[i]));
        }
    }
    if (status == PCCD_OK) {
        status = leave_between(scene, (const uint32_t(*)[2])pairs, between->count, error);
    }
    free(pairs);
    return status;
}

int scene_take(struct scene *scene, const struct option_arguments *files, bool each,
               const struct scene_options *options, struct ctl_error *error)
{
    int status = PCCD_OK;
    scene->last = UINT32_MAX;
    if (files->count == 1 && scene_is_named(files->list[0])) {
        status = scene_read_file(scene, files->list[0], error);
    } else if (!each) {
        status = scene_add(scene, files->list, files->count, error);
    }
    for (uint32_t i = 0;
         each && scene->path == NULL && status == PCCD_OK && i < files->count; i++) {
        status = scene_add(scene, &files->list[i], 1, error);
    }
    for (size_t i = 0; status == PCCD_OK && i < options->with.count; i++) {
        status = scene_add(scene, &options->with.list[i], 1, error);
    }
    for (uint32_t i = 0; options->has_no_self && i < scene->object_count; i++) {
        scene->objects[i].settings.what |= PCCD_OBJECT_SELF;
        scene->objects[i].settings.self_collision = false;
    }
    return status == PCCD_OK && options->between.count > 0
               ? pick_between(scene, &options->between, error)
               : status;
}

/* ---- files ------------------------------------------------------------------------- */

/* Say behind an error which object of the scene file it is about. */
static int blame(const struct scene *scene, const struct scene_object *object, int status,
                 struct ctl_error *error)
{
    struct ctl_error what = *error;
    return status == PCCD_OK || object->line == 0
               ? status
               : ctl_error_set(error, status, "%s:%" PRIu32 ": object \"%s\": %.800s",
                               scene->path, object->line, tool_shown(object->name),
                               what.text);
}

/* Frames of an object that are frames of the scene. */
static uint32_t frames_of(const struct scene *scene, const struct scene_object *object)
{
    uint32_t last =
        scene->last < object->files.count - 1 ? scene->last : object->files.count - 1;
    return object->files.count == 1 || last < scene->first ? 1 : last - scene->first + 1;
}

static int open_object(struct scene *scene, uint32_t index, struct ctl_error *error)
{
    struct scene_object *object = &scene->objects[index];
    object->frames.first_alone = scene->first_alone;
    int status = ctl_frames_open(&object->files, object->paths, object->path_count,
                                 &object->frames, error);
    ctl_sequence_warn(&object->files.sequence);
    if (status != PCCD_OK) {
        return blame(scene, object, status, error);
    }
    uint32_t count = object->files.count;
    if (count > 1 && scene->first >= count) {
        status = ctl_error_set(error, PCCD_E_INVAL,
                               "the first frame is %" PRIu32 ", and there are %" PRIu32,
                               scene->first, count);
    } else if (count > 1 && scene->mover == scene->object_count) {
        scene->mover = index;
        scene->count = frames_of(scene, object);
    } else if (count > 1 && frames_of(scene, object) != scene->count &&
               !scene->first_alone) {
        status = ctl_error_set(
            error, PCCD_E_INVAL, "%" PRIu32 " frames, and \"%s\" has %" PRIu32,
            frames_of(scene, object), tool_shown(scene->objects[scene->mover].name),
            scene->count);
    }
    return blame(scene, object, status, error);
}

int scene_open(struct scene *scene, struct ctl_error *error)
{
    int status = PCCD_OK;
    scene->mover = scene->object_count;
    scene->count = 1;
    for (uint32_t i = 0; i < scene->object_count && status == PCCD_OK; i++) {
        status = open_object(scene, i, error);
    }
    return status;
}

/* Take the positions that came with the shape, which nobody else needs. */
static void take_first(struct scene_object *object, struct ctl_mesh *frame)
{
    frame->x = object->files.mesh.x;
    frame->format = object->files.mesh.format;
    frame->vertex_count = object->files.mesh.vertex_count;
    object->files.mesh.x = NULL;
}

int scene_read_object(struct scene *scene, struct scene_object *object, uint32_t index,
                      struct ctl_mesh *frame, struct ctl_error *error)
{
    uint32_t of_file = object->files.count > 1 ? scene->first + index : 0;
    int status = PCCD_OK;
    if (scene->first_alone && of_file == 0) {
        take_first(object, frame);
    } else {
        status = ctl_frames_read(&object->files, of_file, frame, error);
    }
    if (status == PCCD_OK && object->unit != 1) {
        status = ctl_mesh_promote(frame, error);
        double *x = frame->x;
        for (size_t i = 0; status == PCCD_OK && i < (size_t)frame->vertex_count * 3;
             i++) {
            x[i] *= object->unit;
        }
    }
    return blame(scene, object, status, error);
}

int scene_read(struct scene *scene, uint32_t index, struct ctl_error *error)
{
    int status = PCCD_OK;
    for (uint32_t i = 0; i < scene->object_count && status == PCCD_OK; i++) {
        struct scene_object *object = &scene->objects[i];
        struct ctl_mesh *frame = &object->at[index % SCENE_FRAMES];
        if (object->files.count == 1 && index > 0) {
            continue;
        }
        status = scene_read_object(scene, object, index, frame, error);
        bool is_double = false;
        for (uint32_t k = 0; k < SCENE_FRAMES; k++) {
            const struct ctl_mesh *at = &object->at[k];
            is_double = is_double || (at->x != NULL && at->format == PCCD_FORMAT_F64);
        }
        for (uint32_t k = 0; k < SCENE_FRAMES && is_double && status == PCCD_OK; k++) {
            if (object->at[k].x != NULL) {
                status = ctl_mesh_promote(&object->at[k], error);
            }
        }
    }
    return status;
}

const char *scene_frame_name(const struct scene *scene, uint32_t index)
{
    uint32_t mover = scene->mover < scene->object_count ? scene->mover : 0;
    const struct ctl_frames *files = &scene->objects[mover].files;
    return files->names[files->count > 1 ? scene->first + index : 0];
}

/* ---- the daemon -------------------------------------------------------------------- */

static int fail(const struct scene *scene, const struct scene_object *object,
                const struct pccd_client *client, int status, struct ctl_error *error)
{
    const char *text = pccd_error_text(client);
    (void)ctl_error_set(error, status, "%s was not accepted: %s",
                        tool_shown(object->files.mesh.path),
                        text[0] != '\0' ? text : pccd_status_text(status));
    return blame(scene, object, status, error);
}

int scene_put_mesh(struct pccd_client *client, const struct ctl_mesh *mesh,
                   uint32_t *handle, struct pccd_mesh_info *info)
{
    const struct pccd_mesh_data data = {.struct_bytes = sizeof data,
                                        .x = mesh->x,
                                        .format = mesh->format,
                                        .vertex_count = mesh->vertex_count,
                                        .triangle_count = mesh->triangles.count,
                                        .triangles = mesh->triangles.vertices,
                                        .edges = mesh->edges.vertices,
                                        .points = mesh->points.vertices,
                                        .edge_count = mesh->edges.count,
                                        .point_count = mesh->points.count};
    *handle = 0;
    return pccd_mesh_put(client, &data, handle, info);
}

int scene_edges(struct scene_object *object, struct pccd_client *client)
{
    uint32_t count = object->info.edge_count;
    if (object->edges != NULL) {
        return PCCD_OK;
    }
    /* A mesh of points has no edges; malloc(0) may be NULL. */
    object->edges = malloc(((size_t)count + 1) * sizeof *object->edges);
    return object->edges != NULL
               ? pccd_mesh_edges(client, object->mesh, object->edges, count)
               : PCCD_E_NOMEM;
}

static int place(struct scene *scene, struct scene_object *object,
                 struct pccd_client *client, uint32_t handle, bool with_edges,
                 struct ctl_error *error)
{
    struct ctl_mesh first = object->files.mesh;
    first.x = object->at[0].x;
    first.format = object->at[0].format;
    uint64_t begin_ns = common_now_ns();
    int status = scene_put_mesh(client, &first, &object->mesh, &object->info);
    if (status == PCCD_OK) {
        status = pccd_scene_add(client, handle, object->mesh, &object->handle);
    }
    if (status == PCCD_OK) {
        status = ctl_name_object(client, handle, object->handle, object->name);
    }
    if (status == PCCD_OK && object->settings.what != 0) {
        status = pccd_object_set(client, handle, object->handle, &object->settings);
    }
    scene->build_ms += (double)(common_now_ns() - begin_ns) / 1e6;
    if (status == PCCD_OK && with_edges) {
        status = scene_edges(object, client);
    }
    return status == PCCD_OK ? PCCD_OK : fail(scene, object, client, status, error);
}

int scene_place(struct scene *scene, struct pccd_client *client, uint32_t handle,
                bool with_edges, struct ctl_error *error)
{
    int status = PCCD_OK;
    for (uint32_t i = 0; i < scene->object_count && status == PCCD_OK; i++) {
        status = place(scene, &scene->objects[i], client, handle, with_edges, error);
    }
    for (size_t i = 0; i < scene->pair_count && status == PCCD_OK; i++) {
        const struct scene_pair *pair = &scene->pairs[i];
        const struct scene_object *a = &scene->objects[pair->objects[0]];
        const struct scene_object *b = &scene->objects[pair->objects[1]];
        status = pair->is_ignored
                     ? pccd_pair_ignore(client, handle, a->handle, b->handle, true)
                     : pccd_pair_clearance(client, handle, a->handle, b->handle,
                                           pair->clearance);
        if (status != PCCD_OK) {
            (void)fail(scene, a, client, status, error);
        }
    }
    return status;
}

int scene_corners(struct scene_object *object, struct pccd_client *client,
                  uint32_t points, uint32_t feature, uint32_t corners[3])
{
    const struct ctl_mesh *mesh = &object->files.mesh;
    uint32_t counts[4] = {0, mesh->vertex_count, object->info.edge_count,
                          mesh->triangles.count};
    if (feature >= counts[points]) {
        return PCCD_E_FORMAT;
    }
    int status = points == 2 ? scene_edges(object, client) : PCCD_OK;
    for (uint32_t i = 0; i < points && status == PCCD_OK; i++) {
        corners[i] = points == 1 ? feature
                     : points == 2
                         ? (i == 0 ? object->edges[feature].a : object->edges[feature].b)
                         : mesh->triangles.vertices[3 * (size_t)feature + i];
    }
    return status;
}

void scene_vertices(const struct ctl_mesh *frame, uint32_t points,
                    const uint32_t corners[3], double (*at)[3])
{
    for (size_t i = 0; i < points; i++) {
        for (size_t k = 0; k < 3; k++) {
            at[i][k] =
                common_coordinate(frame->x, frame->format, 3 * (size_t)corners[i] + k);
        }
    }
}

int scene_feature(struct scene_object *object, struct pccd_client *client, uint32_t index,
                  uint32_t points, uint32_t feature, struct place_feature *ends)
{
    const struct ctl_mesh *to = scene_at(object, index);
    int status = scene_corners(object, client, points, feature, ends->corners);
    if (status == PCCD_OK) {
        scene_vertices(index > 0 ? scene_at(object, index - 1) : to, points,
                       ends->corners, ends->from);
        scene_vertices(to, points, ends->corners, ends->to);
    }
    return status;
}

uint32_t scene_motions(const struct scene *scene, uint32_t index, bool is_again,
                       struct pccd_motion *motions)
{
    uint32_t count = 0;
    for (uint32_t i = 0; i < scene->object_count; i++) {
        const struct scene_object *object = &scene->objects[i];
        const struct ctl_mesh *after = scene_at(object, index);
        if (object->files.count > 1) {
            motions[count++] = (struct pccd_motion){
                .object = object->handle,
                .count = after->vertex_count,
                .format = after->format,
                .x0 = is_again ? scene_at(object, index - 1)->x : NULL,
                .x1 = after->x};
        }
    }
    return count;
}

void scene_name_objects(const struct scene *scene, struct ctl_error *error)
{
    for (uint32_t i = 0; i < scene->object_count; i++) {
        struct ctl_error named = {.text = ""};
        char word[32];
        int length =
            snprintf(word, sizeof word, "object 0x%" PRIx32, scene->objects[i].handle);
        const char *at = strstr(error->text, word);
        if (at != NULL && !isxdigit((unsigned char)at[length])) {
            (void)ctl_error_set(&named, PCCD_OK, "%.*s%s%s", (int)(at - error->text),
                                error->text, scene->objects[i].paths[0], at + length);
            *error = named;
        }
    }
}

void scene_close(struct scene *scene)
{
    for (uint32_t i = 0; i < scene->object_count; i++) {
        struct scene_object *object = &scene->objects[i];
        for (uint32_t k = 0; k < object->path_count; k++) {
            free(object->paths[k]);
        }
        ctl_frames_close(&object->files);
        for (uint32_t k = 0; k < SCENE_FRAMES; k++) {
            ctl_mesh_deinit(&object->at[k]);
        }
        free(object->paths);
        free(object->name);
        free(object->animation);
        free(object->joint);
        free(object->edges);
    }
    for (uint32_t i = 0; i < scene->joint_count; i++) {
        free(scene->joints[i].name);
        free(scene->joints[i].parent);
        free(scene->joints[i].follows);
    }
    free(scene->joints);
    free(scene->objects);
    free(scene->pairs);
    free(scene->path);
    *scene = (struct scene){.path = NULL};
}

/* client/ctl/mesh/gltf_motion.c - a glTF 2.0 file as mesh and frames.
 *
 * Room:     client/ctl.
 * Does:     one frame as a mesh, or all, one at a time.
 * Threads:  one at a time.
 * Source:   meshfile.h, motion.h.
 */
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "gltf_scene.h"
#include "motion.h"

#define TURN_DEGREES 1.0 /* between two frames, beyond which it is told */

struct gltf_state {
    char *path;
    struct ctl_file file;
    struct gltf_scene scene;
};

/* Make doubles floats, in their place, if that is exact. */
static void narrow(struct ctl_mesh *mesh)
{
    double *wide = mesh->x;
    size_t count = (size_t)mesh->vertex_count * 3;
    for (size_t i = 0; i < count; i++) {
        if ((double)(float)wide[i] != wide[i]) {
            return;
        }
    }
    for (size_t i = 0; i < count; i++) {
        float value = (float)wide[i];
        memcpy((char *)mesh->x + i * sizeof value, &value, sizeof value);
    }
    void *less = realloc(mesh->x, count * sizeof(float));
    mesh->x = less != NULL ? less : mesh->x;
    mesh->format = PCCD_FORMAT_F32;
}

/* The shape, and the positions of the first frame. */
static int make_mesh(struct gltf_scene *scene, struct ctl_mesh *mesh)
{
    int status = gltf_scene_add(scene, mesh);
    if (status == PCCD_OK) {
        status = ctl_mesh_alloc_vertices(mesh, PCCD_FORMAT_F64, scene->vertex_count);
    }
    return status == PCCD_OK ? gltf_scene_place(scene, 0, mesh->x) : status;
}

int ctl_gltf_parse(struct ctl_file *file, struct ctl_mesh *mesh)
{
    struct gltf_scene scene;
    int status = ctl_file_load(file, mesh->error);
    if (status != PCCD_OK) {
        return status;
    }
    status = gltf_scene_open(file, NULL, mesh->error, &scene);
    bool is_pipe = file->is_open && file->size == 0;
    if (status == PCCD_OK && is_pipe && scene.animation.frame_count > 1) {
        status = gltf_fail(&scene.gltf, PCCD_E_FORMAT,
                           "has %" PRIu32 " frames, and a pipe is one: name a file",
                           scene.animation.frame_count);
    }
    if (status == PCCD_OK) {
        status = make_mesh(&scene, mesh);
    }
    if (status == PCCD_OK) {
        narrow(mesh);
    }
    gltf_scene_close(&scene);
    return status;
}

/* ---- frames ------------------------------------------------------------------------ */

static void name_frame(const struct ctl_motion *motion, uint32_t frame, char *text,
                       size_t bytes)
{
    const struct gltf_state *state = motion->state;
    gltf_scene_name(&state->scene, frame, text, bytes);
}

static int read_frame(const struct ctl_motion *motion, uint32_t frame, void *x,
                      struct ctl_error *error)
{
    struct gltf_state *state = motion->state;
    struct ctl_error why;
    state->scene.gltf.error = &why;
    int status = gltf_scene_place(&state->scene, frame, x);
    if (status != PCCD_OK) {
        char name[64];
        name_frame(motion, frame, name, sizeof name);
        ctl_error_set(error, status, "%s (%s)", why.text, name);
    }
    return status;
}

static int read_shape(const struct ctl_motion *motion, struct ctl_mesh *mesh)
{
    struct gltf_state *state = motion->state;
    state->scene.gltf.error = mesh->error;
    int status = make_mesh(&state->scene, mesh);
    if (status == PCCD_OK && motion->frame_count == 1) {
        narrow(mesh);
    }
    return status;
}

static bool note(const struct ctl_motion *motion, char *text, size_t bytes)
{
    const struct gltf_state *state = motion->state;
    const struct gltf_animation *animation = &state->scene.animation;
    char name[64] = "";
    size_t length = 0;
    text[0] = '\0';
    if (animation->read_count < animation->moving_count) {
        const json_t *json =
            gltf_entry(&state->scene.gltf, "animations", animation->first);
        const json_t *named = json_object_get(json, "name");
        snprintf(name, sizeof name, "%s",
                 json_is_string(named) ? json_string_value(named) : "");
        length = (size_t)snprintf(text, bytes,
                                  "animation %" PRId64 " \"%s\" of %zu is read; "
                                  "--animation NAME takes another",
                                  animation->first, name, animation->moving_count);
    }
    if (length < bytes &&
        (animation->turn_degrees > TURN_DEGREES || animation->is_curved)) {
        snprintf(text + length, bytes - length,
                 "%s%s between two keyframes (up to %.3g degrees): --rate N has frames "
                 "between them",
                 length > 0 ? "; " : "",
                 animation->is_curved ? "nodes turn or curve" : "nodes turn",
                 animation->turn_degrees);
    }
    return text[0] != '\0';
}

static void close_motion(struct ctl_motion *motion)
{
    struct gltf_state *state = motion->state;
    gltf_scene_close(&state->scene);
    ctl_file_deinit(&state->file);
    free(state->path);
    free(state);
    *motion = (struct ctl_motion){.state = NULL};
}

int ctl_gltf_open(const char *path, const struct ctl_motion_wish *wish,
                  struct ctl_motion *motion, struct ctl_error *error)
{
    struct gltf_state *state = calloc(1, sizeof *state);
    struct ctl_motion opened = {.format = PCCD_FORMAT_F64,
                                .state = state,
                                .read = read_frame,
                                .shape = read_shape,
                                .name = name_frame,
                                .note = note,
                                .close = close_motion};
    char *name = strdup(path);
    if (state == NULL || name == NULL) {
        free(state);
        free(name);
        return ctl_error_set(error, PCCD_E_NOMEM, "%s: no memory", path);
    }
    state->path = name;
    int status = ctl_file_open(name, ctl_gltf_judge, &state->file, error);
    if (status == PCCD_OK) {
        status = ctl_file_load(&state->file, error);
    }
    if (status == PCCD_OK) {
        status = gltf_scene_open(&state->file, wish, error, &state->scene);
    }
    if (status != PCCD_OK) {
        close_motion(&opened);
        return status;
    }
    uint32_t frames = state->scene.animation.frame_count;
    opened.frame_count = frames > 0 ? frames : 1;
    opened.vertex_count = state->scene.vertex_count;
    *motion = opened;
    return PCCD_OK;
}

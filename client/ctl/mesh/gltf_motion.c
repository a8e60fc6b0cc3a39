/* client/ctl/mesh/gltf_motion.c - a glTF 2.0 file as mesh and frames.
 *
 * Nodes, joints and vertices are placed in doubles.
 */
#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "coordinates.h"
#include "gltf_scene.h"

#define LAST_ROW_ERROR 1e-5 /* of inverse matrices that were rounded to floats */
#define TURN_DEGREES   1.0  /* between two frames, beyond which it is told */

/* ---- places ------------------------------------------------------------------------ */

/* By translation, rotation and scale. Divided by the length at the end, so that rounded
 * quarter turns are exact. False: the rotation has no length. */
static bool place_of(const double pose[GLTF_POSE_PATHS][4], struct gltf_place *place)
{
    const double *q = pose[GLTF_ROTATION], x = q[0], y = q[1], z = q[2], w = q[3];
    double n = (x * x + y * y) + (z * z + w * w);
    const double turn[3][3] = {
        {(w * w + x * x) - (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)},
        {2 * (x * y + w * z), (w * w + y * y) - (x * x + z * z), 2 * (y * z - w * x)},
        {2 * (x * z - w * y), 2 * (y * z + w * x), (w * w + z * z) - (x * x + y * y)},
    };
    for (int row = 0; row < 3; row++) {
        for (int column = 0; column < 3; column++) {
            place->m[4 * row + column] = turn[row][column] / n * pose[GLTF_SCALE][column];
        }
        place->m[4 * row + 3] = pose[GLTF_TRANSLATION][row];
    }
    return isfinite(n) && n > 0;
}

/* By the columns of a matrix of four rows, the last of which is to be 0 0 0 1: false if
 * not. */
static bool place_of_matrix(const double columns[16], struct gltf_place *place)
{
    bool is_affine = fabs(columns[15] - 1) <= LAST_ROW_ERROR;
    for (int column = 0; column < 4; column++) {
        for (int row = 0; row < 3; row++) {
            place->m[4 * row + column] = columns[4 * column + row];
        }
        is_affine &= column == 3 || fabs(columns[4 * column + 3]) <= LAST_ROW_ERROR;
    }
    return is_affine;
}

static struct gltf_place product(const struct gltf_place *a, const struct gltf_place *b)
{
    struct gltf_place made;
    for (int i = 0; i < 12; i++) {
        const double *row = a->m + i / 4 * 4, *column = b->m + i % 4;
        made.m[i] = row[0] * column[0] + row[1] * column[4] + row[2] * column[8];
        made.m[i] = i % 4 == 3 ? made.m[i] + row[3] : made.m[i];
    }
    return made;
}

static void place_nodes(struct gltf_scene *scene)
{
    for (size_t i = 0; i < scene->node_count; i++) {
        struct gltf_node *node = &scene->nodes[scene->order[i]];
        if (!node->moves_mesh) {
            continue;
        }
        bool is_right = node->has_matrix ? place_of_matrix(node->matrix, &node->world)
                                         : place_of(node->pose, &node->world);
        gltf_check(&scene->gltf, is_right, PCCD_E_FORMAT,
                   node->has_matrix
                       ? "node %zu: the last row of its matrix is not 0 0 0 1"
                       : "node %zu: its rotation has no length",
                   scene->order[i]);
        if (node->parent >= 0) {
            node->world = product(&scene->nodes[node->parent].world, &node->world);
        }
    }
}

static void place_joints(struct gltf_scene *scene, struct gltf_skin *skin)
{
    for (size_t i = 0; skin->places != NULL && i < skin->joint_count; i++) {
        long long node = gltf_value(json_array_get(skin->joints, i), -1);
        double columns[16];
        struct gltf_place inverse;
        skin->places[i] = scene->nodes[node].world;
        if (skin->inverses.type != 0) {
            gltf_read(&skin->inverses, i, columns);
            gltf_check(&scene->gltf, place_of_matrix(columns, &inverse), PCCD_E_FORMAT,
                       "accessor %zu: the last row of matrix %zu is not 0 0 0 1",
                       skin->inverses.index, i);
            skin->places[i] = product(&skin->places[i], &inverse);
        }
    }
}

/* Where an instance is of an object that has no skin. */
static struct gltf_place place_instance(struct gltf_scene *scene,
                                        const struct gltf_object *object, size_t instance)
{
    const struct gltf_place *outer = &scene->nodes[object->node].world;
    double pose[GLTF_POSE_PATHS][4];
    struct gltf_place inner;
    if (!object->has_instances) {
        return *outer;
    }
    for (int i = 0; i < GLTF_POSE_PATHS; i++) {
        memcpy(pose[i], gltf_path_kinds[i].still, sizeof pose[i]);
        if (object->instances[i].type != 0) {
            gltf_read(&object->instances[i], instance, pose[i]);
        }
    }
    gltf_check(&scene->gltf, place_of(pose, &inner), PCCD_E_FORMAT,
               "node %zu: the rotation of instance %zu has no length", object->node,
               instance);
    return product(outer, &inner);
}

/* ---- vertices ---------------------------------------------------------------------- */

/* Where a vertex goes by its joints: their places, each by its part of the weights. */
static struct gltf_place find_blend(struct gltf *gltf, const struct gltf_run *run,
                                    const struct gltf_skin *skin, size_t vertex)
{
    double sum = 0, weights[4];
    struct gltf_place blend = {{0}};
    for (size_t set = 0; set < run->set_count; set++) {
        gltf_read(&run->weights[set], vertex, weights);
        for (size_t k = 0; k < 4; k++) {
            uint32_t joint = gltf_integer(&run->joints[set], vertex, k);
            if (!gltf_check(gltf, joint < skin->joint_count, PCCD_E_INDEX,
                            "accessor %zu: vertex %zu has joint %" PRIu32 " of %zu",
                            run->joints[set].index, vertex, joint, skin->joint_count)) {
                return blend;
            }
            sum += weights[k];
            for (int i = 0; i < 12 && weights[k] != 0; i++) {
                blend.m[i] += weights[k] * skin->places[joint].m[i];
            }
        }
    }
    gltf_check(gltf, sum > 0, PCCD_E_FORMAT,
               "accessor %zu: the weights of vertex %zu have the sum %g",
               run->weights[0].index, vertex, sum);
    /* Rounded weights have not quite the sum 1, and would draw it towards the origin. */
    for (int i = 0; i < 12 && sum != 1; i++) {
        blend.m[i] /= sum;
    }
    return blend;
}

/* A vertex of a run, moved by the morph targets. */
static void read_vertex(const struct gltf_scene *scene, const struct gltf_node *node,
                        const struct gltf_run *run, size_t vertex, double x[3])
{
    gltf_read(&run->positions, vertex, x);
    for (size_t k = 0; k < node->weight_count; k++) {
        double by[3];
        if (node->weights[k] == 0 || run->targets[k].count == 0) {
            continue;
        }
        gltf_read(&run->targets[k], vertex, by);
        for (int axis = 0; axis < 3; axis++) {
            x[axis] += node->weights[k] * by[axis];
        }
    }
    /* An export has the difference of two floats, rounded: so is their sum. */
    for (int axis = 0; axis < 3 && scene->gltf.is_export; axis++) {
        x[axis] = (double)(float)x[axis];
    }
}

/* The vertices of a run, which begin with `first`. */
static void place_run(struct gltf_scene *scene, const struct gltf_object *object,
                      const struct gltf_run *run, struct gltf_place place, size_t first,
                      double (*x)[3])
{
    struct gltf *gltf = &scene->gltf;
    for (size_t i = 0; i < run->positions.count && gltf->status == PCCD_OK; i++) {
        double from[3], *to = x[first + i];
        if (object->skin != NULL) {
            place = find_blend(gltf, run, object->skin, i);
        }
        read_vertex(scene, &scene->nodes[object->node], run, i, from);
        common_transform(place.m, from, to);
        for (int axis = 0; axis < 3; axis++) {
            gltf_check(gltf, common_is_coordinate(to[axis]), PCCD_E_NOTFINITE,
                       "vertex %zu: coordinate %c is %g; |x| <= 1e18 is needed",
                       first + i, "xyz"[axis], to[axis]);
        }
    }
}

/* Put everything where it is at a frame, and fill x[vertex_count][3]. */
static void place_all(struct gltf_scene *scene, uint32_t frame, double (*x)[3])
{
    if (scene->animation.frame_count > 0) {
        gltf_animation_pose(scene, frame);
    }
    place_nodes(scene);
    for (size_t i = 0; i < gltf_entry_count(&scene->gltf, "skins"); i++) {
        place_joints(scene, &scene->skins[i]);
    }
    for (size_t i = 0; i < scene->object_count; i++) {
        const struct gltf_object *object = &scene->objects[i];
        for (size_t k = 0; k < object->instance_count; k++) {
            const struct gltf_place place = place_instance(scene, object, k);
            for (size_t r = 0; r < object->mesh->run_count; r++) {
                const struct gltf_run *run = &object->mesh->runs[r];
                place_run(scene, object, run, place,
                          gltf_object_first(object, k) + run->first, x);
            }
        }
    }
}

/* ---- the mesh ---------------------------------------------------------------------- */

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
static void make_mesh(struct gltf_scene *scene, struct ctl_mesh *mesh)
{
    struct gltf *gltf = &scene->gltf;
    gltf_scene_load(scene);
    gltf_scene_add(scene, mesh);
    if (gltf->status == PCCD_OK) {
        gltf->status =
            ctl_mesh_alloc_vertices(mesh, PCCD_FORMAT_F64, scene->vertex_count);
    }
    if (gltf->status == PCCD_OK) {
        place_all(scene, 0, mesh->x);
    }
}

int ctl_gltf_parse(struct ctl_file *file, struct ctl_mesh *mesh)
{
    struct gltf_scene scene;
    bool is_pipe = file->is_open && file->size == 0;
    gltf_scene_open(file, NULL, mesh->error, &scene);
    gltf_check(&scene.gltf, !is_pipe || scene.animation.frame_count <= 1, PCCD_E_FORMAT,
               "has %" PRIu32 " frames, and a pipe is one: name a file",
               scene.animation.frame_count);
    make_mesh(&scene, mesh);
    int status = scene.gltf.status;
    if (status == PCCD_OK) {
        narrow(mesh);
    }
    gltf_close(&scene.gltf);
    return status;
}

/* ---- frames ------------------------------------------------------------------------ */

struct state {
    struct ctl_file file;
    struct gltf_scene scene;
    char path[];
};

static void name_frame(const struct ctl_motion *motion, uint32_t frame, char *text,
                       size_t bytes)
{
    const struct state *state = motion->state;
    const struct gltf_animation *animation = &state->scene.animation;
    if (animation->frame_count == 0) {
        snprintf(text, bytes, "at rest");
        return;
    }
    /* As few digits as tell keys apart, which are floats in the file. */
    double time = gltf_animation_time(animation, frame);
    int digits = 6;
    do {
        snprintf(text, bytes, "%.*g s", digits, time);
    } while (digits++ < 9 && (float)strtod(text, NULL) != (float)time);
}

static int read_frame(const struct ctl_motion *motion, uint32_t frame, void *x,
                      struct ctl_error *error)
{
    struct gltf_scene *scene = &((struct state *)motion->state)->scene;
    struct ctl_error why;
    scene->gltf.error = &why;
    scene->gltf.status = PCCD_OK;
    place_all(scene, frame, x);
    if (scene->gltf.status != PCCD_OK) {
        char name[64];
        name_frame(motion, frame, name, sizeof name);
        ctl_error_set(error, scene->gltf.status, "%s (%s)", why.text, name);
    }
    return scene->gltf.status;
}

static int read_shape(const struct ctl_motion *motion, struct ctl_mesh *mesh)
{
    struct gltf_scene *scene = &((struct state *)motion->state)->scene;
    scene->gltf.error = mesh->error;
    scene->gltf.status = PCCD_OK;
    make_mesh(scene, mesh);
    if (scene->gltf.status == PCCD_OK && motion->frame_count == 1) {
        narrow(mesh);
    }
    return scene->gltf.status;
}

static bool note(const struct ctl_motion *motion, char *text, size_t bytes)
{
    const struct gltf_scene *scene = &((const struct state *)motion->state)->scene;
    const struct gltf_animation *animation = &scene->animation;
    size_t length = 0;
    text[0] = '\0';
    if (animation->read_count < animation->moving_count) {
        const json_t *entry =
            gltf_entry(&scene->gltf, "animations", (long long)animation->first);
        const char *name = json_string_value(json_object_get(entry, "name"));
        length = (size_t)snprintf(text, bytes,
                                  "animation %zu \"%.63s\" of %zu is read; "
                                  "--animation NAME takes another",
                                  animation->first, name != NULL ? name : "",
                                  animation->moving_count);
    }
    if (length < bytes &&
        (animation->turn_degrees > TURN_DEGREES || animation->is_curved)) {
        snprintf(
            text + length, bytes - length,
            "%snodes turn%s between two keyframes (up to %.3g degrees): --rate N has "
            "frames between them",
            length > 0 ? "; " : "", animation->is_curved ? " or curve" : "",
            animation->turn_degrees);
    }
    return text[0] != '\0';
}

static void close_motion(struct ctl_motion *motion)
{
    struct state *state = motion->state;
    gltf_close(&state->scene.gltf);
    ctl_file_deinit(&state->file);
    free(state);
    *motion = (struct ctl_motion){.state = NULL};
}

int ctl_gltf_open(const char *path, const struct ctl_motion_wish *wish,
                  struct ctl_motion *motion, struct ctl_error *error)
{
    struct state *state = calloc(1, sizeof *state + strlen(path) + 1);
    if (state == NULL) {
        return ctl_error_set(error, PCCD_E_NOMEM, "%s: no memory", path);
    }
    struct gltf_scene *scene = &state->scene;
    struct ctl_motion opened = {.format = PCCD_FORMAT_F64,
                                .state = state,
                                .read = read_frame,
                                .shape = read_shape,
                                .name = name_frame,
                                .note = note,
                                .close = close_motion};
    strcpy(state->path, path);
    int status = ctl_file_open(state->path, ctl_gltf_judge, &state->file, error);
    if (status == PCCD_OK) {
        gltf_scene_open(&state->file, wish, error, scene);
        if (scene->animation.frame_count > 1) {
            gltf_scene_load(scene);
        }
        status = scene->gltf.status;
    }
    if (status != PCCD_OK) {
        close_motion(&opened);
        return status;
    }
    opened.frame_count =
        scene->animation.frame_count > 0 ? scene->animation.frame_count : 1;
    opened.vertex_count = scene->vertex_count;
    *motion = opened;
    return PCCD_OK;
}

/* client/ctl/mesh/gltf_scene.c - what a glTF file shows, as vertices at any time.
 *
 * Room:     client/ctl.
 * Does:     objects, instances, skins; vertices by morph targets, joints and nodes.
 * Threads:  one at a time.
 * Source:   gltf_scene.h.
 */
#include "gltf_scene.h"

#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "array.h"
#include "pccd_types.h"

#define INSTANCING "EXT_mesh_gpu_instancing"

/* ---- objects ----------------------------------------------------------------------- */

static int read_skin(struct gltf_scene *scene, int64_t index)
{
    struct gltf *gltf = &scene->gltf;
    const json_t *entry = gltf_entry(gltf, "skins", index);
    if (entry == NULL) {
        return gltf_fail(gltf, PCCD_E_INDEX, "skin %" PRId64 ": there is none", index);
    }
    struct gltf_skin *skin = &scene->skins[index];
    if (skin->is_read) {
        return PCCD_OK;
    }
    skin->joints = json_object_get(entry, "joints");
    skin->joint_count = json_array_size(skin->joints);
    skin->places = calloc(skin->joint_count + 1, sizeof *skin->places);
    if (skin->places == NULL) {
        return gltf_fail(gltf, PCCD_E_NOMEM, "no memory for %zu joints",
                         skin->joint_count);
    }
    for (size_t i = 0; i < skin->joint_count; i++) {
        const json_t *number = json_array_get(skin->joints, i);
        json_int_t node = json_is_integer(number) ? json_integer_value(number) : -1;
        if (node < 0 || (uint64_t)node >= scene->tree.count) {
            return gltf_fail(gltf, PCCD_E_INDEX,
                             "skin %" PRId64 ": joint %zu is node %" JSON_INTEGER_FORMAT
                             " of %zu",
                             index, i, node, scene->tree.count);
        }
        gltf_tree_mark(&scene->tree, (size_t)node);
    }
    int status = PCCD_OK;
    if (json_object_get(entry, "inverseBindMatrices") != NULL) {
        status = gltf_accessor_find(gltf, gltf_number(entry, "inverseBindMatrices", -1),
                                    "MAT4", GLTF_FLOAT, &skin->inverses);
    }
    if (status == PCCD_OK && skin->inverses.components > 0 &&
        skin->inverses.count < skin->joint_count) {
        return gltf_fail(gltf, PCCD_E_FORMAT,
                         "accessor %zu: %zu inverse bind matrices for %zu joints",
                         skin->inverses.index, skin->inverses.count, skin->joint_count);
    }
    skin->is_read = status == PCCD_OK;
    return status;
}

/* All of a skinned mesh has joints, of its skin. */
static int judge_influences(struct gltf *gltf, const struct gltf_mesh *mesh,
                            const struct gltf_object *object, size_t joint_count)
{
    for (size_t r = 0; r < mesh->run_count; r++) {
        const struct gltf_run *run = &mesh->runs[r];
        if (run->influence_count == 0) {
            return gltf_fail(gltf, PCCD_E_FORMAT,
                             "mesh %zu: has no joints for the skin of node %zu",
                             object->mesh, object->node);
        }
        for (size_t i = 0; i < run->influence_count * run->positions.count * 4; i++) {
            const struct gltf_accessor *joints =
                &run->influences[i / 4 / run->positions.count].joints;
            size_t vertex = i / 4 % run->positions.count;
            uint32_t joint = gltf_accessor_integer(joints, vertex, i % 4);
            if (joint >= joint_count) {
                return gltf_fail(gltf, PCCD_E_INDEX,
                                 "accessor %zu: vertex %zu has joint %" PRIu32 " of %zu",
                                 joints->index, vertex, joint, joint_count);
            }
        }
    }
    return PCCD_OK;
}

static int read_instances(struct gltf *gltf, const struct gltf_node *node, size_t index,
                          struct gltf_instances *instances)
{
    const json_t *extension = json_object_get(
        json_object_get(json_object_get(node->json, "extensions"), INSTANCING),
        "attributes");
    static const char *const names[3] = {"TRANSLATION", "ROTATION", "SCALE"};
    struct gltf_accessor *const found[3] = {&instances->translations,
                                            &instances->rotations, &instances->scales};
    for (int i = 0; i < 3; i++) {
        if (json_object_get(extension, names[i]) == NULL) {
            continue;
        }
        int status = gltf_accessor_find(gltf, gltf_number(extension, names[i], -1),
                                        i == 1 ? "VEC4" : "VEC3",
                                        i == 1 ? GLTF_FRACTIONS : GLTF_FLOAT, found[i]);
        if (status != PCCD_OK) {
            return status;
        }
        if (instances->count > 0 && found[i]->count != instances->count) {
            return gltf_fail(gltf, PCCD_E_FORMAT,
                             "node %zu: %s of %zu instances, others of %zu", index,
                             names[i], found[i]->count, instances->count);
        }
        instances->count = found[i]->count;
    }
    return PCCD_OK;
}

/* The weights of the morph targets: of the node, else of the mesh, else 0. */
static int read_weights(struct gltf_scene *scene, size_t index, size_t mesh)
{
    struct gltf_node *node = &scene->tree.nodes[index];
    const json_t *entry = gltf_entry(&scene->gltf, "meshes", (int64_t)mesh);
    bool has_own = json_object_get(node->json, "weights") != NULL;
    node->weight_count = scene->meshes[mesh].target_count;
    node->weights = calloc(node->weight_count + 1, sizeof *node->weights);
    if (node->weights == NULL) {
        return gltf_fail(&scene->gltf, PCCD_E_NOMEM, "no memory for %zu weights",
                         node->weight_count);
    }
    return gltf_numbers(&scene->gltf, has_own ? node->json : entry, "weights",
                        node->weight_count, node->weights, has_own ? "node" : "mesh",
                        has_own ? index : mesh);
}

static int add_object(struct gltf_scene *scene, struct gltf_object *object)
{
    struct gltf *gltf = &scene->gltf;
    uint64_t vertices = scene->meshes[object->mesh].vertex_count;
    void *objects = scene->objects;
    if (scene->vertex_count + vertices > CTL_MESH_COUNT_MAX) {
        return gltf_fail(gltf, PCCD_E_LIMIT, "more than %" PRIu64 " vertices",
                         CTL_MESH_COUNT_MAX);
    }
    if (!array_reserve(&objects, scene->object_count, &scene->object_room,
                       sizeof *object)) {
        return gltf_fail(gltf, PCCD_E_NOMEM, "no memory for %zu objects",
                         scene->object_count);
    }
    object->vertex_first = scene->vertex_count;
    scene->vertex_count += (uint32_t)vertices;
    scene->objects = objects;
    scene->objects[scene->object_count++] = *object;
    return PCCD_OK;
}

/* The objects of one node. */
static int read_node(struct gltf_scene *scene, size_t index)
{
    struct gltf *gltf = &scene->gltf;
    const json_t *json = scene->tree.nodes[index].json;
    const char *name = json_string_value(json_object_get(json, "name"));
    int64_t mesh = gltf_number(json, "mesh", -1);
    if (json_object_get(json, "mesh") == NULL ||
        (gltf->is_export && (name == NULL || strncmp(name, "object ", 7) != 0))) {
        return PCCD_OK;
    }
    if (mesh < 0 || (uint64_t)mesh >= scene->mesh_count) {
        return gltf_fail(gltf, PCCD_E_INDEX, "node %zu: there is no mesh %" PRId64, index,
                         mesh);
    }
    struct gltf_object object = {.node = index, .mesh = (size_t)mesh, .instance = -1};
    bool has_skin = json_object_get(json, "skin") != NULL;
    object.skin = has_skin ? gltf_number(json, "skin", -1) : -1;
    int status = scene->meshes[mesh].is_read
                     ? PCCD_OK
                     : gltf_mesh_read(gltf, mesh, &scene->meshes[mesh]);
    if (status == PCCD_OK) {
        status = read_weights(scene, index, object.mesh);
    }
    if (status == PCCD_OK && has_skin) {
        status = read_skin(scene, object.skin);
        if (status == PCCD_OK) {
            status = judge_influences(gltf, &scene->meshes[mesh], &object,
                                      scene->skins[object.skin].joint_count);
        }
    } else if (status == PCCD_OK) {
        gltf_tree_mark(&scene->tree, index);
    }
    if (status == PCCD_OK) {
        status =
            read_instances(gltf, &scene->tree.nodes[index], index, &object.instances);
    }
    bool has_instances = object.instances.translations.components > 0 ||
                         object.instances.rotations.components > 0 ||
                         object.instances.scales.components > 0;
    if (status == PCCD_OK && has_instances && has_skin) {
        return gltf_fail(gltf, PCCD_E_FORMAT,
                         "node %zu: has a skin and \"" INSTANCING "\"", index);
    }
    size_t count = has_instances ? object.instances.count : 1;
    for (size_t i = 0; i < count && status == PCCD_OK; i++) {
        object.instance = has_instances ? (int64_t)i : -1;
        status = add_object(scene, &object);
    }
    return status;
}

int gltf_scene_open(struct ctl_file *file, const struct ctl_motion_wish *wish,
                    struct ctl_error *error, struct gltf_scene *scene)
{
    *scene = (struct gltf_scene){.object_count = 0};
    struct gltf *gltf = &scene->gltf;
    int status = gltf_open(file, error, gltf);
    if (status == PCCD_OK) {
        status = gltf_tree_read(gltf, &scene->tree);
    }
    if (status != PCCD_OK) {
        return status;
    }
    scene->mesh_count = gltf_entry_count(gltf, "meshes");
    scene->skin_count = gltf_entry_count(gltf, "skins");
    scene->meshes = calloc(scene->mesh_count + 1, sizeof *scene->meshes);
    scene->skins = calloc(scene->skin_count + 1, sizeof *scene->skins);
    if (scene->meshes == NULL || scene->skins == NULL) {
        return gltf_fail(gltf, PCCD_E_NOMEM, "no memory for %zu meshes and %zu skins",
                         scene->mesh_count, scene->skin_count);
    }
    for (size_t i = 0; i < scene->tree.shown_count && status == PCCD_OK; i++) {
        status = read_node(scene, scene->tree.shown[i]);
    }
    /* The animation of an export is the step itself, of which it shows one moment. */
    if (status == PCCD_OK && !gltf->is_export) {
        status = gltf_animation_read(gltf, &scene->tree, wish, &scene->animation);
    }
    return status;
}

void gltf_scene_close(struct gltf_scene *scene)
{
    for (size_t i = 0; scene->meshes != NULL && i < scene->mesh_count; i++) {
        gltf_mesh_deinit(&scene->meshes[i]);
    }
    for (size_t i = 0; scene->skins != NULL && i < scene->skin_count; i++) {
        free(scene->skins[i].places);
    }
    free(scene->meshes);
    free(scene->skins);
    free(scene->objects);
    gltf_animation_deinit(&scene->animation);
    gltf_tree_deinit(&scene->tree);
    gltf_close(&scene->gltf);
}

int gltf_scene_add(struct gltf_scene *scene, struct ctl_mesh *to)
{
    struct gltf *gltf = &scene->gltf;
    int status = PCCD_OK;
    for (size_t i = 0; i < scene->object_count && status == PCCD_OK; i++) {
        const struct gltf_object *object = &scene->objects[i];
        const json_t *mesh = gltf_entry(gltf, "meshes", (int64_t)object->mesh);
        const json_t *named =
            json_object_get(scene->tree.nodes[object->node].json, "name");
        named = json_is_string(named) ? named : json_object_get(mesh, "name");
        const char *given = json_string_value(named);
        size_t bytes = (given != NULL ? strlen(given) : 0) + 64;
        char *name = malloc(bytes);
        if (name == NULL) {
            return gltf_fail(gltf, PCCD_E_NOMEM, "no memory for a name of %zu bytes",
                             bytes);
        }
        int length = given != NULL ? snprintf(name, bytes, "%s", given)
                                   : snprintf(name, bytes, "node %zu", object->node);
        if (object->instance >= 0) {
            length += snprintf(name + length, bytes - (size_t)length, " [%" PRId64 "]",
                               object->instance);
        }
        status = ctl_mesh_add_object(to, name, (size_t)length);
        free(name);
        if (status == PCCD_OK) {
            status = gltf_mesh_add(gltf, &scene->meshes[object->mesh],
                                   object->vertex_first, to);
        }
    }
    return status;
}

/* ---- vertices ---------------------------------------------------------------------- */

static int place_joints(struct gltf_scene *scene, struct gltf_skin *skin)
{
    for (size_t i = 0; i < skin->joint_count; i++) {
        json_int_t node = json_integer_value(json_array_get(skin->joints, i));
        double columns[16];
        struct gltf_place inverse;
        skin->places[i] = scene->tree.nodes[node].world;
        if (skin->inverses.components == 0) {
            continue;
        }
        gltf_accessor_read(&skin->inverses, i, columns);
        if (!gltf_place_of_matrix(columns, &inverse)) {
            return gltf_fail(&scene->gltf, PCCD_E_FORMAT,
                             "accessor %zu: the last row of matrix %zu is not 0 0 0 1",
                             skin->inverses.index, i);
        }
        skin->places[i] = gltf_place_product(&skin->places[i], &inverse);
    }
    return PCCD_OK;
}

/* Where a vertex goes by its joints: their places, each by its part of the weights. */
static int find_blend(struct gltf_scene *scene, const struct gltf_run *run,
                      const struct gltf_skin *skin, size_t vertex,
                      struct gltf_place *blend)
{
    double sum = 0;
    *blend = (struct gltf_place){{{0}}};
    for (size_t set = 0; set < run->influence_count; set++) {
        const struct gltf_influence *influence = &run->influences[set];
        double weights[4];
        gltf_accessor_read(&influence->weights, vertex, weights);
        for (size_t k = 0; k < 4; k++) {
            uint32_t joint = gltf_accessor_integer(&influence->joints, vertex, k);
            const double *from = &skin->places[joint].m[0][0];
            sum += weights[k];
            for (int i = 0; i < 12 && weights[k] != 0; i++) {
                (&blend->m[0][0])[i] += weights[k] * from[i];
            }
        }
    }
    if (!(sum > 0)) {
        return gltf_fail(&scene->gltf, PCCD_E_FORMAT,
                         "accessor %zu: the weights of vertex %zu have the sum %g",
                         run->influences[0].weights.index, vertex, sum);
    }
    /* Rounded weights have not quite the sum 1, and would draw it towards the origin. */
    for (int i = 0; i < 12 && sum != 1; i++) {
        (&blend->m[0][0])[i] /= sum;
    }
    return PCCD_OK;
}

/* A vertex of a run, moved by the morph targets. */
static void read_vertex(const struct gltf_scene *scene, const struct gltf_node *node,
                        const struct gltf_run *run, size_t vertex, double x[3])
{
    gltf_accessor_read(&run->positions, vertex, x);
    for (size_t k = 0; k < node->weight_count; k++) {
        double by[3];
        if (node->weights[k] == 0 || run->targets[k].count == 0) {
            continue;
        }
        gltf_accessor_read(&run->targets[k], vertex, by);
        for (int axis = 0; axis < 3; axis++) {
            x[axis] += node->weights[k] * by[axis];
        }
    }
    /* An export has the difference of two floats, rounded: so is their sum. */
    for (int axis = 0; axis < 3 && scene->gltf.is_export; axis++) {
        x[axis] = (double)(float)x[axis];
    }
}

static int place_run(struct gltf_scene *scene, const struct gltf_object *object,
                     const struct gltf_run *run, const struct gltf_place *place,
                     double (*x)[3])
{
    const struct gltf_node *node = &scene->tree.nodes[object->node];
    for (size_t i = 0; i < run->positions.count; i++) {
        struct gltf_place blend;
        if (object->skin >= 0) {
            int status = find_blend(scene, run, &scene->skins[object->skin], i, &blend);
            if (status != PCCD_OK) {
                return status;
            }
            place = &blend;
        }
        read_vertex(scene, node, run, i, x[i]);
        gltf_place_apply(place, x[i]);
        for (int axis = 0; axis < 3; axis++) {
            if (!common_is_coordinate(x[i][axis])) {
                return gltf_fail(&scene->gltf, PCCD_E_NOTFINITE,
                                 "vertex %zu: coordinate %c is %g; |x| <= 1e18 is needed",
                                 object->vertex_first + run->first + i, "xyz"[axis],
                                 x[i][axis]);
            }
        }
    }
    return PCCD_OK;
}

/* Where an object is that has no skin. */
static int place_object(struct gltf_scene *scene, const struct gltf_object *object,
                        struct gltf_place *place)
{
    const struct gltf_instances *instances = &object->instances;
    double translation[3] = {0}, rotation[4] = {0, 0, 0, 1}, scale[3] = {1, 1, 1};
    const struct gltf_accessor *const given[3] = {
        &instances->translations, &instances->rotations, &instances->scales};
    double *const values[3] = {translation, rotation, scale};
    *place = scene->tree.nodes[object->node].world;
    if (object->instance < 0) {
        return PCCD_OK;
    }
    for (int i = 0; i < 3; i++) {
        if (given[i]->components > 0) {
            gltf_accessor_read(given[i], (size_t)object->instance, values[i]);
        }
    }
    struct gltf_place inner;
    if (!gltf_place_of(translation, rotation, scale, &inner)) {
        return gltf_fail(&scene->gltf, PCCD_E_FORMAT,
                         "node %zu: the rotation of instance %" PRId64 " has no length",
                         object->node, object->instance);
    }
    *place = gltf_place_product(place, &inner);
    return PCCD_OK;
}

int gltf_scene_place(struct gltf_scene *scene, uint32_t frame, double (*x)[3])
{
    if (scene->animation.frame_count > 0) {
        gltf_animation_pose(&scene->animation, &scene->tree,
                            gltf_animation_time(&scene->animation, frame));
    }
    int status = gltf_tree_place(&scene->gltf, &scene->tree);
    for (size_t i = 0; i < scene->skin_count && status == PCCD_OK; i++) {
        status =
            scene->skins[i].is_read ? place_joints(scene, &scene->skins[i]) : PCCD_OK;
    }
    for (size_t i = 0; i < scene->object_count && status == PCCD_OK; i++) {
        const struct gltf_object *object = &scene->objects[i];
        const struct gltf_mesh *mesh = &scene->meshes[object->mesh];
        struct gltf_place place;
        status = object->skin >= 0 ? PCCD_OK : place_object(scene, object, &place);
        for (size_t r = 0; r < mesh->run_count && status == PCCD_OK; r++) {
            const struct gltf_run *run = &mesh->runs[r];
            status = place_run(scene, object, run, &place,
                               x + object->vertex_first + run->first);
        }
    }
    return status;
}

void gltf_scene_name(const struct gltf_scene *scene, uint32_t frame, char *text,
                     size_t bytes)
{
    if (scene->animation.frame_count == 0) {
        snprintf(text, bytes, "at rest");
        return;
    }
    /* As few digits as tell keys apart, which are floats in the file. */
    double time = gltf_animation_time(&scene->animation, frame);
    for (int digits = 6; digits <= 9; digits++) {
        snprintf(text, bytes, "%.*g s", digits, time);
        if ((float)strtod(text, NULL) == (float)time) {
            break;
        }
    }
}

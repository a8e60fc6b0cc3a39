/* client/ctl/mesh/gltf_scene.c - what a glTF file shows: nodes, and objects at them. */
#include "gltf_scene.h"

#include <inttypes.h>
#include <stdio.h>
#include <string.h>

#define INSTANCING "EXT_mesh_gpu_instancing"

const struct gltf_path_kind gltf_path_kinds[GLTF_PATHS] = {
    {"translation", "TRANSLATION", 3, GLTF_VECTORS, {0, 0, 0}},
    {"rotation", "ROTATION", 4, GLTF_ROTATIONS, {0, 0, 0, 1}},
    {"scale", "SCALE", 3, GLTF_VECTORS, {1, 1, 1}},
    {"weights", NULL, 1, GLTF_FRACTIONS, {0}},
};

/* ---- nodes ------------------------------------------------------------------------- */

static void read_node(struct gltf_scene *scene, size_t index)
{
    struct gltf *gltf = &scene->gltf;
    struct gltf_node *node = &scene->nodes[index];
    const json_t *json = node->json = gltf_entry(gltf, "nodes", (long long)index);
    node->parent = -1;
    node->has_matrix = json_object_get(json, "matrix") != NULL;
    gltf_numbers(gltf, json, "matrix", 16, node->matrix, "node", index);
    for (int i = 0; i < GLTF_POSE_PATHS; i++) {
        const struct gltf_path_kind *kind = &gltf_path_kinds[i];
        gltf_check(gltf, !node->has_matrix || json_object_get(json, kind->name) == NULL,
                   PCCD_E_FORMAT, "node %zu: has a matrix, and a %s, too", index,
                   kind->name);
        memcpy(node->pose[i], kind->still, sizeof kind->still);
        gltf_numbers(gltf, json, kind->name, kind->numbers, node->pose[i], "node", index);
    }
}

static void read_children(struct gltf_scene *scene, size_t index)
{
    struct gltf *gltf = &scene->gltf;
    const json_t *children = json_object_get(scene->nodes[index].json, "children");
    for (size_t k = 0; k < json_array_size(children) && gltf->status == PCCD_OK; k++) {
        long long child = gltf_value(json_array_get(children, k), -1);
        if (gltf_check(gltf, child >= 0 && (size_t)child < scene->node_count,
                       PCCD_E_INDEX, "node %zu: there is no node %lld for its children",
                       index, child)) {
            struct gltf_node *below = &scene->nodes[child];
            gltf_check(gltf, below->parent < 0, PCCD_E_FORMAT,
                       "node %lld: is a child of node %zu and of node %lld", child, index,
                       below->parent);
            below->parent = (long long)index;
        }
    }
}

/* Add a node without parents and all below it to the order, parents first. `waiting` has
 * room for all nodes. */
static void list_from(struct gltf_scene *scene, size_t root, size_t *waiting)
{
    size_t count = 0;
    waiting[count++] = root;
    while (count > 0) {
        size_t at = waiting[--count];
        const json_t *children = json_object_get(scene->nodes[at].json, "children");
        scene->nodes[at].is_listed = true;
        scene->order[scene->listed_count++] = at;
        for (size_t k = json_array_size(children); k-- > 0;) {
            waiting[count++] = (size_t)gltf_value(json_array_get(children, k), -1);
        }
    }
}

/* What the scene shows, then what else there is; without any scene all is shown. */
static void read_order(struct gltf_scene *scene, size_t *waiting)
{
    struct gltf *gltf = &scene->gltf;
    struct gltf_node *nodes = scene->nodes;
    long long index = gltf_number(gltf->root, "scene", 0), below = -1;
    const json_t *entry = gltf_entry(gltf, "scenes", index);
    const json_t *roots = json_object_get(entry, "nodes");
    bool has_scenes = gltf_entry_count(gltf, "scenes") > 0;
    gltf_check(gltf, !has_scenes || entry != NULL, PCCD_E_INDEX,
               "scene %lld: there is none", index);
    for (size_t k = 0; k < json_array_size(roots) && gltf->status == PCCD_OK; k++) {
        long long root = gltf_value(json_array_get(roots, k), -1);
        if (gltf_check(gltf, root >= 0 && (size_t)root < scene->node_count, PCCD_E_INDEX,
                       "scene %lld: there is no node %lld", index, root) &&
            gltf_check(gltf, !nodes[root].is_listed, PCCD_E_FORMAT,
                       "scene %lld: node %lld is there twice", index, root)) {
            if (nodes[root].parent >= 0) {
                below = root;
            } else {
                list_from(scene, (size_t)root, waiting);
            }
        }
    }
    scene->shown_count = scene->listed_count;
    for (size_t i = 0; i < scene->node_count; i++) {
        if (nodes[i].parent < 0 && !nodes[i].is_listed) {
            list_from(scene, i, waiting);
        }
    }
    for (size_t i = 0; i < scene->node_count; i++) {
        gltf_check(gltf, nodes[i].is_listed, PCCD_E_FORMAT, "node %zu: is below itself",
                   i);
    }
    gltf_check(gltf, below < 0, PCCD_E_FORMAT,
               "scene %lld: node %lld is a child of another node", index, below);
    scene->shown_count = has_scenes ? scene->shown_count : scene->listed_count;
}

static void read_nodes(struct gltf_scene *scene)
{
    struct gltf *gltf = &scene->gltf;
    size_t count = scene->node_count = gltf_entry_count(gltf, "nodes");
    scene->nodes = gltf_alloc(gltf, count, sizeof *scene->nodes, "nodes");
    scene->order = gltf_alloc(gltf, count, sizeof *scene->order, "nodes");
    size_t *waiting = gltf_alloc(gltf, count, sizeof *waiting, "nodes");
    for (size_t i = 0; i < count && gltf->status == PCCD_OK; i++) {
        read_node(scene, i);
    }
    for (size_t i = 0; i < count && gltf->status == PCCD_OK; i++) {
        read_children(scene, i);
    }
    if (gltf->status == PCCD_OK) {
        read_order(scene, waiting);
    }
}

/* It and its parents move a mesh. */
static void mark(struct gltf_scene *scene, long long node)
{
    for (; node >= 0 && !scene->nodes[node].moves_mesh;
         node = scene->nodes[node].parent) {
        scene->nodes[node].moves_mesh = true;
    }
}

/* ---- objects ----------------------------------------------------------------------- */

/* Its joints move what has a skin, wherever they stand. NULL: there is none. */
static struct gltf_skin *read_skin(struct gltf_scene *scene, long long index)
{
    struct gltf *gltf = &scene->gltf;
    const json_t *entry = gltf_entry(gltf, "skins", index);
    if (!gltf_check(gltf, entry != NULL, PCCD_E_INDEX, "skin %lld: there is none",
                    index)) {
        return NULL;
    }
    struct gltf_skin *skin = &scene->skins[index];
    skin->json = entry;
    skin->joints = json_object_get(entry, "joints");
    skin->joint_count = json_array_size(skin->joints);
    for (size_t i = 0; i < skin->joint_count; i++) {
        long long node = gltf_value(json_array_get(skin->joints, i), -1);
        if (gltf_check(gltf, node >= 0 && (size_t)node < scene->node_count, PCCD_E_INDEX,
                       "skin %lld: joint %zu is node %lld of %zu", index, i, node,
                       scene->node_count)) {
            mark(scene, node);
        }
    }
    return skin;
}

/* What a node shows, without its vertices. The weights of the morph targets are those of
 * the node, else of the mesh, else 0. */
static void read_object(struct gltf_scene *scene, size_t index)
{
    struct gltf *gltf = &scene->gltf;
    struct gltf_node *node = &scene->nodes[index];
    const char *name = json_string_value(json_object_get(node->json, "name"));
    const json_t *skin = json_object_get(node->json, "skin");
    long long number = gltf_number(node->json, "mesh", -1);
    const json_t *entry = gltf_entry(gltf, "meshes", number);
    if (json_object_get(node->json, "mesh") == NULL ||
        (gltf->is_export && (name == NULL || strncmp(name, "object ", 7) != 0)) ||
        !gltf_check(gltf, entry != NULL, PCCD_E_INDEX, "node %zu: there is no mesh %lld",
                    index, number)) {
        return;
    }
    struct gltf_mesh *mesh = &scene->meshes[number];
    struct gltf_object *object = &scene->objects[scene->object_count++];
    object->node = index;
    object->mesh = mesh;
    mesh->json = entry;
    mesh->primitives = json_object_get(entry, "primitives");
    mesh->target_count =
        json_array_size(json_object_get(json_array_get(mesh->primitives, 0), "targets"));
    bool has_own = json_object_get(node->json, "weights") != NULL;
    node->weight_count = mesh->target_count;
    node->weights = gltf_alloc(gltf, node->weight_count, sizeof(double), "weights");
    if (node->weights == NULL) {
        return;
    }
    gltf_numbers(gltf, has_own ? node->json : entry, "weights", node->weight_count,
                 node->weights, has_own ? "node" : "mesh",
                 has_own ? index : (size_t)number);
    if (skin != NULL) {
        object->skin = read_skin(scene, gltf_value(skin, -1));
    } else {
        mark(scene, (long long)index);
    }
}

void gltf_scene_open(struct ctl_file *file, const struct ctl_motion_wish *wish,
                     struct ctl_error *error, struct gltf_scene *scene)
{
    struct gltf *gltf = &scene->gltf;
    *scene = (struct gltf_scene){.object_count = 0};
    gltf_open(file, error, gltf);
    size_t meshes = gltf_entry_count(gltf, "meshes");
    size_t skins = gltf_entry_count(gltf, "skins");
    read_nodes(scene);
    scene->meshes = gltf_alloc(gltf, meshes, sizeof *scene->meshes, "meshes");
    scene->skins = gltf_alloc(gltf, skins, sizeof *scene->skins, "skins");
    scene->objects =
        gltf_alloc(gltf, scene->shown_count, sizeof *scene->objects, "objects");
    for (size_t i = 0; i < scene->shown_count && gltf->status == PCCD_OK; i++) {
        read_object(scene, scene->order[i]);
    }
    /* The animation of an export is the step itself, of which it shows one moment. */
    if (gltf->status == PCCD_OK && !gltf->is_export) {
        gltf_animation_read(scene, wish);
    }
}

static void load_skin(struct gltf *gltf, const struct gltf_object *object, size_t mesh)
{
    struct gltf_skin *skin = object->skin;
    const json_t *inverses = json_object_get(skin->json, "inverseBindMatrices");
    for (size_t r = 0; r < object->mesh->run_count; r++) {
        gltf_check(gltf, object->mesh->runs[r].set_count > 0, PCCD_E_FORMAT,
                   "mesh %zu: has no joints for the skin of node %zu", mesh,
                   object->node);
    }
    skin->places = gltf_alloc(gltf, skin->joint_count, sizeof *skin->places, "joints");
    if (inverses != NULL) {
        skin->inverses = gltf_find(gltf, inverses, GLTF_MATRICES);
        gltf_check(gltf, skin->inverses.count >= skin->joint_count, PCCD_E_FORMAT,
                   "accessor %zu: %zu inverse bind matrices for %zu joints",
                   skin->inverses.index, skin->inverses.count, skin->joint_count);
    }
}

static void load_instances(struct gltf_scene *scene, struct gltf_object *object)
{
    struct gltf *gltf = &scene->gltf;
    const json_t *extensions =
        json_object_get(scene->nodes[object->node].json, "extensions");
    const json_t *attributes =
        json_object_get(json_object_get(extensions, INSTANCING), "attributes");
    object->instance_count = 1;
    for (int i = 0; i < GLTF_POSE_PATHS; i++) {
        const char *name = gltf_path_kinds[i].instance_name;
        const json_t *number = json_object_get(attributes, name);
        if (number == NULL) {
            continue;
        }
        struct gltf_accessor given = gltf_find(gltf, number, gltf_path_kinds[i].role);
        gltf_check(gltf, !object->has_instances || given.count == object->instance_count,
                   PCCD_E_FORMAT, "node %zu: %s of %zu instances, others of %zu",
                   object->node, name, given.count, object->instance_count);
        object->instances[i] = given;
        object->instance_count = given.count;
        object->has_instances = true;
    }
    gltf_check(gltf, !object->has_instances || object->skin == NULL, PCCD_E_FORMAT,
               "node %zu: has a skin and \"" INSTANCING "\"", object->node);
}

void gltf_scene_load(struct gltf_scene *scene)
{
    struct gltf *gltf = &scene->gltf;
    if (scene->is_loaded) {
        return;
    }
    for (size_t i = 0; i < scene->object_count && gltf->status == PCCD_OK; i++) {
        struct gltf_object *object = &scene->objects[i];
        struct gltf_mesh *mesh = object->mesh;
        size_t number = (size_t)(mesh - scene->meshes);
        if (mesh->runs == NULL) {
            gltf_mesh_read(gltf, number, mesh);
        }
        if (object->skin != NULL) {
            load_skin(gltf, object, number);
        }
        load_instances(scene, object);
        object->first = scene->vertex_count;
        gltf_check(gltf,
                   mesh->vertex_count == 0 ||
                       object->instance_count <=
                           (CTL_MESH_COUNT_MAX - object->first) / mesh->vertex_count,
                   PCCD_E_LIMIT, "more than %" PRIu64 " vertices", CTL_MESH_COUNT_MAX);
        scene->vertex_count = gltf_object_first(object, object->instance_count);
    }
    scene->is_loaded = gltf->status == PCCD_OK;
}

uint32_t gltf_object_first(const struct gltf_object *object, size_t instance)
{
    return object->first + (uint32_t)(instance * object->mesh->vertex_count);
}

void gltf_scene_add(struct gltf_scene *scene, struct ctl_mesh *to)
{
    struct gltf *gltf = &scene->gltf;
    for (size_t i = 0; i < scene->object_count; i++) {
        const struct gltf_object *object = &scene->objects[i];
        const json_t *named = json_object_get(scene->nodes[object->node].json, "name");
        named =
            json_is_string(named) ? named : json_object_get(object->mesh->json, "name");
        const char *given = json_string_value(named);
        size_t bytes = (given != NULL ? strlen(given) : 0) + 64;
        char *name = gltf_alloc(gltf, bytes, 1, "bytes of a name");
        for (size_t k = 0; k < object->instance_count && gltf->status == PCCD_OK; k++) {
            int length = given != NULL ? snprintf(name, bytes, "%s", given)
                                       : snprintf(name, bytes, "node %zu", object->node);
            if (object->has_instances) {
                length += snprintf(name + length, bytes - (size_t)length, " [%zu]", k);
            }
            gltf->status = ctl_mesh_add_object(to, name, (size_t)length);
            gltf_mesh_add(gltf, object->mesh, gltf_object_first(object, k), to);
        }
    }
}

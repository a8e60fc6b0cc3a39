/* client/ctl/mesh/gltf_scene.c - what a glTF file shows, as mesh and frames.
 *
 * Objects are at nodes; nodes, joints and vertices are placed in doubles.
 */
#include "gltf_scene.h"

#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "coordinates.h"

#define INSTANCING     "EXT_mesh_gpu_instancing"
#define VISIBILITY     "KHR_node_visibility"
#define LAST_ROW_ERROR 1e-5 /* of inverse matrices that were rounded to floats */
#define TURN_DEGREES   1.0  /* between two frames, beyond which it is told */

const struct gltf_path_kind gltf_path_kinds[GLTF_PATHS] = {
    {"translation", "TRANSLATION", 3, GLTF_VECTORS, {0, 0, 0}},
    {"rotation", "ROTATION", 4, GLTF_ROTATIONS, {0, 0, 0, 1}},
    {"scale", "SCALE", 3, GLTF_VECTORS, {1, 1, 1}},
    {"weights", NULL, 1, GLTF_FRACTIONS, {0}},
};

/* ---- nodes ------------------------------------------------------------------------- */

/* A node, and of which others it is the parent. */
static void read_node(struct gltf_scene *scene, size_t index)
{
    struct gltf *gltf = &scene->gltf;
    struct gltf_node *node = &scene->nodes[index];
    const json_t *json = node->json = gltf_entry(gltf, "nodes", (long long)index);
    const struct gltf_named named = {json, "node", index};
    const json_t *children = json_object_get(json, "children");
    const json_t *hides =
        json_object_get(json_object_get(json, "extensions"), VISIBILITY);
    node->is_hidden = json_is_false(json_object_get(hides, "visible"));
    node->has_matrix = json_object_get(json, "matrix") != NULL;
    gltf_numbers(gltf, named, "matrix", 16, node->matrix);
    for (int i = 0; i < GLTF_POSE_PATHS; i++) {
        const struct gltf_path_kind *kind = &gltf_path_kinds[i];
        gltf_check(gltf, !node->has_matrix || json_object_get(json, kind->name) == NULL,
                   "node %zu: has a matrix, and a %s, too", index, kind->name);
        memcpy(node->pose[i], kind->still, sizeof kind->still);
        gltf_numbers(gltf, named, kind->name, kind->numbers, node->pose[i]);
    }
    for (size_t k = 0; k < json_array_size(children) && gltf->status == PCCD_OK; k++) {
        long long child = gltf_value(json_array_get(children, k), -1);
        if (gltf_check_as(
                gltf, child >= 0 && (size_t)child < scene->node_count, PCCD_E_INDEX,
                "node %zu: there is no node %lld for its children", index, child)) {
            struct gltf_node *below = &scene->nodes[child];
            const struct gltf_node *other = below->parent != NULL ? below->parent : node;
            gltf_check(gltf, below->parent == NULL,
                       "node %lld: is a child of node %zu and of node %td", child, index,
                       other - scene->nodes);
            below->parent = node;
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

/* List the nodes in order: those that the scene shows, then the others; without any scene
 * all are shown. */
static void read_order(struct gltf_scene *scene, size_t *waiting)
{
    struct gltf *gltf = &scene->gltf;
    struct gltf_node *nodes = scene->nodes;
    long long index = gltf_number(gltf->root, "scene", 0), below = -1;
    const json_t *entry = gltf_entry(gltf, "scenes", index);
    const json_t *roots = json_object_get(entry, "nodes");
    bool has_scenes = gltf_entry_count(gltf, "scenes") > 0;
    gltf_check_as(gltf, !has_scenes || entry != NULL, PCCD_E_INDEX,
                  "scene %lld: there is none", index);
    for (size_t k = 0; k < json_array_size(roots) && gltf->status == PCCD_OK; k++) {
        long long root = gltf_value(json_array_get(roots, k), -1);
        if (gltf_check_as(gltf, root >= 0 && (size_t)root < scene->node_count,
                          PCCD_E_INDEX, "scene %lld: there is no node %lld", index,
                          root) &&
            gltf_check(gltf, !nodes[root].is_listed,
                       "scene %lld: node %lld is there twice", index, root)) {
            if (nodes[root].parent != NULL) {
                below = root;
            } else {
                list_from(scene, (size_t)root, waiting);
            }
        }
    }
    scene->shown_count = scene->listed_count;
    for (size_t i = 0; i < scene->node_count; i++) {
        if (nodes[i].parent == NULL && !nodes[i].is_listed) {
            list_from(scene, i, waiting);
        }
    }
    for (size_t i = 0; i < scene->node_count; i++) {
        gltf_check(gltf, nodes[i].is_listed, "node %zu: is below itself", i);
    }
    gltf_check(gltf, below < 0, "scene %lld: node %lld is a child of another node", index,
               below);
    scene->shown_count = has_scenes ? scene->shown_count : scene->listed_count;
}

/* It and its parents move a mesh. */
static void mark(struct gltf_node *node)
{
    for (; node != NULL && !node->moves_mesh; node = node->parent) {
        node->moves_mesh = true;
    }
}

/* ---- objects ----------------------------------------------------------------------- */

/* Its joints move what has a skin, wherever they stand. */
static void read_skin(struct gltf_scene *scene, struct gltf_object *object)
{
    struct gltf *gltf = &scene->gltf;
    long long index = gltf_number(scene->nodes[object->node].json, "skin", -1);
    object->skin = gltf_entry(gltf, "skins", index);
    object->joints = json_object_get(object->skin, "joints");
    gltf_check_as(gltf, object->skin != NULL, PCCD_E_INDEX, "skin %lld: there is none",
                  index);
    for (size_t i = 0; i < json_array_size(object->joints); i++) {
        long long node = gltf_value(json_array_get(object->joints, i), -1);
        if (gltf_check_as(gltf, node >= 0 && (size_t)node < scene->node_count,
                          PCCD_E_INDEX, "skin %lld: joint %zu is node %lld of %zu", index,
                          i, node, scene->node_count)) {
            mark(&scene->nodes[node]);
        }
    }
}

/* Read what a node shows, without its vertices: nothing if it or one above it is hidden;
 * that one is read before. The weights of the morph targets are those of the node, else
 * of the mesh, else 0. */
static void read_object(struct gltf_scene *scene, size_t index)
{
    struct gltf *gltf = &scene->gltf;
    struct gltf_node *node = &scene->nodes[index];
    long long number = gltf_number(node->json, "mesh", -1);
    const json_t *entry = gltf_entry(gltf, "meshes", number);
    node->is_hidden |= node->parent != NULL && node->parent->is_hidden;
    if (node->is_hidden || json_object_get(node->json, "mesh") == NULL ||
        /* Marks of contacts, unlike objects, do not move. */
        (gltf->is_export && json_object_get(entry, "weights") == NULL) ||
        !gltf_check_as(gltf, entry != NULL, PCCD_E_INDEX,
                       "node %zu: there is no mesh %lld", index, number)) {
        return;
    }
    struct gltf_object *object = &scene->objects[scene->object_count++];
    const json_t *primitives = json_object_get(entry, "primitives");
    size_t targets =
        json_array_size(json_object_get(json_array_get(primitives, 0), "targets"));
    object->node = index;
    object->mesh = number;
    object->primitives = primitives;
    object->target_count = targets;
    object->instance_count = 1;
    bool has_own = json_object_get(node->json, "weights") != NULL;
    node->weight_count = targets;
    node->weights = gltf_alloc(gltf, targets, sizeof *node->weights, "weights");
    if (node->weights == NULL) {
        return;
    }
    const struct gltf_named named = {has_own ? node->json : entry,
                                     has_own ? "node" : "mesh",
                                     has_own ? index : (size_t)number};
    gltf_numbers(gltf, named, "weights", targets, node->weights);
    if (json_object_get(node->json, "skin") != NULL) {
        read_skin(scene, object);
    } else {
        mark(node);
    }
}

/* Read what a file has that was opened, but no mesh, and of its animations those that are
 * wished for. gltf_close also after an error. */
static void open_scene(struct ctl_file *file, const struct ctl_motion_wish *wish,
                       struct ctl_error *error, struct gltf_scene *scene)
{
    struct gltf *gltf = &scene->gltf;
    *scene = (struct gltf_scene){.object_count = 0};
    gltf_open(file, error, gltf);
    size_t count = scene->node_count = gltf_entry_count(gltf, "nodes");
    scene->nodes = gltf_alloc(gltf, count, sizeof *scene->nodes, "nodes");
    scene->order = gltf_alloc(gltf, count, sizeof *scene->order, "nodes");
    size_t *waiting = gltf_alloc(gltf, count, sizeof *waiting, "nodes");
    for (size_t i = 0; i < count && gltf->status == PCCD_OK; i++) {
        read_node(scene, i);
    }
    if (gltf->status == PCCD_OK) {
        read_order(scene, waiting);
    }
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

static uint32_t first_of(const struct gltf_object *object, size_t instance)
{
    return object->first + (uint32_t)instance * object->vertex_count;
}

/* The vertices of an object, its joints, and where its instances are. */
static void load_object(struct gltf_scene *scene, struct gltf_object *object)
{
    struct gltf *gltf = &scene->gltf;
    size_t joints = json_array_size(object->joints);
    const json_t *inverses = json_object_get(object->skin, "inverseBindMatrices");
    const json_t *extensions =
        json_object_get(scene->nodes[object->node].json, "extensions");
    const json_t *attributes =
        json_object_get(json_object_get(extensions, INSTANCING), "attributes");
    gltf_mesh_read(gltf, object);
    object->places = gltf_alloc(gltf, joints, sizeof *object->places, "joints");
    if (inverses != NULL) {
        object->inverses = gltf_find(gltf, inverses, GLTF_MATRICES);
        gltf_check(gltf, object->inverses.count >= joints,
                   "accessor %zu: %zu inverse bind matrices for %zu joints",
                   object->inverses.index, object->inverses.count, joints);
    }
    for (int i = 0; i < GLTF_POSE_PATHS; i++) {
        const char *name = gltf_path_kinds[i].instance_name;
        const json_t *number = json_object_get(attributes, name);
        if (number == NULL) {
            continue;
        }
        struct gltf_accessor given = gltf_find(gltf, number, gltf_path_kinds[i].role);
        gltf_check(gltf, !object->has_instances || given.count == object->instance_count,
                   "node %zu: %s of %zu instances, others of %zu", object->node, name,
                   given.count, object->instance_count);
        object->instances[i] = given;
        object->instance_count = given.count;
        object->has_instances = true;
    }
    gltf_check(gltf, !object->has_instances || object->skin == NULL,
               "node %zu: has a skin and \"" INSTANCING "\"", object->node);
}

/* Read what is shown, once. */
static void load_scene(struct gltf_scene *scene)
{
    struct gltf *gltf = &scene->gltf;
    if (scene->is_loaded) {
        return;
    }
    for (size_t i = 0; i < scene->object_count && gltf->status == PCCD_OK; i++) {
        struct gltf_object *object = &scene->objects[i];
        object->first = scene->vertex_count;
        load_object(scene, object);
        uint64_t room = CTL_MESH_COUNT_MAX - object->first, each = object->vertex_count;
        gltf_check_as(gltf, each == 0 || object->instance_count <= room / each,
                      PCCD_E_LIMIT, "more than %" PRIu64 " vertices", CTL_MESH_COUNT_MAX);
        scene->vertex_count = first_of(object, object->instance_count);
    }
    scene->is_loaded = gltf->status == PCCD_OK;
}

static void add_objects(struct gltf_scene *scene, struct ctl_mesh *to)
{
    struct gltf *gltf = &scene->gltf;
    for (size_t i = 0; i < scene->object_count; i++) {
        const struct gltf_object *object = &scene->objects[i];
        const json_t *mesh = gltf_entry(gltf, "meshes", object->mesh);
        const json_t *named = json_object_get(scene->nodes[object->node].json, "name");
        named = json_is_string(named) ? named : json_object_get(mesh, "name");
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
            gltf_mesh_add(gltf, object, first_of(object, k), to);
        }
    }
}

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
        gltf_check(&scene->gltf, is_right,
                   node->has_matrix
                       ? "node %zu: the last row of its matrix is not 0 0 0 1"
                       : "node %zu: its rotation has no length",
                   scene->order[i]);
        if (node->parent != NULL) {
            node->world = product(&node->parent->world, &node->world);
        }
    }
}

static void place_joints(struct gltf_scene *scene, const struct gltf_object *object)
{
    for (size_t i = 0; i < json_array_size(object->joints); i++) {
        long long node = gltf_value(json_array_get(object->joints, i), -1);
        double columns[16];
        struct gltf_place inverse;
        object->places[i] = scene->nodes[node].world;
        if (object->inverses.type != 0) {
            gltf_read(&object->inverses, i, columns);
            gltf_check(&scene->gltf, place_of_matrix(columns, &inverse),
                       "accessor %zu: the last row of matrix %zu is not 0 0 0 1",
                       object->inverses.index, i);
            object->places[i] = product(&object->places[i], &inverse);
        }
    }
}

/* Return where an instance of an object without a skin is. */
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
    gltf_check(&scene->gltf, place_of(pose, &inner),
               "node %zu: the rotation of instance %zu has no length", object->node,
               instance);
    return product(outer, &inner);
}

/* ---- vertices ---------------------------------------------------------------------- */

/* Return where a vertex goes by its joints: their places, each by its part of the
 * weights. */
static struct gltf_place find_blend(struct gltf *gltf, const struct gltf_object *object,
                                    const struct gltf_run *run, size_t vertex)
{
    size_t joint_count = json_array_size(object->joints);
    double sum = 0, weights[4], joints[4];
    struct gltf_place blend = {{0}};
    for (size_t k = 0; k < 4 * run->set_count; k++) {
        if (k % 4 == 0) {
            gltf_read(&run->weights[k / 4], vertex, weights);
            gltf_read(&run->joints[k / 4], vertex, joints);
        }
        double weight = weights[k % 4];
        size_t joint = (size_t)joints[k % 4];
        if (!gltf_check_as(gltf, joint < joint_count, PCCD_E_INDEX,
                           "accessor %zu: vertex %zu has joint %zu of %zu",
                           run->joints[k / 4].index, vertex, joint, joint_count)) {
            return blend;
        }
        sum += weight;
        for (int i = 0; i < 12 && weight != 0; i++) {
            blend.m[i] += weight * object->places[joint].m[i];
        }
    }
    gltf_check(gltf, sum > 0, "accessor %zu: the weights of vertex %zu have the sum %g",
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
        /* Volatile: gcc 12 leaves out the rounding of neighbours
         * (findings/gcc-float-rounding.sh). */
        volatile float rounded = (float)x[axis];
        x[axis] = (double)rounded;
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
            place = find_blend(gltf, object, run, i);
        }
        read_vertex(scene, &scene->nodes[object->node], run, i, from);
        common_transform(place.m, from, to);
        for (int axis = 0; axis < 3; axis++) {
            if (!common_is_coordinate(to[axis])) {
                gltf_check_as(gltf, false, PCCD_E_NOTFINITE,
                              "vertex %zu: coordinate %c is %g; |x| <= 1e18 is needed",
                              first + i, "xyz"[axis], to[axis]);
            }
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
    for (size_t i = 0; i < scene->object_count; i++) {
        const struct gltf_object *object = &scene->objects[i];
        place_joints(scene, object);
        for (size_t k = 0; k < object->instance_count; k++) {
            const struct gltf_place place = place_instance(scene, object, k);
            for (size_t r = 0; r < object->run_count; r++) {
                const struct gltf_run *run = &object->runs[r];
                place_run(scene, object, run, place, first_of(object, k) + run->first, x);
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
    load_scene(scene);
    add_objects(scene, mesh);
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
    open_scene(file, NULL, mesh->error, &scene);
    gltf_check(&scene.gltf, !is_pipe || scene.animation.frame_count <= 1,
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

static void name_frame(const struct ctl_motion *motion, uint32_t frame, char *text,
                       size_t bytes)
{
    const struct gltf_scene *scene = motion->state;
    const struct gltf_animation *animation = &scene->animation;
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
    struct gltf_scene *scene = motion->state;
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
    struct gltf_scene *scene = motion->state;
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
    const struct gltf_scene *scene = motion->state;
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
    bool is_sampled = animation->rate > 0;
    bool turns = animation->turn_degrees > TURN_DEGREES;
    if (length < bytes && (turns || (animation->is_curved && !is_sampled))) {
        char angle[48] = "";
        if (turns) {
            (void)snprintf(angle, sizeof angle, " (up to %.3g degrees)",
                           animation->turn_degrees);
        }
        (void)snprintf(text + length, bytes - length,
                       "%snodes %s between two %s%s: %s has frames between them",
                       length > 0 ? "; " : "",
                       !turns                                ? "curve"
                       : animation->is_curved && !is_sampled ? "turn or curve"
                                                             : "turn",
                       is_sampled ? "frames" : "keyframes", angle,
                       is_sampled ? "a greater --rate" : "--rate N");
    }
    return text[0] != '\0';
}

static void close_scene(struct ctl_motion *motion)
{
    struct gltf_scene *scene = motion->state;
    gltf_close(&scene->gltf);
}

int ctl_gltf_open(struct ctl_motion *motion, const struct ctl_motion_wish *wish)
{
    struct ctl_file *file = &motion->file;
    struct gltf_scene *scene = motion->state = calloc(1, sizeof *scene);
    if (scene == NULL) {
        return ctl_error_set(file->error, PCCD_E_NOMEM, "%s: no memory", file->path);
    }
    motion->format = PCCD_FORMAT_F64;
    motion->read = read_frame;
    motion->shape = read_shape;
    motion->name = name_frame;
    motion->note = note;
    motion->close = close_scene;
    open_scene(file, wish, file->error, scene);
    uint32_t frames = scene->animation.frame_count;
    if (frames > 1) {
        load_scene(scene);
    }
    motion->frame_count = frames > 0 ? frames : 1;
    motion->vertex_count = scene->vertex_count;
    return scene->gltf.status;
}

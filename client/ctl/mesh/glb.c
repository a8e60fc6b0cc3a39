/* client/ctl/mesh/glb.c - binary glTF 2.0: what pccdctl export writes, and other files as
 * simple as that.
 *
 * Room:     client/ctl.
 * Does:     read the triangles, lines and points of all nodes of the scene as one mesh,
 *           node by node, where their translations and the weights of their morph targets
 *           put them. Of an export it reads the objects, not what marks contacts.
 * Does not: read other buffers than the file's own, compressed or sparse data, strips and
 *           fans, or nodes that are turned or scaled: each is an error that names it.
 * Threads:  [any]; nothing is shared.
 * Source:   Khronos Group, "glTF 2.0 Specification".
 */
#include <inttypes.h>
#include <jansson.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "meshfile.h"

#define CHUNK_JSON     0x4e4f534au
#define CHUNK_BIN      0x004e4942u
#define TYPE_U8        5121 /* component types and modes of the specification */
#define TYPE_U16       5123
#define TYPE_U32       5125
#define TYPE_FLOAT     5126
#define MODE_POINTS    0
#define MODE_LINES     1
#define MODE_TRIANGLES 4
#define NODE_DEPTH_MAX 64

struct glb_reader {
    const struct ctl_file *file;
    struct ctl_mesh *mesh;
    struct ctl_error *error;
    json_t *root;
    const char *binary; /* the chunk of data; NULL: none */
    size_t binary_bytes;
    double (*x)[3];
    uint32_t vertex_capacity;
    uint32_t *base; /* [accessors]: the first vertex of its positions, of node base_of */
    uint32_t *base_of; /* [accessors]: 1 and its node's place in what was visited */
    uint32_t visited;  /* nodes */
    bool is_export;    /* of pccdctl */
    bool has_translation;
};

/* A run of elements in the chunk of data. */
struct accessor {
    const char *at;
    size_t count, stride;
    int type; /* of a component */
};

static int fail(struct glb_reader *reader, int status, const char *format, ...)
    __attribute__((format(printf, 3, 4)));
static int fail(struct glb_reader *reader, int status, const char *format, ...)
{
    char what[256];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(what, sizeof what, format, arguments);
    va_end(arguments);
    return ctl_error_set(reader->error, status, "%s: %s", reader->file->path, what);
}

/* An index or count of the JSON; `otherwise` where there is none, -1 where it is none. */
static int64_t number_of(const json_t *object, const char *name, int64_t otherwise)
{
    const json_t *value = json_object_get(object, name);
    if (value == NULL) {
        return otherwise;
    }
    json_int_t number = json_is_integer(value) ? json_integer_value(value) : -1;
    return number < 0 ? -1 : (int64_t)number;
}

/* Entry `index` of an array of the root; NULL: there is none. */
static const json_t *entry_of(const struct glb_reader *reader, const char *array,
                              int64_t index)
{
    return index < 0
               ? NULL
               : json_array_get(json_object_get(reader->root, array), (size_t)index);
}

static size_t bytes_of_type(int type)
{
    switch (type) {
    case TYPE_U8:
        return 1;
    case TYPE_U16:
        return 2;
    case TYPE_U32:
    case TYPE_FLOAT:
        return 4;
    default:
        return 0;
    }
}

/* Find the elements of accessor `index`, which are to be `wanted` of a known type. */
static int find(struct glb_reader *reader, int64_t index, const char *wanted,
                struct accessor *accessor)
{
    const json_t *entry = entry_of(reader, "accessors", index);
    const json_t *view =
        entry_of(reader, "bufferViews", number_of(entry, "bufferView", -1));
    const char *kind = json_string_value(json_object_get(entry, "type"));
    int64_t type = number_of(entry, "componentType", -1);
    int64_t count = number_of(entry, "count", -1);
    if (view == NULL || kind == NULL || json_object_get(entry, "sparse") != NULL) {
        return fail(reader, PCCD_E_FORMAT, "accessor %" PRId64 " is none that is read",
                    index);
    }
    size_t bytes = bytes_of_type((int)(type < INT32_MAX ? type : -1)) *
                   (strcmp(kind, "VEC3") == 0 ? 3 : 1);
    if (strcmp(kind, wanted) != 0 || bytes == 0 ||
        (type == TYPE_FLOAT) != (strcmp(kind, "VEC3") == 0)) {
        return fail(reader, PCCD_E_FORMAT,
                    "accessor %" PRId64 " has %.16s of type %" PRId64, index, kind, type);
    }
    int64_t offset = number_of(entry, "byteOffset", 0);
    int64_t begin = number_of(view, "byteOffset", 0);
    int64_t length = number_of(view, "byteLength", -1);
    int64_t stride = number_of(view, "byteStride", (int64_t)bytes);
    if (number_of(view, "buffer", -1) != 0 || reader->binary == NULL) {
        return fail(reader, PCCD_E_FORMAT,
                    "accessor %" PRId64 " is in a buffer that is not in the file", index);
    }
    if (count < 0 || offset < 0 || begin < 0 || length < 0 || stride < (int64_t)bytes ||
        stride > 252 || (uint64_t)length > reader->binary_bytes ||
        (uint64_t)begin > reader->binary_bytes - (uint64_t)length || offset > length ||
        (count > 0 && (count - 1 > (length - offset) / stride ||
                       (count - 1) * stride + (int64_t)bytes > length - offset))) {
        return fail(reader, PCCD_E_FORMAT,
                    "accessor %" PRId64 " goes beyond the file's data", index);
    }
    accessor->at = reader->binary + begin + offset;
    accessor->count = (size_t)count;
    accessor->stride = (size_t)stride;
    accessor->type = (int)type;
    return PCCD_OK;
}

static float float_at(const struct accessor *accessor, size_t i, int axis)
{
    uint32_t bits = ctl_file_word(accessor->at + i * accessor->stride + 4 * axis);
    float value;
    memcpy(&value, &bits, sizeof value);
    return value;
}

static uint32_t index_at(const struct accessor *accessor, size_t i)
{
    const char *at = accessor->at + i * accessor->stride;
    switch (accessor->type) {
    case TYPE_U8:
        return (unsigned char)at[0];
    case TYPE_U16:
        return (uint32_t)(unsigned char)at[0] | (uint32_t)(unsigned char)at[1] << 8;
    default:
        return ctl_file_word(at);
    }
}

/* ---- vertices ---------------------------------------------------------------------- */

static int reserve(struct glb_reader *reader, size_t count)
{
    uint64_t wanted = (uint64_t)reader->mesh->vertex_count + count;
    if (wanted > CTL_MESH_COUNT_MAX) {
        return fail(reader, PCCD_E_LIMIT, "more than %" PRIu64 " vertices",
                    CTL_MESH_COUNT_MAX);
    }
    if (wanted > reader->vertex_capacity) {
        wanted += wanted / 2;
        wanted = wanted > CTL_MESH_COUNT_MAX ? CTL_MESH_COUNT_MAX : wanted;
        void *x = realloc(reader->x, (size_t)wanted * sizeof *reader->x);
        if (x == NULL) {
            return fail(reader, PCCD_E_NOMEM, "no memory for %" PRIu64 " vertices",
                        wanted);
        }
        reader->x = x;
        reader->vertex_capacity = (uint32_t)wanted;
    }
    return PCCD_OK;
}

/* The positions of a primitive, moved by its morph targets; floats still. */
static int add_positions(struct glb_reader *reader, const json_t *primitive,
                         const json_t *weights, const struct accessor *positions)
{
    double(*x)[3] = reader->x + reader->mesh->vertex_count;
    const json_t *targets = json_object_get(primitive, "targets");
    for (size_t i = 0; i < positions->count; i++) {
        for (int axis = 0; axis < 3; axis++) {
            x[i][axis] = (double)float_at(positions, i, axis);
        }
    }
    for (size_t k = 0; k < json_array_size(targets); k++) {
        double weight = json_number_value(json_array_get(weights, k));
        int64_t moved = number_of(json_array_get(targets, k), "POSITION", -1);
        struct accessor motion;
        if (weight == 0 || moved < 0) {
            continue;
        }
        int status = find(reader, moved, "VEC3", &motion);
        if (status != PCCD_OK) {
            return status;
        }
        if (motion.count != positions->count) {
            return fail(reader, PCCD_E_FORMAT,
                        "a morph target of %zu vertices for %zu vertices", motion.count,
                        positions->count);
        }
        for (size_t i = 0; i < motion.count; i++) {
            for (int axis = 0; axis < 3; axis++) {
                x[i][axis] += weight * (double)float_at(&motion, i, axis);
            }
        }
    }
    for (size_t i = 0; i < positions->count && json_array_size(targets) > 0; i++) {
        for (int axis = 0; axis < 3; axis++) {
            x[i][axis] = (double)(float)x[i][axis];
        }
    }
    return PCCD_OK;
}

static int translate(struct glb_reader *reader, size_t count, const double by[3])
{
    double(*x)[3] = reader->x + reader->mesh->vertex_count;
    for (size_t i = 0; i < count; i++) {
        for (int axis = 0; axis < 3; axis++) {
            x[i][axis] += by[axis];
            if (!ctl_mesh_coordinate_ok(x[i][axis])) {
                return fail(reader, PCCD_E_NOTFINITE,
                            "vertex %zu: coordinate %c is %g; |x| <= 1e18 is needed",
                            reader->mesh->vertex_count + i, "xyz"[axis], x[i][axis]);
            }
        }
    }
    return PCCD_OK;
}

/* The vertices of a primitive: *first and *count. Primitives of one node share those of
 * one accessor. */
static int read_vertices(struct glb_reader *reader, const json_t *primitive,
                         const json_t *weights, const double by[3], uint32_t *first,
                         size_t *count)
{
    int64_t index = number_of(json_object_get(primitive, "attributes"), "POSITION", -1);
    struct accessor positions;
    int status = find(reader, index, "VEC3", &positions);
    *count = status == PCCD_OK ? positions.count : 0;
    if (status == PCCD_OK && *count == 0) {
        return PCCD_OK; /* nothing is read, and there may be no memory yet */
    }
    if (status == PCCD_OK && reader->base_of[index] == reader->visited) {
        *first = reader->base[index];
        return PCCD_OK;
    }
    if (status == PCCD_OK) {
        status = reserve(reader, positions.count);
    }
    if (status == PCCD_OK) {
        status = add_positions(reader, primitive, weights, &positions);
    }
    if (status == PCCD_OK) {
        status = translate(reader, positions.count, by);
    }
    if (status == PCCD_OK) {
        reader->base_of[index] = reader->visited;
        reader->base[index] = *first = reader->mesh->vertex_count;
        reader->mesh->vertex_count += (uint32_t)positions.count;
    }
    return status;
}

/* ---- features ---------------------------------------------------------------------- */

static int add_feature(struct glb_reader *reader, size_t points, const uint32_t *vertices)
{
    const char *path = reader->file->path;
    if (points == 3) {
        return ctl_mesh_add_triangle(reader->mesh, vertices, path, reader->error);
    }
    return points == 2
               ? ctl_mesh_add_edge(reader->mesh, vertices, path, reader->error)
               : ctl_mesh_add_point(reader->mesh, vertices[0], path, reader->error);
}

static int read_primitive(struct glb_reader *reader, const json_t *primitive,
                          const json_t *weights, const double by[3])
{
    int64_t mode = number_of(primitive, "mode", MODE_TRIANGLES);
    bool has_indices = json_object_get(primitive, "indices") != NULL;
    size_t points = mode == MODE_TRIANGLES ? 3 : mode == MODE_LINES ? 2 : 1;
    struct accessor indices = {.count = 0};
    uint32_t first = 0;
    size_t count = 0;
    if (points == 1 && mode != MODE_POINTS) {
        return fail(reader, PCCD_E_FORMAT, "a primitive of mode %" PRId64, mode);
    }
    if (json_object_get(primitive, "extensions") != NULL) {
        return fail(reader, PCCD_E_FORMAT, "a primitive is compressed or extended");
    }
    int status = read_vertices(reader, primitive, weights, by, &first, &count);
    if (status == PCCD_OK && has_indices) {
        status = find(reader, number_of(primitive, "indices", -1), "SCALAR", &indices);
    }
    size_t all = has_indices ? indices.count : count;
    if (status == PCCD_OK && all % points != 0) {
        return fail(reader, PCCD_E_FORMAT, "%zu corners where %zu make a feature", all,
                    points);
    }
    for (size_t i = 0; i < all && status == PCCD_OK; i += points) {
        uint32_t vertices[3];
        for (size_t k = 0; k < points; k++) {
            size_t vertex = has_indices ? index_at(&indices, i + k) : i + k;
            if (vertex >= count) {
                return fail(reader, PCCD_E_INDEX, "index %zu of %zu vertices", vertex,
                            count);
            }
            vertices[k] = first + (uint32_t)vertex;
        }
        status = add_feature(reader, points, vertices);
    }
    return status;
}

/* ---- nodes ------------------------------------------------------------------------- */

static bool has_other_than(const json_t *array, const double *usual, size_t count)
{
    bool differs = false;
    for (size_t i = 0; i < count && json_array_size(array) == count; i++) {
        differs |= json_number_value(json_array_get(array, i)) != usual[i];
    }
    return differs || (array != NULL && json_array_size(array) != count);
}

/* Where a node is, `by` its parents already. */
static int place(struct glb_reader *reader, const json_t *node, int64_t index,
                 double by[3])
{
    static const double ones[3] = {1, 1, 1}, still[4] = {0, 0, 0, 1};
    static const double unit[16] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};
    const json_t *translation = json_object_get(node, "translation");
    if (has_other_than(json_object_get(node, "rotation"), still, 4) ||
        has_other_than(json_object_get(node, "scale"), ones, 3) ||
        has_other_than(json_object_get(node, "matrix"), unit, 16)) {
        return fail(reader, PCCD_E_FORMAT,
                    "node %" PRId64
                    " is turned, scaled or has a matrix: apply that first",
                    index);
    }
    for (size_t axis = 0; axis < 3; axis++) {
        double by_node = json_number_value(json_array_get(translation, axis));
        by[axis] += by_node;
        reader->has_translation |= by_node != 0;
    }
    return PCCD_OK;
}

static int read_mesh(struct glb_reader *reader, const json_t *node, const double by[3])
{
    const char *name = json_string_value(json_object_get(node, "name"));
    int64_t index = number_of(node, "mesh", -1);
    const json_t *mesh = entry_of(reader, "meshes", index);
    const json_t *weights = json_object_get(node, "weights");
    const json_t *primitives = json_object_get(mesh, "primitives");
    int status = PCCD_OK;
    if (json_object_get(node, "mesh") == NULL ||
        (reader->is_export && (name == NULL || strncmp(name, "object ", 7) != 0))) {
        return PCCD_OK;
    }
    if (mesh == NULL) {
        return fail(reader, PCCD_E_INDEX, "there is no mesh %" PRId64, index);
    }
    weights = weights != NULL ? weights : json_object_get(mesh, "weights");
    for (size_t i = 0; i < json_array_size(primitives) && status == PCCD_OK; i++) {
        status = read_primitive(reader, json_array_get(primitives, i), weights, by);
    }
    return status;
}

/* A list of nodes that is being gone through. */
struct glb_level {
    const json_t *nodes;
    size_t next;
    double by[3];
};

/* The nodes of the scene and their children, parents first. A file whose nodes are in a
 * circle, or have two parents, has more visits than nodes. */
static int read_nodes(struct glb_reader *reader, const json_t *nodes)
{
    struct glb_level levels[NODE_DEPTH_MAX] = {{.nodes = nodes}};
    size_t most = json_array_size(json_object_get(reader->root, "nodes"));
    int depth = 0;
    while (depth >= 0) {
        struct glb_level *level = &levels[depth];
        if (level->next == json_array_size(level->nodes)) {
            depth--;
            continue;
        }
        const json_t *number = json_array_get(level->nodes, level->next++);
        int64_t index = json_is_integer(number) ? json_integer_value(number) : -1;
        const json_t *node = entry_of(reader, "nodes", index);
        if (node == NULL || reader->visited == most) {
            return fail(reader, PCCD_E_FORMAT, "node %" PRId64 " is none of a tree",
                        index);
        }
        reader->visited++;
        double by[3] = {level->by[0], level->by[1], level->by[2]};
        int status = place(reader, node, index, by);
        if (status == PCCD_OK) {
            status = read_mesh(reader, node, by);
        }
        const json_t *children = json_object_get(node, "children");
        if (status == PCCD_OK && json_array_size(children) > 0) {
            if (depth + 1 == NODE_DEPTH_MAX) {
                return fail(reader, PCCD_E_LIMIT, "nodes more than %d deep",
                            NODE_DEPTH_MAX);
            }
            levels[++depth] = (struct glb_level){children, 0, {by[0], by[1], by[2]}};
        }
        if (status != PCCD_OK) {
            return status;
        }
    }
    return PCCD_OK;
}

/* ---- the file ---------------------------------------------------------------------- */

/* Of the beginning of a file: its first chunk is JSON, and it is as long as it says. */
static int check_head(const char *path, const char *data, size_t bytes,
                      uint64_t all_bytes, struct ctl_error *error)
{
    if (bytes < 20 || memcmp(data, "glTF", 4) != 0) {
        return ctl_error_set(error, PCCD_E_FORMAT, "%s: no binary glTF", path);
    }
    if (ctl_file_word(data + 4) != 2) {
        return ctl_error_set(error, PCCD_E_FORMAT,
                             "%s: glTF of version %" PRIu32 ", not 2", path,
                             ctl_file_word(data + 4));
    }
    if (ctl_file_word(data + 8) > all_bytes || ctl_file_word(data + 16) != CHUNK_JSON ||
        (uint64_t)ctl_file_word(data + 12) + 20 > ctl_file_word(data + 8)) {
        return ctl_error_set(error, PCCD_E_FORMAT,
                             "%s: its header tells of %" PRIu32
                             " bytes, of which %" PRIu32 " describe it; it has %" PRIu64,
                             path, ctl_file_word(data + 8), ctl_file_word(data + 12),
                             all_bytes);
    }
    return PCCD_OK;
}

static int parse_json(struct glb_reader *reader)
{
    const char *data = reader->file->data;
    size_t json_bytes = ctl_file_word(data + 12);
    size_t all_bytes = ctl_file_word(data + 8);
    const char *next = data + 20 + json_bytes;
    json_error_t wrong;
    reader->root = json_loadb(data + 20, json_bytes, 0, &wrong);
    if (reader->root == NULL) {
        return fail(reader, PCCD_E_FORMAT, "its JSON, byte %d: %s", wrong.position,
                    wrong.text);
    }
    if (all_bytes - 20 - json_bytes >= 8 && ctl_file_word(next + 4) == CHUNK_BIN &&
        ctl_file_word(next) <= all_bytes - 28 - json_bytes) {
        reader->binary = next + 8;
        reader->binary_bytes = ctl_file_word(next);
    }
    const char *maker = json_string_value(
        json_object_get(json_object_get(reader->root, "asset"), "generator"));
    reader->is_export = maker != NULL && strcmp(maker, "pccdctl export") == 0;
    return PCCD_OK;
}

/* Hand the coordinates over, as floats where nothing was added to them. */
static int finish(struct glb_reader *reader)
{
    struct ctl_mesh *mesh = reader->mesh;
    uint32_t count = mesh->vertex_count;
    int status = ctl_mesh_alloc_vertices(
        mesh, reader->has_translation ? PCCD_FORMAT_F64 : PCCD_FORMAT_F32, count,
        reader->file->path, reader->error);
    for (size_t i = 0; i < (size_t)count * 3 && status == PCCD_OK; i++) {
        ctl_mesh_set(mesh, i, ((const double *)reader->x)[i]);
    }
    return status;
}

int ctl_glb_parse(struct ctl_file *file, struct ctl_mesh *mesh, struct ctl_error *error)
{
    struct glb_reader reader = {.file = file, .mesh = mesh, .error = error};
    int status = check_head(file->path, file->data, file->bytes, file->bytes, error);
    if (status == PCCD_OK) {
        status = parse_json(&reader);
    }
    if (status == PCCD_OK) {
        size_t accessors = json_array_size(json_object_get(reader.root, "accessors"));
        reader.base = calloc(accessors + 1, sizeof *reader.base);
        reader.base_of = calloc(accessors + 1, sizeof *reader.base_of);
        if (reader.base == NULL || reader.base_of == NULL) {
            status =
                fail(&reader, PCCD_E_NOMEM, "no memory for %zu accessors", accessors);
        }
    }
    if (status == PCCD_OK) {
        const json_t *scene =
            entry_of(&reader, "scenes", number_of(reader.root, "scene", 0));
        status = read_nodes(&reader, json_object_get(scene, "nodes"));
    }
    if (status == PCCD_OK && mesh->vertex_count > 0) {
        status = finish(&reader);
    }
    free(reader.x);
    free(reader.base);
    free(reader.base_of);
    json_decref(reader.root);
    return status;
}

int ctl_glb_judge(const struct ctl_file *begin, bool *is_text, struct ctl_error *error)
{
    *is_text = false;
    return check_head(begin->path, begin->data, begin->bytes,
                      begin->bytes + begin->rest_bytes, error);
}

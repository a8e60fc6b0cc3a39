/* gltf.c - a step as binary glTF 2.0. */
#include "export.h"

#include <errno.h>
#include <jansson.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "output.h"

#define GLB_MAGIC    0x46546c67u /* "glTF" */
#define GLB_JSON     0x4e4f534au
#define GLB_BIN      0x004e4942u
#define FLOAT        5126 /* component types, targets and modes of the specification */
#define UNSIGNED     5125
#define ARRAY        34962
#define INDICES      34963
#define POINTS       0
#define LINES        1
#define TRIANGLES    4
#define NORMAL_SIZE  0.02 /* of the extent */
#define CONTACT_SIZE 0.004
#define SHADES       16u /* colours of times */

struct gltf {
    uint8_t *bytes;
    size_t count, room;
    json_t *views, *accessors, *meshes, *nodes, *channels, *samplers, *materials;
    const struct snapshot *snapshot;
    int times, weights; /* accessors of the animation; -1: not made yet */
    bool has_memory;
};

static void append(json_t *array, json_t *value, struct gltf *gltf)
{
    if (json_array_append_new(array, value) != 0) {
        gltf->has_memory = false;
    }
}

/* Bytes of the buffer, and a view of them: its number. */
static int add_view(struct gltf *gltf, const void *bytes, size_t count, int target)
{
    size_t end = gltf->count + (count + 3) / 4 * 4;
    if (end > gltf->room) {
        size_t room = end + end / 2;
        uint8_t *larger = realloc(gltf->bytes, room);
        if (larger == NULL) {
            gltf->has_memory = false;
            return 0;
        }
        gltf->bytes = larger;
        gltf->room = room;
    }
    memset(gltf->bytes + gltf->count, 0, end - gltf->count);
    memcpy(gltf->bytes + gltf->count, bytes, count);
    json_t *view = json_pack("{s:i, s:I, s:I}", "buffer", 0, "byteOffset",
                             (json_int_t)gltf->count, "byteLength", (json_int_t)count);
    if (target != 0) {
        json_object_set_new(view, "target", json_integer(target));
    }
    append(gltf->views, view, gltf);
    gltf->count = end;
    return (int)json_array_size(gltf->views) - 1;
}

static int add_accessor(struct gltf *gltf, int view, int component, const char *type,
                        size_t count)
{
    append(gltf->accessors,
           json_pack("{s:i, s:i, s:s, s:I}", "bufferView", view, "componentType",
                     component, "type", type, "count", (json_int_t)count),
           gltf);
    return (int)json_array_size(gltf->accessors) - 1;
}

/* Positions must tell their bounds. */
static int add_vectors(struct gltf *gltf, const float (*x)[3], size_t count,
                       bool has_bounds)
{
    int made = add_accessor(gltf, add_view(gltf, x, count * sizeof *x, ARRAY), FLOAT,
                            "VEC3", count);
    float low[3] = {INFINITY, INFINITY, INFINITY};
    float high[3] = {-INFINITY, -INFINITY, -INFINITY};
    for (size_t i = 0; i < count; i++) {
        for (int k = 0; k < 3; k++) {
            low[k] = fminf(low[k], x[i][k]);
            high[k] = fmaxf(high[k], x[i][k]);
        }
    }
    json_t *accessor = json_array_get(gltf->accessors, (size_t)made);
    if (has_bounds && count > 0) {
        json_object_set_new(
            accessor, "min",
            json_pack("[f, f, f]", (double)low[0], (double)low[1], (double)low[2]));
        json_object_set_new(
            accessor, "max",
            json_pack("[f, f, f]", (double)high[0], (double)high[1], (double)high[2]));
    }
    return made;
}

static void add_material(struct gltf *gltf, const float colour[3], bool is_surface)
{
    append(gltf->materials,
           json_pack("{s:b, s:{s:[f, f, f, f], s:f, s:f}}", "doubleSided", is_surface,
                     "pbrMetallicRoughness", "baseColorFactor", (double)colour[0],
                     (double)colour[1], (double)colour[2], 1.0, "metallicFactor", 0.0,
                     "roughnessFactor", 0.9),
           gltf);
}

static void add_node(struct gltf *gltf, json_t *primitives, const char *name,
                     json_t *weights)
{
    json_t *mesh =
        json_pack("{s:o, s:o}", "name", json_text(name), "primitives", primitives);
    if (weights != NULL) {
        json_object_set_new(mesh, "weights", weights);
    }
    append(gltf->meshes, mesh, gltf);
    json_t *node = json_pack("{s:o, s:I}", "name", json_text(name), "mesh",
                             (json_int_t)json_array_size(gltf->meshes) - 1);
    const double *origin = gltf->snapshot->origin;
    if (gltf->snapshot->has_origin) {
        json_object_set_new(node, "translation",
                            json_pack("[f, f, f]", origin[0], origin[1], origin[2]));
    }
    append(gltf->nodes, node, gltf);
}

/* From where it is to the end of the step, as the weight of the morph target says. */
static void animate(struct gltf *gltf, size_t node)
{
    static const float times[2] = {0, 1}, weights[2] = {0, 1};
    if (gltf->times < 0) {
        gltf->times = add_accessor(gltf, add_view(gltf, times, sizeof times, 0), FLOAT,
                                   "SCALAR", 2);
        json_t *accessor = json_array_get(gltf->accessors, (size_t)gltf->times);
        json_object_set_new(accessor, "min", json_pack("[f]", 0.0));
        json_object_set_new(accessor, "max", json_pack("[f]", 1.0));
        gltf->weights = add_accessor(gltf, add_view(gltf, weights, sizeof weights, 0),
                                     FLOAT, "SCALAR", 2);
        append(gltf->samplers,
               json_pack("{s:i, s:i, s:s}", "input", gltf->times, "output", gltf->weights,
                         "interpolation", "LINEAR"),
               gltf);
    }
    append(gltf->channels,
           json_pack("{s:i, s:{s:I, s:s}}", "sampler", 0, "target", "node",
                     (json_int_t)node, "path", "weights"),
           gltf);
}

/* The start of the step, so that the weight is the time. */
static float (*start_of(const struct snapshot_object *object, double t))[3]
{
    float(*x)[3] = malloc(object->vertex_count * sizeof *x);
    for (uint32_t i = 0; x != NULL && i < object->vertex_count; i++) {
        for (int k = 0; k < 3; k++) {
            x[i][k] = object->x[i][k] - (float)t * object->motion[i][k];
        }
    }
    return x;
}

/* The attributes of an object's vertices, and the accessor of their motion. */
struct vertices {
    json_t *attributes;
    int motion;
};

/* Some of an object's features, by the indices of their vertices, if there are any. */
static void add_features(struct gltf *gltf, json_t *primitives, const uint32_t *indices,
                         size_t count, int mode, const struct vertices *vertices)
{
    if (count == 0) {
        return;
    }
    int view = add_view(gltf, indices, count * sizeof *indices, INDICES);
    int made = add_accessor(gltf, view, UNSIGNED, "SCALAR", count);
    append(primitives,
           json_pack("{s:o, s:i, s:i, s:I, s:[{s:i}]}", "attributes",
                     json_copy(vertices->attributes), "indices", made, "mode", mode,
                     "material", (json_int_t)json_array_size(gltf->materials) - 1,
                     "targets", "POSITION", vertices->motion),
           gltf);
}

static void add_object(struct gltf *gltf, const struct snapshot_object *object,
                       uint32_t i, double t)
{
    float front[3], back[3];
    char name[32];
    json_t *primitives = json_array();
    if (object->triangle_count + object->edge_count + object->point_count == 0) {
        json_decref(primitives); /* its vertices are named by nothing */
        return;
    }
    float(*x)[3] = start_of(object, t);
    if (x == NULL || primitives == NULL) {
        gltf->has_memory = false;
        json_decref(primitives);
        free(x);
        return;
    }
    colour_of_object(i, front, back);
    add_material(gltf, front, true);
    int positions = add_vectors(gltf, (const float(*)[3])x, object->vertex_count, true);
    int motion =
        add_vectors(gltf, (const float(*)[3])object->motion, object->vertex_count, true);
    struct vertices vertices = {json_pack("{s:i}", "POSITION", positions), motion};
    if (object->radii != NULL) {
        int view = add_view(gltf, object->radii,
                            object->vertex_count * sizeof *object->radii, ARRAY);
        json_object_set_new(vertices.attributes, "_RADIUS",
                            json_integer(add_accessor(gltf, view, FLOAT, "SCALAR",
                                                      object->vertex_count)));
    }
    add_features(gltf, primitives, (const uint32_t *)object->triangles,
                 3 * (size_t)object->triangle_count, TRIANGLES, &vertices);
    add_features(gltf, primitives, (const uint32_t *)object->edges,
                 2 * (size_t)object->edge_count, LINES, &vertices);
    add_features(gltf, primitives, object->points, object->point_count, POINTS,
                 &vertices);
    json_decref(vertices.attributes);
    snprintf(name, sizeof name, "object 0x%x", object->handle);
    add_node(gltf, primitives, object->name != NULL ? object->name : name,
             json_pack("[f]", t));
    animate(gltf, json_array_size(gltf->nodes) - 1);
    free(x);
}

/* Coloured lines between two points each. */
static void add_coloured(struct gltf *gltf, const float (*x)[3],
                         const float (*colours)[3], size_t count, const char *name)
{
    static const float white[3] = {1, 1, 1};
    add_material(gltf, white, false);
    int positions = add_vectors(gltf, x, count, true);
    int tints = add_vectors(gltf, colours, count, false);
    add_node(gltf,
             json_pack("[{s:{s:i, s:i}, s:i, s:I}]", "attributes", "POSITION", positions,
                       "COLOR_0", tints, "mode", LINES, "material",
                       (json_int_t)json_array_size(gltf->materials) - 1),
             name, NULL);
}

/* Lines between nearest points, by their shares of the greatest distance. */
static void add_lines(struct gltf *gltf, const struct snapshot *snapshot)
{
    size_t count = 2 * snapshot->line_count;
    double greatest = snapshot_greatest(snapshot);
    float(*x)[3] = malloc((count + 1) * sizeof *x);
    float(*colours)[3] = malloc((count + 1) * sizeof *colours);
    for (size_t i = 0; x != NULL && colours != NULL && i < count; i++) {
        const struct snapshot_line *line = &snapshot->lines[i / 2];
        memcpy(x[i], line->ends[i % 2], sizeof *x);
        colour_of_time(greatest > 0 ? line->distance / greatest : 0, colours[i]);
    }
    if (x == NULL || colours == NULL) {
        gltf->has_memory = false;
    } else {
        add_coloured(gltf, (const float(*)[3])x, (const float(*)[3])colours, count,
                     "near");
    }
    free(x);
    free(colours);
}

/* The octahedra of one colour, if there are any. */
static void add_shade(struct gltf *gltf, json_t *primitives, const uint32_t *indices,
                      size_t count, uint32_t shade, int positions)
{
    float colour[3];
    if (count == 0) {
        return;
    }
    colour_of_time((double)shade / (SHADES - 1), colour);
    add_material(gltf, colour, false);
    int view = add_view(gltf, indices, count * sizeof *indices, INDICES);
    append(primitives,
           json_pack("{s:{s:i}, s:i, s:i, s:I}", "attributes", "POSITION", positions,
                     "indices", add_accessor(gltf, view, UNSIGNED, "SCALAR", count),
                     "mode", TRIANGLES, "material",
                     (json_int_t)json_array_size(gltf->materials) - 1),
           gltf);
}

/* Small octahedra: what draws glTF leaves out points, or draws them without their
 * colours. Those of about the same time share a material. */
static void add_contacts(struct gltf *gltf, const struct snapshot *snapshot)
{
    enum { CORNERS = 6, INDICES_EACH = 24 };
    static const uint32_t sides[INDICES_EACH] = {0, 2, 4, 2, 1, 4, 1, 3, 4, 3, 0, 4,
                                                 2, 0, 5, 1, 2, 5, 3, 1, 5, 0, 3, 5};
    size_t count = snapshot->contact_count;
    float(*x)[3] = malloc((CORNERS * count + 1) * sizeof *x);
    uint32_t *indices = malloc((INDICES_EACH * count + 1) * sizeof *indices);
    json_t *primitives = json_array();
    if (x == NULL || indices == NULL || primitives == NULL) {
        gltf->has_memory = false;
    } else {
        for (size_t i = 0; i < CORNERS * count; i++) {
            const struct snapshot_contact *contact = &snapshot->contacts[i / CORNERS];
            for (size_t k = 0; k < 3; k++) {
                float way = i % CORNERS / 2 != k ? 0 : i % 2 == 0 ? 1.0f : -1.0f;
                x[i][k] = contact->at[k] + contact->share * contact->reach[k] +
                          (float)(CONTACT_SIZE * snapshot->extent) * way;
            }
        }
        int positions = add_vectors(gltf, (const float(*)[3])x, CORNERS * count, true);
        for (uint32_t shade = 0; shade < SHADES; shade++) {
            size_t used = 0;
            for (size_t i = 0; i < count; i++) {
                double t = fmin(fmax(snapshot->contacts[i].toi, 0), 1);
                for (size_t k = 0;
                     (uint32_t)(t * (SHADES - 1) + 0.5) == shade && k < INDICES_EACH;
                     k++) {
                    indices[used++] = (uint32_t)(CORNERS * i) + sides[k];
                }
            }
            add_shade(gltf, primitives, indices, used, shade, positions);
        }
        add_node(gltf, primitives, "contacts", NULL);
        primitives = NULL;
    }
    json_decref(primitives);
    free(indices);
    free(x);
}

/* Lines of the normals' direction, in the colours of their times. That of a contact at a
 * distance goes to the nearest point of its first feature. */
static void add_normals(struct gltf *gltf, const struct snapshot *snapshot)
{
    const uint32_t each = 2;
    size_t count = snapshot->contact_count * each;
    float(*x)[3] = malloc((count + 1) * sizeof *x);
    float(*colours)[3] = malloc((count + 1) * sizeof *colours);
    for (size_t i = 0; x != NULL && colours != NULL && i < count; i++) {
        const struct snapshot_contact *contact = &snapshot->contacts[i / each];
        const float *reach = contact->reach;
        bool is_apart = reach[0] != 0 || reach[1] != 0 || reach[2] != 0;
        float size = is_apart ? 1 : (float)(NORMAL_SIZE * snapshot->extent);
        for (int k = 0; k < 3; k++) {
            float way = is_apart ? reach[k] : contact->normal[k];
            x[i][k] = contact->at[k] + (i % each == 0 ? 0 : size * way);
        }
        colour_of_time(contact->toi, colours[i]);
    }
    if (x == NULL || colours == NULL) {
        gltf->has_memory = false;
    } else {
        add_coloured(gltf, (const float(*)[3])x, (const float(*)[3])colours, count,
                     "contact normals");
    }
    free(x);
    free(colours);
}

static json_t *describe(struct gltf *gltf, const struct snapshot *snapshot)
{
    json_t *nodes = json_array();
    for (size_t i = 0; i < json_array_size(gltf->nodes); i++) {
        append(nodes, json_integer((json_int_t)i), gltf);
    }
    json_t *all = json_pack(
        "{s:{s:s, s:s}, s:i, s:[{s:o}], s:O, s:O, s:O, s:O, s:O, s:[{s:I}], s:{s:I, s:f, "
        "s:I}}",
        "asset", "version", "2.0", "generator", "pccdctl export", "scene", 0, "scenes",
        "nodes", nodes, "nodes", gltf->nodes, "meshes", gltf->meshes, "materials",
        gltf->materials, "accessors", gltf->accessors, "bufferViews", gltf->views,
        "buffers", "byteLength", (json_int_t)gltf->count, "extras", "step",
        (json_int_t)snapshot->step, "t", snapshot->t, "contacts",
        (json_int_t)snapshot->contact_count);
    if (snapshot->lines != NULL) {
        json_object_set_new(json_object_get(all, "extras"), "near",
                            json_integer((json_int_t)snapshot->line_count));
    }
    if (json_array_size(gltf->channels) > 0) {
        json_object_set_new(all, "animations",
                            json_pack("[{s:s, s:O, s:O}]", "name", "step", "channels",
                                      gltf->channels, "samplers", gltf->samplers));
    }
    return all;
}

static bool write_words(FILE *to, const uint32_t *words, size_t count)
{
    return fwrite(words, sizeof *words, count, to) == count;
}

static bool write_all(struct gltf *gltf, const char *text, FILE *to)
{
    uint32_t text_bytes = (uint32_t)((strlen(text) + 3) / 4 * 4);
    uint32_t all = 12 + 8 + text_bytes + 8 + (uint32_t)gltf->count;
    bool ok = write_words(to, (const uint32_t[]){GLB_MAGIC, 2, all}, 3) &&
              write_words(to, (const uint32_t[]){text_bytes, GLB_JSON}, 2) &&
              fputs(text, to) >= 0;
    for (size_t i = strlen(text); i < text_bytes; i++) {
        ok = ok && putc(' ', to) != EOF;
    }
    return ok && write_words(to, (const uint32_t[]){(uint32_t)gltf->count, GLB_BIN}, 2) &&
           fwrite(gltf->bytes, 1, gltf->count, to) == gltf->count;
}

static void deinit(struct gltf *gltf)
{
    json_decref(gltf->views);
    json_decref(gltf->accessors);
    json_decref(gltf->meshes);
    json_decref(gltf->nodes);
    json_decref(gltf->channels);
    json_decref(gltf->samplers);
    json_decref(gltf->materials);
    free(gltf->bytes);
}

int gltf_write(const struct snapshot *snapshot, FILE *to, const char *path,
               struct ctl_error *error)
{
    struct gltf gltf = {.snapshot = snapshot,
                        .views = json_array(),
                        .accessors = json_array(),
                        .meshes = json_array(),
                        .nodes = json_array(),
                        .channels = json_array(),
                        .samplers = json_array(),
                        .materials = json_array(),
                        .times = -1,
                        .weights = -1,
                        .has_memory = true};
    int status = PCCD_OK;
    for (uint32_t i = 0; i < snapshot->object_count; i++) {
        add_object(&gltf, &snapshot->objects[i], i, snapshot->t);
    }
    if (snapshot->contact_count > 0) {
        add_contacts(&gltf, snapshot);
        add_normals(&gltf, snapshot);
    }
    if (snapshot->line_count > 0) {
        add_lines(&gltf, snapshot);
    }
    json_t *all = describe(&gltf, snapshot);
    char *text = all != NULL ? json_dumps(all, JSON_COMPACT) : NULL;
    if (text == NULL || !gltf.has_memory) {
        status = ctl_error_set(error, PCCD_E_NOMEM, "%s: no memory", path);
    } else if (gltf.count + strlen(text) > UINT32_MAX - 64) {
        status = ctl_error_set(error, PCCD_E_LIMIT, "%s: more than glTF can hold", path);
    } else if (!write_all(&gltf, text, to)) {
        status = ctl_error_set(error, PCCD_E_SYSTEM, "%s: cannot write: %s", path,
                               strerror(errno));
    }
    free(text);
    json_decref(all);
    deinit(&gltf);
    return status;
}

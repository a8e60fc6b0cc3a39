/* client/ctl/mesh/gltf_mesh.c - a mesh of a glTF file: its vertices and features.
 *
 * Room:     client/ctl.
 * Does:     runs of vertices; the seven modes of primitives.
 * Threads:  one at a time.
 * Source:   gltf_mesh.h.
 */
#include "gltf_mesh.h"

#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "pccd_types.h"

#define COMPRESSION "compression" /* in the name of an extension of primitives */
#define RUNS_TRIED  64 /* for the same vertices, before a primitive has its own */

enum { POINTS, LINES, LINE_LOOP, LINE_STRIP, TRIANGLES, STRIP, FAN, MODES };

/* Of a mode: corners of a feature, what the number of indices is a multiple of, and how
 * many more each needs that share them. */
static const struct {
    size_t corners, each, least;
    const char *name;
} modes[MODES] = {
    [POINTS] = {1, 1, 1, "points"},         [LINES] = {2, 2, 2, "lines"},
    [LINE_LOOP] = {2, 1, 2, "a line loop"}, [LINE_STRIP] = {2, 1, 2, "a line strip"},
    [TRIANGLES] = {3, 3, 3, "triangles"},   [STRIP] = {3, 1, 3, "a triangle strip"},
    [FAN] = {3, 1, 3, "a triangle fan"},
};

/* ---- runs of vertices -------------------------------------------------------------- */

/* The attribute of a set: "JOINTS" and 2 is JOINTS_2. NULL: there is none. */
static const json_t *attribute_of(const json_t *primitive, const char *name, size_t set)
{
    char numbered[32];
    snprintf(numbered, sizeof numbered, "%s_%zu", name, set);
    return json_object_get(json_object_get(primitive, "attributes"), numbered);
}

static int read_targets(struct gltf *gltf, const json_t *primitive, size_t count,
                        struct gltf_run *run)
{
    const json_t *targets = json_object_get(primitive, "targets");
    run->targets = calloc(count + 1, sizeof *run->targets);
    if (run->targets == NULL) {
        return gltf_fail(gltf, PCCD_E_NOMEM, "no memory for %zu morph targets", count);
    }
    for (size_t k = 0; k < count; k++) {
        const json_t *target = json_array_get(targets, k);
        if (json_object_get(target, "POSITION") == NULL) {
            continue;
        }
        int status = gltf_accessor_find(gltf, gltf_number(target, "POSITION", -1), "VEC3",
                                        GLTF_POSITIONS, &run->targets[k]);
        if (status == PCCD_OK && run->targets[k].count != run->positions.count) {
            return gltf_fail(gltf, PCCD_E_FORMAT,
                             "accessor %zu: a morph target of %zu vertices for %zu "
                             "vertices",
                             run->targets[k].index, run->targets[k].count,
                             run->positions.count);
        }
        if (status != PCCD_OK) {
            return status;
        }
    }
    return PCCD_OK;
}

static int read_influences(struct gltf *gltf, const json_t *primitive,
                           struct gltf_run *run)
{
    size_t count = 0;
    while (attribute_of(primitive, "JOINTS", count) != NULL) {
        count++;
    }
    run->influences = calloc(count + 1, sizeof *run->influences);
    if (run->influences == NULL) {
        return gltf_fail(gltf, PCCD_E_NOMEM, "no memory for %zu sets of joints", count);
    }
    for (size_t set = 0; set < count; set++) {
        struct gltf_influence *influence = &run->influences[set];
        const json_t *joints = attribute_of(primitive, "JOINTS", set);
        const json_t *weights = attribute_of(primitive, "WEIGHTS", set);
        int status = gltf_accessor_find(
            gltf, json_is_integer(joints) ? json_integer_value(joints) : -1, "VEC4",
            GLTF_U8 | GLTF_U16, &influence->joints);
        if (status == PCCD_OK) {
            status = gltf_accessor_find(
                gltf, json_is_integer(weights) ? json_integer_value(weights) : -1, "VEC4",
                GLTF_FLOAT | GLTF_U8 | GLTF_U16 | GLTF_NORMALIZED, &influence->weights);
        }
        if (status != PCCD_OK) {
            return status;
        }
        if (influence->joints.count != run->positions.count ||
            influence->weights.count != run->positions.count) {
            return gltf_fail(gltf, PCCD_E_FORMAT,
                             "accessor %zu: joints and weights of %zu and %zu vertices "
                             "for %zu vertices",
                             influence->joints.index, influence->joints.count,
                             influence->weights.count, run->positions.count);
        }
    }
    run->influence_count = count;
    return PCCD_OK;
}

/* Whether two primitives have the same vertices, moved by the same. */
static bool is_same_run(const json_t *a, const json_t *b)
{
    bool is_same =
        json_equal(json_object_get(json_object_get(a, "attributes"), "POSITION"),
                   json_object_get(json_object_get(b, "attributes"), "POSITION"));
    const json_t *targets = json_object_get(a, "targets");
    is_same = is_same && (targets == NULL) == (json_object_get(b, "targets") == NULL) &&
              (targets == NULL || json_equal(targets, json_object_get(b, "targets")));
    for (size_t set = 0; is_same; set++) {
        const json_t *joints = attribute_of(a, "JOINTS", set);
        const json_t *others = attribute_of(b, "JOINTS", set);
        if (joints == NULL && others == NULL) {
            break;
        }
        is_same =
            json_equal(joints, others) &&
            json_equal(attribute_of(a, "WEIGHTS", set), attribute_of(b, "WEIGHTS", set));
    }
    return is_same;
}

static int read_run(struct gltf *gltf, const json_t *primitive, struct gltf_mesh *mesh,
                    struct gltf_run *run)
{
    int64_t index = gltf_number(json_object_get(primitive, "attributes"), "POSITION", -1);
    *run =
        (struct gltf_run){.primitive = primitive, .first = (uint32_t)mesh->vertex_count};
    int status = gltf_accessor_find(gltf, index, "VEC3", GLTF_POSITIONS, &run->positions);
    if (status == PCCD_OK) {
        status = read_targets(gltf, primitive, mesh->target_count, run);
    }
    if (status == PCCD_OK) {
        status = read_influences(gltf, primitive, run);
    }
    mesh->vertex_count += run->positions.count;
    if (status == PCCD_OK && mesh->vertex_count > CTL_MESH_COUNT_MAX) {
        return gltf_fail(gltf, PCCD_E_LIMIT, "more than %" PRIu64 " vertices",
                         CTL_MESH_COUNT_MAX);
    }
    return status;
}

/* What can be said of a primitive before its accessors. */
static int judge_primitive(struct gltf *gltf, int64_t index, size_t i,
                           const struct gltf_mesh *mesh)
{
    const json_t *primitive = json_array_get(mesh->primitives, i);
    const json_t *extensions = json_object_get(primitive, "extensions");
    size_t targets = json_array_size(json_object_get(primitive, "targets"));
    int64_t mode = gltf_number(primitive, "mode", TRIANGLES);
    const char *name;
    json_t *value;
    json_object_foreach((json_t *)extensions, name, value)
    {
        if (strstr(name, COMPRESSION) != NULL) {
            return gltf_fail(gltf, PCCD_E_FORMAT,
                             "mesh %" PRId64 ", primitive %zu: is compressed by "
                             "\"%.80s\", which is not read",
                             index, i, name);
        }
    }
    if (mode < 0 || mode >= MODES) {
        return gltf_fail(gltf, PCCD_E_FORMAT,
                         "mesh %" PRId64 ", primitive %zu: there is no mode %" PRId64,
                         index, i, mode);
    }
    if (json_object_get(json_object_get(primitive, "attributes"), "POSITION") == NULL) {
        return gltf_fail(gltf, PCCD_E_FORMAT,
                         "mesh %" PRId64 ", primitive %zu: has no positions", index, i);
    }
    if (targets != mesh->target_count) {
        return gltf_fail(gltf, PCCD_E_FORMAT,
                         "mesh %" PRId64 ", primitive %zu: has %zu morph targets, the "
                         "first one %zu",
                         index, i, targets, mesh->target_count);
    }
    return PCCD_OK;
}

int gltf_mesh_read(struct gltf *gltf, int64_t index, struct gltf_mesh *mesh)
{
    const json_t *entry = gltf_entry(gltf, "meshes", index);
    const json_t *primitives = json_object_get(entry, "primitives");
    size_t count = json_array_size(primitives);
    *mesh = (struct gltf_mesh){
        .is_read = true,
        .primitives = primitives,
        .runs = calloc(count + 1, sizeof *mesh->runs),
        .run_of = calloc(count + 1, sizeof *mesh->run_of),
        .target_count =
            json_array_size(json_object_get(json_array_get(primitives, 0), "targets")),
    };
    if (mesh->runs == NULL || mesh->run_of == NULL) {
        return gltf_fail(gltf, PCCD_E_NOMEM, "no memory for %zu primitives", count);
    }
    int status = PCCD_OK;
    for (size_t i = 0; i < count && status == PCCD_OK; i++) {
        const json_t *primitive = json_array_get(primitives, i);
        status = judge_primitive(gltf, index, i, mesh);
        size_t run = mesh->run_count, tried = 0;
        while (run > 0 && tried < RUNS_TRIED &&
               !is_same_run(primitive, mesh->runs[run - 1].primitive)) {
            run--;
            tried++;
        }
        bool has_own = run == 0 || tried == RUNS_TRIED;
        mesh->run_of[i] = has_own ? mesh->run_count : run - 1;
        if (status == PCCD_OK && has_own) {
            status = read_run(gltf, primitive, mesh, &mesh->runs[mesh->run_count++]);
        }
    }
    return status;
}

void gltf_mesh_deinit(struct gltf_mesh *mesh)
{
    for (size_t i = 0; i < mesh->run_count; i++) {
        free(mesh->runs[i].targets);
        free(mesh->runs[i].influences);
    }
    free(mesh->runs);
    free(mesh->run_of);
    *mesh = (struct gltf_mesh){.is_read = false};
}

/* ---- features ---------------------------------------------------------------------- */

/* Which of `count` indices is corner k of feature i. */
static size_t corner_of(int64_t mode, size_t i, size_t k, size_t count)
{
    switch (mode) {
    case LINE_LOOP:
        return (i + k) % count;
    case STRIP:
        return k == 0 ? i : k == 1 ? i + 1 + i % 2 : i + 2 - i % 2;
    case FAN:
        return k == 2 ? 0 : i + k + 1;
    default:
        return i * modes[mode].each + k;
    }
}

static size_t feature_count(int64_t mode, size_t count)
{
    return count == 0             ? 0
           : mode == LINE_LOOP    ? count
           : modes[mode].each > 1 ? count / modes[mode].each
                                  : count - modes[mode].least + 1;
}

static int add_feature(int64_t mode, const uint32_t corners[3], struct ctl_mesh *to)
{
    bool is_degenerate =
        corners[0] == corners[1] || corners[1] == corners[2] || corners[2] == corners[0];
    enum ctl_kind kind = modes[mode].corners - 1;
    /* Strips use these to go on elsewhere: they show nothing. */
    return kind == CTL_TRIANGLES && mode != TRIANGLES && is_degenerate
               ? PCCD_OK
               : ctl_mesh_add(to, kind, corners);
}

static int add_primitive(struct gltf *gltf, const json_t *primitive,
                         const struct gltf_run *run, uint32_t first, struct ctl_mesh *to)
{
    int64_t mode = gltf_number(primitive, "mode", TRIANGLES);
    bool has_indices = json_object_get(primitive, "indices") != NULL;
    size_t vertices = run->positions.count, count = vertices;
    struct gltf_accessor indices = {.count = 0};
    if (has_indices) {
        int status = gltf_accessor_find(gltf, gltf_number(primitive, "indices", -1),
                                        "SCALAR", GLTF_INDICES, &indices);
        if (status != PCCD_OK) {
            return status;
        }
        count = indices.count;
    }
    if (count % modes[mode].each != 0 || (count > 0 && count < modes[mode].least)) {
        return gltf_fail(gltf, PCCD_E_FORMAT, "accessor %zu: %zu corners for %s",
                         has_indices ? indices.index : run->positions.index, count,
                         modes[mode].name);
    }
    uint32_t restart = indices.type == GLTF_U8    ? UINT8_MAX
                       : indices.type == GLTF_U16 ? UINT16_MAX
                                                  : UINT32_MAX;
    size_t features = feature_count(mode, count);
    bool is_plain = indices.at != NULL && indices.sparse_count == 0;
    for (size_t i = 0; i < features; i++) {
        uint32_t corners[3] = {0, 0, 0};
        for (size_t k = 0; k < modes[mode].corners; k++) {
            size_t at = corner_of(mode, i, k, count);
            uint32_t vertex =
                !has_indices ? (uint32_t)at
                : is_plain
                    ? gltf_integer_at(indices.at + at * indices.stride, indices.type)
                    : gltf_accessor_integer(&indices, at, 0);
            if (has_indices && vertex == restart) {
                return gltf_fail(gltf, PCCD_E_FORMAT,
                                 "accessor %zu: index %zu is %" PRIu32
                                 ", which would begin a primitive anew",
                                 indices.index, at, vertex);
            }
            if (vertex >= vertices) {
                return gltf_fail(gltf, PCCD_E_INDEX,
                                 "accessor %zu: index %zu is %" PRIu32 " of %zu vertices",
                                 indices.index, at, vertex, vertices);
            }
            corners[k] = first + run->first + vertex;
        }
        int status = add_feature(mode, corners, to);
        if (status != PCCD_OK) {
            return status;
        }
    }
    return PCCD_OK;
}

int gltf_mesh_add(struct gltf *gltf, const struct gltf_mesh *mesh, uint32_t first,
                  struct ctl_mesh *to)
{
    int status = PCCD_OK;
    for (size_t i = 0; i < json_array_size(mesh->primitives) && status == PCCD_OK; i++) {
        status = add_primitive(gltf, json_array_get(mesh->primitives, i),
                               &mesh->runs[mesh->run_of[i]], first, to);
    }
    return status;
}

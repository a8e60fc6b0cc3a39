/* client/ctl/mesh/gltf_mesh.c - a mesh of a glTF file: its vertices and features. */
#include <inttypes.h>
#include <stdio.h>
#include <string.h>

#include "gltf_scene.h"

#define RUNS_TRIED 64 /* for the same vertices, before a primitive has its own */

enum { POINTS, LINES, LINE_LOOP, LINE_STRIP, TRIANGLES, STRIP, FAN, MODES };

/* Modes of primitives: what the features are, what the number of indices is a multiple
 * of, and how many there are at least, if there are any. */
static const struct {
    enum ctl_kind kind;
    size_t each, least;
    const char *name;
} modes[MODES] = {
    [POINTS] = {CTL_POINTS, 1, 1, "points"},
    [LINES] = {CTL_EDGES, 2, 2, "lines"},
    [LINE_LOOP] = {CTL_EDGES, 1, 2, "a line loop"},
    [LINE_STRIP] = {CTL_EDGES, 1, 2, "a line strip"},
    [TRIANGLES] = {CTL_TRIANGLES, 3, 3, "triangles"},
    [STRIP] = {CTL_TRIANGLES, 1, 3, "a triangle strip"},
    [FAN] = {CTL_TRIANGLES, 1, 3, "a triangle fan"},
};

/* ---- runs of vertices -------------------------------------------------------------- */

/* The attribute of a set: "JOINTS" and 2 is JOINTS_2. NULL: there is none. */
static const json_t *attribute_of(const json_t *primitive, const char *name, size_t set)
{
    char numbered[32];
    snprintf(numbered, sizeof numbered, "%s_%zu", name, set);
    return json_object_get(json_object_get(primitive, "attributes"), numbered);
}

static const json_t *positions_of(const json_t *primitive)
{
    return json_object_get(json_object_get(primitive, "attributes"), "POSITION");
}

static bool is_same(const json_t *a, const json_t *b)
{
    return a == b || json_equal(a, b);
}

/* Return whether two primitives have the same vertices, moved by the same. */
static bool is_same_run(const json_t *a, const json_t *b)
{
    bool has_same = is_same(positions_of(a), positions_of(b)) &&
                    is_same(json_object_get(a, "targets"), json_object_get(b, "targets"));
    bool has_set = true;
    for (size_t set = 0; has_same && has_set; set++) {
        const json_t *joints = attribute_of(a, "JOINTS", set);
        has_set = joints != NULL;
        has_same = is_same(joints, attribute_of(b, "JOINTS", set)) &&
                   (!has_set || is_same(attribute_of(a, "WEIGHTS", set),
                                        attribute_of(b, "WEIGHTS", set)));
    }
    return has_same;
}

/* An accessor that has as many elements as the run has vertices. */
static struct gltf_accessor find_of_run(struct gltf *gltf, const json_t *number,
                                        enum gltf_role role, const struct gltf_run *run,
                                        const char *what)
{
    struct gltf_accessor found = gltf_find(gltf, number, role);
    gltf_check(gltf, found.count == run->positions.count,
               "accessor %zu: %s of %zu vertices for %zu vertices", found.index, what,
               found.count, run->positions.count);
    return found;
}

static void read_run(struct gltf *gltf, const json_t *primitive,
                     struct gltf_object *object)
{
    struct gltf_run *run = &object->runs[object->run_count++];
    const json_t *targets = json_object_get(primitive, "targets");
    *run = (struct gltf_run){.primitive = primitive, .first = object->vertex_count};
    run->positions = gltf_find(gltf, positions_of(primitive), GLTF_POSITIONS);
    while (attribute_of(primitive, "JOINTS", run->set_count) != NULL) {
        run->set_count++;
    }
    run->targets =
        gltf_alloc(gltf, json_array_size(targets), sizeof *run->targets, "morph targets");
    run->joints = gltf_alloc(gltf, run->set_count, sizeof *run->joints, "sets of joints");
    run->weights =
        gltf_alloc(gltf, run->set_count, sizeof *run->weights, "sets of weights");
    gltf_check(gltf, object->skin == NULL || run->set_count > 0,
               "mesh %lld: has no joints for the skin of node %zu", object->mesh,
               object->node);
    for (size_t k = 0; k < json_array_size(targets) && gltf->status == PCCD_OK; k++) {
        const json_t *moves = json_object_get(json_array_get(targets, k), "POSITION");
        if (moves != NULL) {
            run->targets[k] =
                find_of_run(gltf, moves, GLTF_POSITIONS, run, "a morph target");
        }
    }
    for (size_t set = 0; set < run->set_count && gltf->status == PCCD_OK; set++) {
        run->joints[set] = find_of_run(gltf, attribute_of(primitive, "JOINTS", set),
                                       GLTF_JOINTS, run, "joints");
        run->weights[set] = find_of_run(gltf, attribute_of(primitive, "WEIGHTS", set),
                                        GLTF_JOINT_WEIGHTS, run, "weights");
    }
    gltf_check_as(gltf, run->positions.count <= CTL_MESH_COUNT_MAX - run->first,
                  PCCD_E_LIMIT, "more than %" PRIu64 " vertices", CTL_MESH_COUNT_MAX);
    object->vertex_count += (uint32_t)run->positions.count;
}

/* Check of a primitive what can be known before its accessors are read. */
static void judge_primitive(struct gltf *gltf, const struct gltf_object *object, size_t i,
                            const json_t *primitive)
{
    const char *compression = gltf_compression(primitive);
    size_t targets = json_array_size(json_object_get(primitive, "targets"));
    long long mode = gltf_number(primitive, "mode", TRIANGLES);
    gltf_check(gltf, compression == NULL,
               "mesh %lld, primitive %zu: is compressed by \"%.80s\", which is not read",
               object->mesh, i, compression);
    gltf_check(gltf, mode >= 0 && mode < MODES,
               "mesh %lld, primitive %zu: there is no mode %lld", object->mesh, i, mode);
    gltf_check(gltf, positions_of(primitive) != NULL,
               "mesh %lld, primitive %zu: has no positions", object->mesh, i);
    gltf_check(gltf, targets == object->target_count,
               "mesh %lld, primitive %zu: has %zu morph targets, the first one %zu",
               object->mesh, i, targets, object->target_count);
}

void gltf_mesh_read(struct gltf *gltf, struct gltf_object *object)
{
    size_t count = json_array_size(object->primitives);
    object->runs = gltf_alloc(gltf, count, sizeof *object->runs, "primitives");
    object->run_of = gltf_alloc(gltf, count, sizeof *object->run_of, "primitives");
    for (size_t i = 0; i < count && gltf->status == PCCD_OK; i++) {
        const json_t *primitive = json_array_get(object->primitives, i);
        size_t run = object->run_count, last = run > RUNS_TRIED ? run - RUNS_TRIED : 0;
        while (run > last && !is_same_run(primitive, object->runs[run - 1].primitive)) {
            run--;
        }
        object->run_of[i] = run > last ? run - 1 : object->run_count;
        judge_primitive(gltf, object, i, primitive);
        if (run == last && gltf->status == PCCD_OK) {
            read_run(gltf, primitive, object);
        }
    }
}

/* ---- features ---------------------------------------------------------------------- */

/* Return which of `count` indices is corner k of feature i. */
static size_t corner_of(long long mode, size_t i, size_t k, size_t count)
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

/* The vertex of a run that corner `at` of a primitive is. Without a type there are no
 * indices: it is that corner. */
static inline uint32_t vertex_of(struct gltf *gltf, const struct gltf_accessor *indices,
                                 size_t vertices, size_t at)
{
    uint32_t vertex = (uint32_t)at, restart = UINT32_MAX;
    double number;
    if (indices->at != NULL && indices->sparse_count == 0) {
        vertex = ctl_file_integer(indices->at + at * indices->stride, indices->bytes);
    } else if (indices->type != 0) {
        gltf_read(indices, at, &number);
        vertex = (uint32_t)number;
    }
    restart >>= indices->type != 0 ? 32 - 8 * indices->bytes : 0;
    if (vertex >= vertices || vertex == restart) {
        gltf_check(gltf, vertex != restart,
                   "accessor %zu: index %zu is %" PRIu32
                   ", which would begin a primitive anew",
                   indices->index, at, vertex);
        gltf_check_as(gltf, false, PCCD_E_INDEX,
                      "accessor %zu: index %zu is %" PRIu32 " of %zu vertices",
                      indices->index, at, vertex, vertices);
    }
    return vertex;
}

static void add_primitive(struct gltf *gltf, const json_t *primitive,
                          const struct gltf_run *run, uint32_t first, struct ctl_mesh *to)
{
    long long mode = gltf_number(primitive, "mode", TRIANGLES);
    const json_t *number = json_object_get(primitive, "indices");
    const size_t each = modes[mode].each, least = modes[mode].least;
    struct gltf_accessor indices = {.index = run->positions.index,
                                    .count = run->positions.count};
    if (number != NULL) {
        indices = gltf_find(gltf, number, GLTF_INDICES);
    }
    gltf_check(
        gltf, indices.count == 0 || (indices.count >= least && indices.count % each == 0),
        "accessor %zu: %zu corners for %s", indices.index, indices.count,
        modes[mode].name);
    size_t features = indices.count == 0  ? 0
                      : mode == LINE_LOOP ? indices.count
                                          : (indices.count - least) / each + 1;
    for (size_t i = 0; i < features && gltf->status == PCCD_OK; i++) {
        uint32_t corners[3] = {0, 0, 0};
        for (size_t k = 0; k <= modes[mode].kind; k++) {
            corners[k] = first + run->first +
                         vertex_of(gltf, &indices, run->positions.count,
                                   corner_of(mode, i, k, indices.count));
        }
        /* Strips use triangles without area to go on elsewhere: they show nothing. */
        bool is_strip = mode == STRIP || mode == FAN;
        if (gltf->status == PCCD_OK && !(is_strip && ctl_is_flat(corners))) {
            gltf->status = ctl_mesh_add(to, modes[mode].kind, corners);
        }
    }
}

void gltf_mesh_add(struct gltf *gltf, const struct gltf_object *object, uint32_t first,
                   struct ctl_mesh *to)
{
    for (size_t i = 0; i < json_array_size(object->primitives); i++) {
        add_primitive(gltf, json_array_get(object->primitives, i),
                      &object->runs[object->run_of[i]], first, to);
    }
}

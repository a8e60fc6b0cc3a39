/* target_mesh.c - any mesh, of triangles, edges and points, and a step of it. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "fuzz_target.h"
#include "kernel.h"
#include "memory.h"
#include "step.h"

#define VERTICES_MAX  32u
#define TRIANGLES_MAX 48u

struct shape {
    enum pccd_format format;
    uint32_t vertex_count;
    struct eng_mesh_counts counts;
    double separation;
    uint8_t width;
    uint32_t triangles[TRIANGLES_MAX][3];
    uint32_t edges[TRIANGLES_MAX][2];
    uint32_t points[TRIANGLES_MAX];
    double x[3][VERTICES_MAX][3]; /* as registered; both ends of the step */
};

static double take_coordinate(struct fuzz_input *input, uint8_t width)
{
    double value;
    float narrow;
    uint64_t bits;
    uint32_t half;
    switch (width % 4) {
    case 0:
        bits = fuzz_take_u64(input);
        memcpy(&value, &bits, sizeof value);
        return value;
    case 1:
        half = fuzz_take_u32(input);
        memcpy(&narrow, &half, sizeof narrow);
        return (double)narrow;
    case 2:
        return (int16_t)fuzz_take_u16(input);
    default:
        return (int8_t)fuzz_take_u8(input) / 16.0;
    }
}

static void take_named(struct shape *shape, uint32_t part, const uint32_t v[3])
{
    switch (part) {
    case 0:
        memcpy(shape->triangles[shape->counts.triangles++], v, 3 * sizeof *v);
        break;
    case 1:
        memcpy(shape->edges[shape->counts.edges++], v, 2 * sizeof *v);
        break;
    default:
        shape->points[shape->counts.points++] = v[0];
    }
}

static void take_shape(struct fuzz_input *input, struct shape *shape)
{
    uint8_t choices = fuzz_take_u8(input);
    shape->width = choices;
    shape->format = choices / 4 % 2 == 0 ? PCCD_FORMAT_F64 : PCCD_FORMAT_F32;
    shape->vertex_count = fuzz_take_u8(input) % VERTICES_MAX + 1;
    shape->separation = choices / 128 % 2 == 0 ? 0 : 0.25;
    uint32_t named = fuzz_take_u8(input) % TRIANGLES_MAX + 1;
    for (uint32_t i = 0; i < named; i++) {
        uint32_t v[3];
        for (uint32_t k = 0; k < 3; k++) {
            uint32_t corner = fuzz_take_u8(input);
            /* One choice lets indices be out of range. */
            v[k] = choices / 8 % 8 == 7 ? corner : corner % shape->vertex_count;
        }
        /* One bit makes edges and points of some. */
        take_named(shape, choices / 64 % 2 == 0 ? 0 : i % 3, v);
    }
    shape->counts.vertices = shape->vertex_count;
    for (uint32_t i = 0; i < 3 * shape->vertex_count * 3; i++) {
        uint32_t vertex = i / 3 % shape->vertex_count;
        shape->x[i / (3 * shape->vertex_count)][vertex][i % 3] =
            take_coordinate(input, choices);
    }
}

/* Positions in the shape's format, to any of three buffers. */
static const void *positions(const struct shape *shape, int which)
{
    static float narrow[3][VERTICES_MAX][3];
    if (shape->format == PCCD_FORMAT_F64) {
        return shape->x[which];
    }
    for (uint32_t i = 0; i < shape->vertex_count * 3; i++) {
        double value = shape->x[which][i / 3][i % 3];
        /* Beyond the range of float: one that is refused. */
        narrow[which][i / 3][i % 3] = fabs(value) < 1e38 ? (float)value : (float)INFINITY;
    }
    return narrow[which];
}

static bool is_refusal(int status)
{
    FUZZ_CHECK(status != PCCD_E_NOMEM || fuzz_scarcity_hits() > 0);
    return status != PCCD_OK;
}

/* Register. Returns whether there is a mesh now. */
static bool make_mesh(const struct shape *shape, struct eng_mesh **mesh)
{
    uint32_t bad = 0;
    if (is_refusal(eng_mesh_make(&shape->counts, mesh))) {
        *mesh = NULL;
        return false;
    }
    int status = eng_mesh_write_vertices(*mesh, shape->format, 0, shape->vertex_count,
                                         positions(shape, 0));
    if (status == PCCD_OK && shape->counts.triangles > 0) {
        status = eng_mesh_write_triangles(*mesh, 0, shape->counts.triangles,
                                          shape->triangles, &bad);
        FUZZ_CHECK(status != PCCD_E_INDEX || bad < shape->counts.triangles);
    }
    if (status == PCCD_OK && shape->counts.edges > 0) {
        status = eng_mesh_write_edges(*mesh, 0, shape->counts.edges, shape->edges, &bad);
        FUZZ_CHECK(status != PCCD_E_INDEX || bad < shape->counts.edges);
    }
    if (status == PCCD_OK && shape->counts.points > 0) {
        status =
            eng_mesh_write_points(*mesh, 0, shape->counts.points, shape->points, &bad);
        FUZZ_CHECK(status != PCCD_E_INDEX || bad < shape->counts.points);
    }
    if (!is_refusal(status)) {
        status = eng_mesh_commit(*mesh, 1);
    }
    if (!is_refusal(status)) {
        status = eng_mesh_sort_features(*mesh, 1);
    }
    return !is_refusal(status);
}

/* Move both objects: one as the input says, the other as a rigid body or not at all. */
static int stage(struct eng_scene *scene, const struct shape *shape,
                 const uint32_t idx[2])
{
    static const double still[12] = {1, 0, 0, 0.25, 0, 1, 0, 0.5, 0, 0, 1, 0};
    static const double turned[12] = {0, 1, 0, 0, -1, 0, 0, 0, 0, 0, 1, 0.125};
    eng_stage_begin(scene);
    int status = eng_stage_x0x1(scene, idx[0], shape->format, 0, shape->vertex_count,
                                positions(shape, 1), positions(shape, 2));
    if (status == PCCD_OK) {
        status = eng_stage_rigid(scene, idx[1], 0, shape->vertex_count, still, turned);
    }
    if (status != PCCD_OK) {
        eng_stage_abort(scene);
    }
    return status;
}

/* One step. Returns whether there is a whole answer. */
static bool run(struct eng_scene *scene, const struct shape *shape, const uint32_t idx[2],
                const struct eng_question *settings, struct eng_step_result *result)
{
    if (is_refusal(stage(scene, shape, idx)) ||
        is_refusal(eng_step(scene, settings, result))) {
        return false;
    }
    FUZZ_CHECK(result->incomplete == PCCD_COMPLETE || fuzz_scarcity_hits() > 0);
    return result->incomplete == PCCD_COMPLETE;
}

static void compare(struct eng_scene *scene, const struct shape *shape,
                    const uint32_t idx[2], uint8_t choices)
{
    struct eng_question settings = ENG_QUESTION_DEFAULT;
    struct eng_step_result all;
    struct eng_step_result other;
    settings.distance = shape->separation;
    settings.kernels = eng_kernels_of((enum eng_isa)(choices % ENG_ISA_COUNT));
    if (!run(scene, shape, idx, &settings, &all)) {
        return;
    }
    settings.kernels = NULL;
    settings.method = PCCD_METHOD_PAPER;
    if (run(scene, shape, idx, &settings, &other)) {
        FUZZ_CHECK(other.hash[1] == all.hash[1] && other.hash[0] == all.hash[0]);
    }
    settings.method = choices / 8 % 2 == 0 ? PCCD_METHOD_WIDE : PCCD_METHOD_PAPER;
    settings.mode = PCCD_MODE_FIRST;
    if (run(scene, shape, idx, &settings, &other)) {
        FUZZ_CHECK((other.count > 0) == (all.count > 0) && other.count <= all.count);
        FUZZ_CHECK(other.toi_first == all.toi_first);
    }
    settings.mode = PCCD_MODE_ANY;
    if (run(scene, shape, idx, &settings, &other)) {
        FUZZ_CHECK(other.verdict == (all.count > 0 ? PCCD_VERDICT_YES : PCCD_VERDICT_NO));
    }
}

void fuzz_mesh(const uint8_t *data, size_t bytes)
{
    static struct shape shape;
    struct fuzz_input input = {data, bytes};
    struct eng_mesh *mesh = NULL;
    struct eng_scene *scene = NULL;
    uint32_t idx[2];
    uint64_t bytes_before = eng_alloc_bytes();
    uint8_t choices = fuzz_take_u8(&input);
    memset(&shape, 0, sizeof shape);
    take_shape(&input, &shape);
    if (make_mesh(&shape, &mesh) && !is_refusal(eng_scene_new(NULL, &scene)) &&
        !is_refusal(eng_scene_add(scene, mesh, 7, &idx[0])) &&
        !is_refusal(eng_scene_add(scene, mesh, 9, &idx[1]))) {
        compare(scene, &shape, idx, choices);
    }
    eng_scene_free(scene);
    eng_mesh_release(mesh);
    FUZZ_CHECK(eng_alloc_bytes() == bytes_before);
}

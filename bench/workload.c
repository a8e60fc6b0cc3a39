/* bench/workload.c - the scenes that are measured.
 *
 * Room:     bench. May include: tests/support/{data,ply,prng}.h.
 * Does:     analytic motions with fixed constants and seeds: what they cost depends on
 *           the detector alone. Lengths are in units of a sheet's side.
 * Threads:  one.
 */
#include "workload.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "data.h"
#include "ply.h"
#include "prng.h"
#include "report.h"

#define PI     3.14159265358979323846
#define FRAMES 16u
#define WAVES  12

static struct bench_object *add_object(struct bench_scene *scene, uint32_t vertex_count,
                                       uint32_t triangle_count)
{
    struct bench_object *object = &scene->objects[scene->object_count++];
    object->vertex_count = vertex_count;
    object->triangle_count = triangle_count;
    object->triangles = bench_alloc(triangle_count, sizeof *object->triangles);
    object->first_vertex = scene->vertex_count;
    scene->vertex_count += vertex_count;
    return object;
}

/* All objects are known. */
static void add_frames(struct bench_scene *scene, uint32_t frame_count)
{
    scene->frame_count = frame_count;
    scene->x = bench_alloc((size_t)frame_count * scene->vertex_count, sizeof *scene->x);
}

/* side x side vertices in rows, two triangles a square. */
static void add_sheet(struct bench_scene *scene, uint32_t side)
{
    struct bench_object *sheet =
        add_object(scene, side * side, 2 * (side - 1) * (side - 1));
    uint32_t(*t)[3] = sheet->triangles;
    for (uint32_t row = 0; row + 1 < side; row++) {
        for (uint32_t column = 0; column + 1 < side; column++) {
            uint32_t a = row * side + column;
            uint32_t b = a + side;
            const uint32_t pair[2][3] = {{a, a + 1, b + 1}, {a, b + 1, b}};
            memcpy(t, pair, sizeof pair);
            t += 2;
        }
    }
}

/* A ball of 2 rings x rings quads, two poles. */
static void add_ball(struct bench_scene *scene, uint32_t rings)
{
    uint32_t around = 2 * rings;
    uint32_t count = (rings - 1) * around + 2;
    struct bench_object *ball = add_object(scene, count, 2 * around * (rings - 1));
    uint32_t(*t)[3] = ball->triangles;
    for (uint32_t j = 0; j < around; j++) {
        uint32_t next_j = (j + 1) % around;
        uint32_t last = (rings - 2) * around;
        const uint32_t caps[2][3] = {{count - 2, j, next_j},
                                     {count - 1, last + next_j, last + j}};
        memcpy(t, caps, sizeof caps);
        t += 2;
        for (uint32_t i = 0; i + 2 < rings; i++) {
            uint32_t a = i * around;
            const uint32_t quad[2][3] = {{a + j, a + around + j, a + around + next_j},
                                         {a + j, a + around + next_j, a + next_j}};
            memcpy(t, quad, sizeof quad);
            t += 2;
        }
    }
}

static void place_ball(double (*x)[3], uint32_t rings, double radius, double turn)
{
    uint32_t around = 2 * rings;
    for (uint32_t i = 1; i < rings; i++) {
        double polar = PI * i / rings;
        for (uint32_t j = 0; j < around; j++) {
            double *at = x[(i - 1) * around + j];
            double angle = 2 * PI * j / around + turn;
            at[0] = radius * sin(polar) * cos(angle);
            at[1] = radius * sin(polar) * sin(angle);
            at[2] = radius * cos(polar);
        }
    }
    const double poles[2][3] = {{0, 0, radius}, {0, 0, -radius}};
    memcpy(x[(rings - 1) * around], poles, sizeof poles);
}

/* A sheet laid over a ball: on it down to the angle `reach`, hanging in pleats below, all
 * of it turning with the ball. The pleats deepen with time until neighbours touch. */
static void place_cloth(double (*x)[3], uint32_t side, double time)
{
    const double radius = 0.3;
    const double pleats = 9;
    double reach = 0.9 + 0.6 * time;
    double turn = 1.5 * time;
    double gap = 0.004 - 0.003 * time;
    for (uint32_t i = 0; i < side * side; i++) {
        double u = (double)(i % side) / (side - 1) * 2 - 1;
        double v = (double)(i / side) / (side - 1) * 2 - 1;
        double along = sqrt(u * u + v * v); /* from the middle, on the cloth */
        double angle = atan2(v, u);
        double polar = along / radius < reach ? along / radius : reach;
        double below = along - polar * radius;
        double depth = below / (below + 0.2);
        double out = (radius + gap) * sin(polar) + depth * 0.12 * sin(pleats * angle);
        angle += depth * (0.2 + 0.5 * time) * sin(2 * pleats * angle) / pleats + turn;
        x[i][0] = (out + 0.3 * below) * cos(angle);
        x[i][1] = (out + 0.3 * below) * sin(angle);
        x[i][2] = (radius + gap) * cos(polar) - 0.9 * below;
    }
}

static void make_cloth(struct bench_scene *scene, uint32_t side)
{
    uint32_t rings = side / 3;
    add_sheet(scene, side);
    add_ball(scene, rings);
    add_frames(scene, FRAMES);
    for (uint32_t f = 0; f < FRAMES; f++) {
        /* Frames of a fortieth of the whole motion: about an edge of way at the rim. */
        double time = 0.3 + f / 40.0;
        place_cloth(bench_scene_x(scene, f, 0), side, time);
        place_ball(bench_scene_x(scene, f, 1), rings, 0.3, 1.5 * time);
    }
}

static void make_cloth_20k(struct bench_scene *scene, bool small)
{
    make_cloth(scene, small ? 21 : 91);
}

static void make_cloth_100k(struct bench_scene *scene, bool small)
{
    make_cloth(scene, small ? 31 : 203);
}

/* A sheet crushed into a ball: each coordinate is a sum of waves over the sheet. */
static void make_crumpled(struct bench_scene *scene, bool small)
{
    uint32_t side = small ? 21 : 91;
    double waves[3][WAVES][4]; /* wave numbers, phase, speed */
    struct prng prng = {7};
    add_sheet(scene, side);
    add_frames(scene, FRAMES);
    for (int k = 0; k < 3 * WAVES; k++) {
        double *wave = waves[k / WAVES][k % WAVES];
        wave[0] = 14 * prng_between(&prng, -0.5, 0.5);
        wave[1] = 14 * prng_between(&prng, -0.5, 0.5);
        wave[2] = prng_between(&prng, 0, 2 * PI);
        wave[3] = prng_between(&prng, -0.5, 0.5);
    }
    for (uint32_t f = 0; f < FRAMES; f++) {
        double(*x)[3] = bench_scene_x(scene, f, 0);
        for (uint32_t i = 0; i < side * side; i++) {
            double u = (double)(i % side) / (side - 1);
            double v = (double)(i / side) / (side - 1);
            for (int k = 0; k < 3; k++) {
                x[i][k] = 0;
                for (int w = 0; w < WAVES; w++) {
                    const double *wave = waves[k][w];
                    x[i][k] += 0.1 * sin(wave[0] * u + wave[1] * v + wave[2] +
                                         wave[3] * 0.05 * f);
                }
            }
        }
    }
}

static void place_sheet(double (*x)[3], uint32_t side, const double at[3], double phase)
{
    for (uint32_t i = 0; i < side * side; i++) {
        double u = (double)(i % side) / (side - 1);
        double v = (double)(i / side) / (side - 1);
        x[i][0] = at[0] + u;
        x[i][1] = at[1] + v;
        x[i][2] = at[2] + 0.02 * sin(9 * u + phase) * cos(7 * v - phase);
    }
}

/* One sheet flies through another: a step of twenty edges, flat sheets, no thickness. */
static void make_fast(struct bench_scene *scene, bool small)
{
    uint32_t side = small ? 17 : 72;
    add_sheet(scene, side);
    add_sheet(scene, side);
    add_frames(scene, FRAMES);
    for (uint32_t f = 0; f < FRAMES; f++) {
        double way = f % 2 ? 10.0 / side : -10.0 / side;
        place_sheet(bench_scene_x(scene, f, 0), side, (const double[]){0, 0, 0}, 0);
        place_sheet(bench_scene_x(scene, f, 1), side,
                    (const double[]){0.3 / side, 0.4 / side, way}, 1 + 0.1 * f);
    }
}

/* Triangles that all fill the same cube: no box test rejects anything. */
static void make_all_overlap(struct bench_scene *scene, bool small)
{
    uint32_t count = small ? 20 : 120;
    struct bench_object *soup = add_object(scene, 3 * count, count);
    struct prng prng = {11};
    add_frames(scene, FRAMES);
    for (uint32_t i = 0; i < 3 * count; i++) {
        soup->triangles[i / 3][i % 3] = i;
    }
    for (uint32_t i = 0; i < FRAMES * 3 * count; i++) {
        /* Corners of a triangle in different octants, so that its box is large. */
        for (unsigned k = 0; k < 3; k++) {
            double low = (i % 3 + k) % 3 == 0 ? 0.8 : (i % 3 + k) % 3 == 1 ? 0 : 0.4;
            scene->x[i][k] = low + prng_between(&prng, 0, 0.2);
        }
    }
}

static void make_still(struct bench_scene *scene, bool small)
{
    make_cloth(scene, small ? 21 : 91);
    size_t frame_bytes = scene->vertex_count * sizeof *scene->x;
    for (uint32_t f = 1; f < FRAMES; f++) {
        memcpy(bench_scene_x(scene, f, 0), scene->x, frame_bytes);
    }
}

/* A wavy sheet jumps a hundred sides away and back, past a sheet that waits halfway. */
static void make_teleport(struct bench_scene *scene, bool small)
{
    uint32_t side = small ? 17 : 72;
    add_sheet(scene, side);
    add_sheet(scene, side);
    add_frames(scene, FRAMES);
    for (uint32_t f = 0; f < FRAMES; f++) {
        double jump = f % 2 ? 100 : 0;
        place_sheet(bench_scene_x(scene, f, 0), side,
                    (const double[]){jump, 0.5 * jump, 0}, 0.1 * f);
        place_sheet(bench_scene_x(scene, f, 1), side, (const double[]){50, 25, 0.5}, 0);
    }
}

/* Two recorded frames with the same faces. */
static bool read_recorded(struct bench_scene *scene, const char *const names[2])
{
    struct ply frames[2] = {{0}, {0}};
    char path[DATA_PATH_MAX];
    bool good = true;
    for (int f = 0; f < 2 && good; f++) {
        good = data_find(names[f], path) && ply_read(path, &frames[f]);
    }
    if (good && frames[0].vertex_count == frames[1].vertex_count) {
        struct bench_object *object =
            add_object(scene, frames[0].vertex_count, frames[0].triangle_count);
        memcpy(object->triangles, frames[0].triangles,
               object->triangle_count * sizeof *object->triangles);
        add_frames(scene, 2);
        for (uint32_t f = 0; f < 2; f++) {
            memcpy(bench_scene_x(scene, f, 0), frames[f].x,
                   object->vertex_count * sizeof *scene->x);
        }
    }
    ply_deinit(&frames[0]);
    ply_deinit(&frames[1]);
    return scene->object_count == 1;
}

static const struct {
    const char *name;
    void (*make)(struct bench_scene *scene, bool small); /* NULL: recorded */
    const char *frames[2];
} catalogue[] = {
    {"cloth-20k", make_cloth_20k, {NULL, NULL}},
    {"cloth-100k", make_cloth_100k, {NULL, NULL}},
    {"crumpled", make_crumpled, {NULL, NULL}},
    {"fast-sheet", make_fast, {NULL, NULL}},
    {"all-overlap", make_all_overlap, {NULL, NULL}},
    {"nothing-moves", make_still, {NULL, NULL}},
    {"teleport", make_teleport, {NULL, NULL}},
    {"cloth-ball",
     NULL,
     {"cloth-ball/frames/cloth_ball92.ply", "cloth-ball/frames/cloth_ball93.ply"}},
    {"cloth-funnel",
     NULL,
     {"cloth-funnel/frames/227.ply", "cloth-funnel/frames/228.ply"}},
    {"n-body",
     NULL,
     {"n-body-simulation/frames/balls16_18.ply",
      "n-body-simulation/frames/balls16_19.ply"}},
};

unsigned bench_scene_total(void)
{
    return sizeof catalogue / sizeof catalogue[0];
}

const char *bench_scene_name(unsigned index)
{
    return catalogue[index].name;
}

bool bench_scene_make(unsigned index, bool small, struct bench_scene *scene)
{
    memset(scene, 0, sizeof *scene);
    scene->name = catalogue[index].name;
    if (catalogue[index].make) {
        catalogue[index].make(scene, small);
        return true;
    }
    return !small && read_recorded(scene, catalogue[index].frames);
}

void bench_scene_free(struct bench_scene *scene)
{
    for (uint32_t i = 0; i < scene->object_count; i++) {
        free(scene->objects[i].triangles);
    }
    free(scene->x);
    memset(scene, 0, sizeof *scene);
}

/* bodies.c - hundreds of bodies, rigid and beating, that fall together and pile up.
 *
 * Lengths are in units of about a body's diameter.
 * Source: the N-body simulation of paper section 7, of which only the numbers of
 * triangles, 146 000, and of steps, 375, and the story are published.
 */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "families.h"
#include "prng.h"
#include "surface.h"
#include "tumble.h"

#define FRAMES       376u
#define FRAME_S      (1.0 / 72)
#define SHAPES       4u
#define SPACING      1.15 /* of the lattice that they start from */
#define WIDTH        8u   /* bodies on a side of it */
#define GROUND_SIDE  24.0
#define GROUND_WAVES 0.02
#define BEAT         0.12 /* how far a beating body's length goes up and down, .. */
#define BEAT_RATE    10.5 /* .. at so many radians a second */

struct bodies {
    uint32_t count;
    uint32_t ground;
    struct surface *shapes; /* [count], about the origin */
    double (*at)[3];        /* [count]: at frame 0 */
    double *phase;          /* [count] of the beat; < 0: rigid */
    struct tumble tumble;
};

/* A superquadric: 2 is a ball, more is a block. */
static double rounded_block(const double direction[3], double power)
{
    double sum = 0;
    for (int k = 0; k < 3; k++) {
        sum += pow(fabs(direction[k]), power);
    }
    return pow(sum, -1 / power);
}

static void shape_ball(struct surface *ball, uint32_t rings, uint32_t kind, double size)
{
    for (uint32_t v = 0; v < ball->vertex_count; v++) {
        double p;
        double a;
        surface_ball_angles(rings, v, &p, &a);
        const double direction[3] = {sin(p) * cos(a), sin(p) * sin(a), cos(p)};
        double radius = 1;
        if (kind == 0) {
            radius = 1 + 0.08 * sin(7 * p) * cos(6 * a) * sin(p);
        } else if (kind == 1) {
            radius = 0.85 * rounded_block(direction, 6);
        } else {
            radius = 0.75 + 0.35 * pow(fabs(cos(3 * a) * sin(p)), 3);
        }
        for (int k = 0; k < 3; k++) {
            ball->x[v][k] = size * radius * direction[k];
        }
    }
}

static void shape_ring(struct surface *ring, uint32_t along, uint32_t around, double size)
{
    for (uint32_t v = 0; v < ring->vertex_count; v++) {
        double a = 2 * BENCH_PI * (double)(v / around) / along;
        double b = 2 * BENCH_PI * (double)(v % around) / around;
        double out = size * (0.8 + 0.35 * cos(b));
        ring->x[v][0] = out * cos(a);
        ring->x[v][1] = out * sin(a);
        ring->x[v][2] = size * 0.35 * sin(b);
    }
}

static void make_shape(struct surface *surface, uint32_t index, bool small, double size)
{
    uint32_t kind = index % SHAPES;
    if (kind == SHAPES - 1) {
        uint32_t around = small ? 4 : 12;
        uint32_t along = small ? 8 : 20;
        surface_ring(surface, along, around);
        shape_ring(surface, along, around, size);
    } else {
        uint32_t rings = small ? 4 : 11;
        surface_ball(surface, rings);
        shape_ball(surface, rings, kind, size);
    }
}

/* On a lattice above the ground, out of line and of different sizes. */
static void place_body(struct bodies *bodies, uint32_t index, bool small,
                       struct tumble_body *body, struct prng *prng)
{
    const uint32_t cell[3] = {index % WIDTH, index / WIDTH % WIDTH,
                              index / (WIDTH * WIDTH)};
    double size = prng_between(prng, 0.35, 0.5);
    make_shape(&bodies->shapes[index], index, small, size);
    bodies->phase[index] = index / SHAPES % 2 ? prng_between(prng, 0, 6) : -1;
    memset(body, 0, sizeof *body);
    body->radius = 1.08 * size;
    for (int k = 0; k < 3; k++) {
        double middle = k < 2 ? 0.5 * (WIDTH - 1) : -1;
        body->centre[k] =
            SPACING * ((double)cell[k] - middle) + prng_between(prng, -0.1, 0.1);
        body->velocity[k] = prng_between(prng, -1.5, 1.5);
        body->spin[k] = prng_between(prng, -4, 4);
    }
    memcpy(bodies->at[index], body->centre, sizeof body->centre);
}

/* Longer one way, thinner the other two: about the same volume. */
static void beat(const struct bodies *bodies, uint32_t index, uint32_t frame,
                 double factor[3])
{
    double phase = bodies->phase[index];
    double length = phase < 0 ? 1 : 1 + BEAT * sin(phase + BEAT_RATE * FRAME_S * frame);
    factor[0] = length;
    factor[1] = factor[2] = 1 / sqrt(length);
}

static void place(const struct bench_scene *scene, uint32_t frame, double (*x)[3])
{
    const struct bodies *bodies = scene->state;
    const struct tumble_pose *poses = tumble_poses(&bodies->tumble, frame);
    for (uint32_t i = 0; i < bodies->count; i++) {
        const struct surface *shape = &bodies->shapes[i];
        double factor[3];
        beat(bodies, i, frame, factor);
        for (uint32_t v = 0; v < shape->vertex_count; v++) {
            double from[3];
            for (int k = 0; k < 3; k++) {
                from[k] = bodies->at[i][k] + factor[k] * shape->x[v][k];
            }
            tumble_apply(&poses[i], from, *x++);
        }
    }
    surface_place_ground(x, bodies->ground, GROUND_SIDE, GROUND_WAVES);
}

static bool pose(const struct bench_scene *scene, uint32_t object, uint32_t frame,
                 double m[12], double (*rest)[3])
{
    const struct bodies *bodies = scene->state;
    if (object >= bodies->count || bodies->phase[object] >= 0) {
        return false; /* the ground, or it beats */
    }
    const struct surface *shape = &bodies->shapes[object];
    memcpy(m, tumble_poses(&bodies->tumble, frame)[object].m, 12 * sizeof *m);
    for (uint32_t v = 0; rest && v < shape->vertex_count; v++) {
        for (int k = 0; k < 3; k++) {
            rest[v][k] = bodies->at[object][k] + shape->x[v][k];
        }
    }
    return true;
}

static void free_state(void *state)
{
    struct bodies *bodies = state;
    for (uint32_t i = 0; i < bodies->count; i++) {
        surface_deinit(&bodies->shapes[i]);
    }
    tumble_deinit(&bodies->tumble);
    free(bodies->shapes);
    free(bodies->at);
    free(bodies->phase);
    free(bodies);
}

void bench_make_bodies(struct bench_scene *scene, bool small)
{
    struct bodies *bodies = bench_scene_alloc(1, sizeof *bodies);
    const struct tumble_settings settings = {.frame_count = FRAMES,
                                             .substeps = 2,
                                             .frame_s = FRAME_S,
                                             .gravity = 9.8,
                                             .pull = 6,
                                             .restitution = 0.3};
    uint32_t count = small ? 40 : 318;
    struct tumble_body *balls = bench_scene_alloc(count, sizeof *balls);
    struct surface ground;
    struct prng prng = {43};
    *bodies = (struct bodies){.count = count,
                              .ground = small ? 5 : 41,
                              .shapes = bench_scene_alloc(count, sizeof *bodies->shapes),
                              .at = bench_scene_alloc(count, sizeof *bodies->at),
                              .phase = bench_scene_alloc(count, sizeof *bodies->phase)};
    for (uint32_t i = 0; i < count; i++) {
        const struct surface *shape = &bodies->shapes[i];
        place_body(bodies, i, small, &balls[i], &prng);
        bench_scene_add_mesh(scene, shape->vertex_count, shape->triangle_count,
                             (const uint32_t(*)[3])shape->triangles);
    }
    surface_sheet(&ground, bodies->ground);
    surface_add(&ground, scene);
    tumble_init(&bodies->tumble, balls, count, &settings);
    free(balls);
    scene->frame_count = FRAMES;
    scene->place = place;
    scene->pose = pose;
    scene->state = bodies;
    scene->free_state = free_state;
}

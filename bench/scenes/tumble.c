/* tumble.c - where bodies are that fall, collide and tumble. */
#include "tumble.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "bench_scene.h"

#define GRIP 0.15 /* share of the sliding speed that a contact stops */
#define PUSH 0.2  /* share of an overlap that a substep takes back */
#define DRAG 0.1  /* share of speed and spin lost a second */

struct run {
    const struct tumble_settings *settings;
    struct tumble_body *bodies;
    uint32_t count;
    double (*rest)[3];   /* centres at frame 0 */
    double (*turned)[4]; /* unit quaternions */
    float *reach; /* [count][count]: bodies nearer than this collide. The sum of the
                   * radii, less where they start nearer: neighbours in a whole. */
};

static double dot(const double a[3], const double b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static double mass(const struct tumble_body *body)
{
    return body->radius * body->radius * body->radius;
}

/* Change the velocity by `push` along the unit `n`, and the spin by what the sliding
 * `slide` leaves at the place in direction `side` * n. */
static void kick(struct tumble_body *body, const double n[3], double push,
                 const double slide[3], double side)
{
    double arm = GRIP * side / body->radius;
    const double torque[3] = {n[1] * slide[2] - n[2] * slide[1],
                              n[2] * slide[0] - n[0] * slide[2],
                              n[0] * slide[1] - n[1] * slide[0]};
    for (int k = 0; k < 3; k++) {
        body->velocity[k] += push * n[k] + GRIP * slide[k];
        body->spin[k] += arm * torque[k];
    }
}

/* `depth` > 0: how far a and b are nearer than they should be; n from a to b. */
static void collide(struct tumble_body *a, struct tumble_body *b, const double n[3],
                    double depth, double restitution)
{
    double share = mass(b) / (mass(a) + mass(b)); /* of the change that a takes */
    double way[3];
    double slide[2][3];
    for (int k = 0; k < 3; k++) {
        way[k] = b->velocity[k] - a->velocity[k];
        a->centre[k] -= PUSH * depth * share * n[k];
        b->centre[k] += PUSH * depth * (1 - share) * n[k];
    }
    double closing = dot(way, n);
    if (closing >= 0) {
        return;
    }
    for (int k = 0; k < 3; k++) {
        double sliding = way[k] - closing * n[k];
        slide[0][k] = share * sliding;
        slide[1][k] = -(1 - share) * sliding;
    }
    kick(a, n, (1 + restitution) * closing * share, slide[0], 1);
    kick(b, n, -(1 + restitution) * closing * (1 - share), slide[1], -1);
}

static void collide_ground(struct tumble_body *body, double restitution)
{
    const double up[3] = {0, 0, 1};
    double depth = body->radius - body->centre[2];
    if (depth <= 0) {
        return;
    }
    body->centre[2] += PUSH * depth;
    if (body->velocity[2] < 0) {
        const double slide[3] = {-body->velocity[0], -body->velocity[1], 0};
        kick(body, up, -(1 + restitution) * body->velocity[2], slide, -1);
    }
}

static void collide_all(struct run *run, double now)
{
    for (uint32_t i = 0; i < run->count; i++) {
        struct tumble_body *a = &run->bodies[i];
        if (a->release > now) {
            continue;
        }
        collide_ground(a, run->settings->restitution);
        for (uint32_t j = 0; j < run->count; j++) {
            struct tumble_body *b = &run->bodies[j];
            double reach = (double)run->reach[(size_t)i * run->count + j];
            double n[3] = {b->centre[0] - a->centre[0], b->centre[1] - a->centre[1],
                           b->centre[2] - a->centre[2]};
            double square = dot(n, n);
            if (j <= i || b->release > now || square >= reach * reach || square <= 0) {
                continue;
            }
            double distance = sqrt(square);
            for (int k = 0; k < 3; k++) {
                n[k] /= distance;
            }
            collide(a, b, n, reach - distance, run->settings->restitution);
        }
    }
}

/* q' = q + h / 2 (0, w) q, made unit again. */
static void turn(double q[4], const double w[3], double h)
{
    const double d[4] = {
        -w[0] * q[1] - w[1] * q[2] - w[2] * q[3], w[0] * q[0] + w[1] * q[3] - w[2] * q[2],
        w[1] * q[0] + w[2] * q[1] - w[0] * q[3], w[2] * q[0] + w[0] * q[2] - w[1] * q[1]};
    double square = 0;
    for (int k = 0; k < 4; k++) {
        q[k] += 0.5 * h * d[k];
        square += q[k] * q[k];
    }
    for (int k = 0; k < 4; k++) {
        q[k] /= sqrt(square);
    }
}

static void substep(struct run *run, double now, double h)
{
    const struct tumble_settings *settings = run->settings;
    double left = 1 - DRAG * h;
    for (uint32_t i = 0; i < run->count; i++) {
        struct tumble_body *body = &run->bodies[i];
        bool is_free = body->release <= now;
        const double *velocity = is_free ? body->velocity : body->before;
        if (is_free) {
            body->velocity[0] -= settings->pull * body->centre[0] * h;
            body->velocity[1] -= settings->pull * body->centre[1] * h;
            body->velocity[2] -= settings->gravity * h;
            turn(run->turned[i], body->spin, h);
        }
        for (int k = 0; k < 3; k++) {
            body->centre[k] += velocity[k] * h;
            body->velocity[k] *= is_free ? left : 1;
            body->spin[k] *= is_free ? left : 1;
        }
    }
    collide_all(run, now);
}

static void keep_poses(const struct run *run, struct tumble_pose *poses)
{
    for (uint32_t i = 0; i < run->count; i++) {
        const double *q = run->turned[i];
        double w = q[0], x = q[1], y = q[2], z = q[3];
        const double r[3][3] = {
            {1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)},
            {2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)},
            {2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)}};
        for (int k = 0; k < 3; k++) {
            memcpy(poses[i].m[k], r[k], sizeof r[k]);
            poses[i].m[k][3] = run->bodies[i].centre[k] - dot(r[k], run->rest[i]);
        }
    }
}

static void find_reach(struct run *run)
{
    for (uint32_t i = 0; i < run->count; i++) {
        const double identity[4] = {1, 0, 0, 0};
        memcpy(run->turned[i], identity, sizeof identity);
        memcpy(run->rest[i], run->bodies[i].centre, sizeof *run->rest);
        for (uint32_t j = 0; j < run->count; j++) {
            const struct tumble_body *a = &run->bodies[i];
            const struct tumble_body *b = &run->bodies[j];
            const double way[3] = {b->centre[0] - a->centre[0],
                                   b->centre[1] - a->centre[1],
                                   b->centre[2] - a->centre[2]};
            double distance = sqrt(dot(way, way));
            double sum = a->radius + b->radius;
            run->reach[(size_t)i * run->count + j] =
                (float)(distance < sum ? distance : sum);
        }
    }
}

void tumble_init(struct tumble *tumble, struct tumble_body *bodies, uint32_t body_count,
                 const struct tumble_settings *settings)
{
    struct run run = {
        .settings = settings,
        .bodies = bodies,
        .count = body_count,
        .rest = bench_scene_alloc(body_count, sizeof *run.rest),
        .turned = bench_scene_alloc(body_count, sizeof *run.turned),
        .reach = bench_scene_alloc((size_t)body_count * body_count, sizeof *run.reach)};
    double h = settings->frame_s / settings->substeps;
    tumble->body_count = body_count;
    tumble->poses = bench_scene_alloc((size_t)settings->frame_count * body_count,
                                      sizeof *tumble->poses);
    find_reach(&run);
    for (uint32_t f = 0; f < settings->frame_count; f++) {
        keep_poses(&run, tumble->poses + (size_t)f * body_count);
        for (uint32_t s = 0; s < settings->substeps; s++) {
            substep(&run, (f * settings->substeps + s) * h, h);
        }
    }
    free(run.rest);
    free(run.turned);
    free(run.reach);
}

void tumble_deinit(struct tumble *tumble)
{
    free(tumble->poses);
    memset(tumble, 0, sizeof *tumble);
}

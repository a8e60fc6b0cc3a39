/* tumble.h - simulations that become scenes: bodies tumble, a cloth drapes. */
#ifndef BENCH_TUMBLE_H
#define BENCH_TUMBLE_H

#include <stdbool.h>
#include <stdint.h>

struct tumble_body {
    double centre[3];   /* at frame 0 */
    double before[3];   /* velocity until the release, when nothing else moves it */
    double velocity[3]; /* at the release; lengths a second */
    double spin[3];     /* at the release; radians a second */
    double radius;      /* of the ball that it collides as */
    double release;     /* seconds from frame 0 */
};

struct tumble_settings {
    uint32_t frame_count;
    uint32_t substeps; /* of a frame */
    double frame_s;    /* seconds a frame */
    double gravity;    /* downwards */
    double pull;       /* towards the vertical axis, a unit of distance from it */
    double restitution;
};

/* x' = m[0..2] . x + m[3] in each row: of the position at frame 0, to that of a frame. */
struct tumble_pose {
    double m[3][4];
};

struct tumble {
    uint32_t body_count;
    struct tumble_pose *poses; /* [frame_count][body_count] */
};

/* `bodies` are moved. Cost: body_count squared a substep. */
void tumble_init(struct tumble *tumble, struct tumble_body *bodies, uint32_t body_count,
                 const struct tumble_settings *settings);
void tumble_deinit(struct tumble *tumble);

static inline const struct tumble_pose *tumble_poses(const struct tumble *tumble,
                                                     uint32_t frame)
{
    return tumble->poses + (uint64_t)frame * tumble->body_count;
}

static inline void tumble_apply(const struct tumble_pose *pose, const double from[3],
                                double to[3])
{
    for (int k = 0; k < 3; k++) {
        const double *m = pose->m[k];
        to[k] = m[0] * from[0] + m[1] * from[1] + m[2] * from[2] + m[3];
    }
}

/* ---- Simulates a cloth that falls over a ball, which then spins.
 *
 * Move the particles of a square cloth by position-based dynamics: stretch, shear and
 * bending as distances, the ball and the ground with friction, and particles that keep a
 * distance from each other. In metres and seconds. */

struct drape_settings {
    uint32_t side;     /* particles on a side of the cloth */
    uint32_t substeps; /* of a frame */
    double length;     /* of the cloth's side */
    double frame_s;
    double radius;    /* of the ball, around (0, 0, height) */
    double height;    /* above the ground */
    double gap;       /* between ball and cloth */
    double distance;  /* that particles keep, in squares' sides, at most 1 */
    double spin_from; /* seconds: the ball begins to spin, .. */
    double spin_gain; /* .. by so many radians / s^2, .. */
    double spin_most; /* .. up to so many radians / s */
    uint32_t seed;    /* of unevenness, without which the folds would be symmetric */
};

struct drape {
    struct drape_settings settings;
    uint32_t count; /* of particles */
    uint32_t frame; /* where it is */
    double time;
    double (*x)[3];      /* [count] */
    double (*before)[3]; /* [count]: at the beginning of the substep */
    double (*velocity)[3];
    uint32_t *cell;   /* [count]: bucket of each */
    uint32_t *sorted; /* [count]: particles by bucket */
    uint32_t *first;  /* [buckets + 1] */
};

void drape_init(struct drape *drape, const struct drape_settings *settings);
void drape_deinit(struct drape *drape);

/* Back to frame 0: flat, just above the ball. */
void drape_restart(struct drape *drape);

/* One frame on. */
void drape_advance(struct drape *drape);

/* Radians that the ball has turned by at a frame. */
double drape_turn(const struct drape_settings *settings, uint32_t frame);

#endif

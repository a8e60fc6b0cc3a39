/* client/ctl/picture/cloth_scene.h - the demo: a cloth falls over a turning ball.
 *
 * Room:     client/ctl. May include: the C library.
 * Does:     moves a square cloth of springs by one frame at a time.
 * Does not: detect collisions between triangles: that is the daemon's part. The cloth
 *           meets the ball as a smooth sphere and never meets itself.
 * Threads:  one at a time; nothing is shared.
 * Source:   extended position-based dynamics with small steps (Macklin et al. 2019).
 */
#ifndef CTL_CLOTH_SCENE_H
#define CTL_CLOTH_SCENE_H

#include <stdint.h>

#include "error.h"

/* Lengths in metres, times in seconds; y points up; the ball's centre is the origin. */
#define CLOTH_SIDE_VERTICES     70
#define CLOTH_VERTICES          (CLOTH_SIDE_VERTICES * CLOTH_SIDE_VERTICES)
#define CLOTH_QUADS             ((CLOTH_SIDE_VERTICES - 1) * (CLOTH_SIDE_VERTICES - 1))
#define CLOTH_TRIANGLES         (2 * CLOTH_QUADS)
#define CLOTH_BALL_SUBDIVISIONS 4
#define CLOTH_BALL_VERTICES     (10 * (1 << 2 * CLOTH_BALL_SUBDIVISIONS) + 2)
#define CLOTH_BALL_TRIANGLES    (20 * (1 << 2 * CLOTH_BALL_SUBDIVISIONS))
#define CLOTH_BALL_RADIUS       0.6

struct cloth_spring {
    uint32_t a, b;
    double length;
    double compliance; /* metres per newton; 0 = stiff */
};

/* Everything is computed with +, -, *, / and sqrt in a fixed order, so the same program
 * gives the same bytes wherever these are IEEE 754. About 1.5 MB. */
struct cloth_scene {
    double x[CLOTH_VERTICES][3];
    double v[CLOTH_VERTICES][3];
    double start[CLOTH_VERTICES][3]; /* positions before the small step at hand */
    struct cloth_spring *springs;
    uint32_t spring_count;
    double turn_cos, turn_sin; /* how far the ball has turned about the y axis */
    uint64_t frame;
    float cloth_start[CLOTH_VERTICES][3];
    uint32_t cloth_triangles[CLOTH_TRIANGLES][3];
    float ball_start[CLOTH_BALL_VERTICES][3];
    uint32_t ball_triangles[CLOTH_BALL_TRIANGLES][3];
};

/* A scene at rest, the cloth above the ball. Errors: E_NOMEM. */
int cloth_scene_new(struct cloth_scene **scene, struct ctl_error *error);
void cloth_scene_free(struct cloth_scene *scene);

/* Move cloth and ball by one frame. */
void cloth_scene_advance(struct cloth_scene *scene);
/* The cloth's positions now. */
void cloth_scene_positions(const struct cloth_scene *scene, float (*x)[3]);
/* The ball's pose now: rows of [R | t], to be applied to ball_start. */
void cloth_scene_ball_pose(const struct cloth_scene *scene, double pose[12]);

#endif

/* cloth_scene.h - the demo: a cloth falls over a turning ball, and is drawn.
 *
 * Move a square cloth of springs by one frame at a time; push apart what the daemon says
 * will meet, with friction, on the way of the ball and of the cloth.
 *
 * Threads: one at a time; nothing is shared.
 * Source: extended position-based dynamics with small steps (Macklin et al. 2019).
 */
#ifndef CTL_CLOTH_SCENE_H
#define CTL_CLOTH_SCENE_H

#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>

#include "error.h"
#include "pccd.h"

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

/* Two features that meet on the way from one end of a frame to the other. */
struct cloth_contact {
    bool is_vf;                  /* a vertex and a face; else two edges */
    bool a_is_cloth, b_is_cloth; /* else the ball */
    uint32_t a[2], b[3];         /* vertices */
    double param[2];             /* as in struct pccd_contact */
    double normal[3];            /* unit, from b to a */
};

/* Everything is computed with +, -, *, / and sqrt in a fixed order, so the same program
 * gives the same bytes wherever these are IEEE 754. About 2 MB. */
struct cloth_scene {
    double x[CLOTH_VERTICES][3];     /* at the begin of the frame; exact in a float */
    double end[CLOTH_VERTICES][3];   /* where it wants to be at its end */
    double push[CLOTH_VERTICES][3];  /* how far contacts have pushed it from there */
    double v[CLOTH_VERTICES][3];     /* without those pushes */
    double start[CLOTH_VERTICES][3]; /* positions before the small step at hand */
    struct cloth_spring *springs;
    uint32_t spring_count;
    double turn[2][2]; /* cosine and sine of the ball's turn about y, at both ends */
    double share;      /* of the frame's time that is left after cuts */
    uint64_t frame;
    float cloth_start[CLOTH_VERTICES][3];
    uint32_t cloth_triangles[CLOTH_TRIANGLES][3];
    float ball_start[CLOTH_BALL_VERTICES][3];
    uint32_t ball_triangles[CLOTH_BALL_TRIANGLES][3];
};

/* A scene at rest, the cloth above the ball. Errors: E_NOMEM. */
int cloth_scene_new(struct cloth_scene **scene, struct ctl_error *error);
void cloth_scene_free(struct cloth_scene *scene);

/* Where cloth and ball would be at the end of the frame if nothing were in the way. */
void cloth_scene_predict(struct cloth_scene *scene);
/* Push the vertices of a contact so far apart that they do not meet at the end. */
void cloth_scene_push(struct cloth_scene *scene, const struct cloth_contact *contact);
/* End the frame earlier: after `share` of its time, 0 .. 1. */
void cloth_scene_shorten(struct cloth_scene *scene, double share);
/* Go to its end; the next frame begins there. */
void cloth_scene_take(struct cloth_scene *scene);

/* The cloth at the begin (0) and at the end (1) of the frame, as floats. */
void cloth_scene_positions(const struct cloth_scene *scene, uint32_t end, float (*x)[3]);
/* The ball's pose there: rows of [R | t], to be applied to ball_start. */
void cloth_scene_ball_pose(const struct cloth_scene *scene, uint32_t end,
                           double pose[12]);

/* ---- Moves the demo's cloth so that it never passes through anything.
 *
 * Ask the daemon what would collide on the way of a frame, push it apart until nothing
 * collides, then take the frame. If pushing is not enough, the frame ends before the
 * first contact. */

/* What a record's handles and feature numbers mean. */
struct cloth_object {
    uint32_t object;
    uint32_t vertex_count, triangle_count;
    const uint32_t (*triangles)[3];
    struct pccd_edge *edges; /* ours */
};

/* Told of each answer, before its records are given back; `is_taken`: nothing is met, and
 * the frame goes that way. */
typedef void (*cloth_hold_fn)(void *context, const struct pccd_answer *answer,
                              bool is_taken);

struct cloth_hold {
    struct pccd_client *client; /* the caller's */
    struct cloth_scene *cloth;  /* ours */
    uint32_t scene;
    struct cloth_object objects[2]; /* cloth, ball */
    uint32_t threads;               /* of a step; 0: the daemon decides */
    uint64_t cut;                   /* frames that ended before their time */
};

/* Register the meshes of a new scene. E_NOMEM, and what the daemon says. */
int cloth_hold_init(struct cloth_hold *hold, struct pccd_client *client,
                    struct ctl_error *error);
/* Move cloth and ball by one frame. */
int cloth_hold_frame(struct cloth_hold *hold, cloth_hold_fn tell, void *context,
                     struct ctl_error *error);
/* Not the client. */
void cloth_hold_deinit(struct cloth_hold *hold);

/* ---- Draws the last step of the demo. */

/* What a record's handles and feature numbers mean. */
struct demo_object {
    uint32_t object;
    uint32_t vertex_count, triangle_count;
    const float (*x)[3]; /* at the end of the step */
    const uint32_t (*triangles)[3];
    const struct pccd_edge *edges;
};

/* What was met in a frame. */
struct demo_met {
    const struct pccd_contact *contacts;
    uint64_t count, vf, ee;
    uint64_t frame; /* from 1; 0: nothing was met in any */
};

/* Cloth first, then ball. Writes to `file`, whose name is `path`. Errors: E_NOMEM,
 * E_SYSTEM. */
int demo_picture_write(const struct demo_object objects[2], const struct demo_met *met,
                       FILE *file, const char *path, struct ctl_error *error);

#endif

/* cloth.h - the demo's program: a cloth falls over a turning ball and passes through
 * nothing.
 *
 * It is what a cloth solver does with pccd: predict a frame, ask what would meet on the
 * way, push that apart, ask again, and take the frame when nothing meets.
 *
 * Source: extended position-based dynamics with small steps (Macklin et al. 2019).
 */
#ifndef CTL_CLOTH_H
#define CTL_CLOTH_H

#include <stdbool.h>
#include <stdint.h>

#include "error.h"
#include "pccd.h"

/* Lengths in metres, times in seconds; y points up; the ball's centre is the origin. */
#define CLOTH_SIDE              70 /* vertices */
#define CLOTH_VERTICES          (CLOTH_SIDE * CLOTH_SIDE)
#define CLOTH_QUADS             ((CLOTH_SIDE - 1) * (CLOTH_SIDE - 1))
#define CLOTH_TRIANGLES         (2 * CLOTH_QUADS)
#define CLOTH_EDGES             (CLOTH_QUADS + 2 * CLOTH_SIDE * (CLOTH_SIDE - 1))
#define CLOTH_BALL_SUBDIVISIONS 4
#define CLOTH_BALL_VERTICES     (10 * (1 << 2 * CLOTH_BALL_SUBDIVISIONS) + 2)
#define CLOTH_BALL_TRIANGLES    (20 * (1 << 2 * CLOTH_BALL_SUBDIVISIONS))
#define CLOTH_BALL_EDGES        (30 * (1 << 2 * CLOTH_BALL_SUBDIVISIONS))
#define CLOTH_BALL_RADIUS       0.6

enum cloth_mesh { CLOTH_SHEET, CLOTH_BALL, CLOTH_MESHES };

extern const struct cloth_counts {
    uint32_t vertices, triangles, edges;
} cloth_counts[CLOTH_MESHES];

struct cloth_spring {
    uint32_t a, b;
    double length;
    double compliance; /* metres per newton; 0 = stiff */
};

/* Everything is computed with +, -, *, / and sqrt in a fixed order, so the same program
 * gives the same bytes wherever these are IEEE 754. About 2 MB. */
struct cloth {
    struct pccd_client *client; /* the caller's */
    uint32_t scene, objects[CLOTH_MESHES];
    uint32_t threads;                /* of a step; 0: the daemon decides */
    uint64_t frame;                  /* frames that were taken */
    uint64_t cut;                    /* of these, ended before their time */
    double x[CLOTH_VERTICES][3];     /* at the begin of the frame; exact in a float */
    double end[CLOTH_VERTICES][3];   /* where it wants to be at its end */
    double push[CLOTH_VERTICES][3];  /* how far contacts have pushed it from there */
    double v[CLOTH_VERTICES][3];     /* without those pushes */
    double start[CLOTH_VERTICES][3]; /* positions before the small step at hand */
    double turn[2][2]; /* cosine and sine of the ball's turn about y, at both ends */
    double share;      /* of the frame's time that is left after cuts */
    float ball[CLOTH_BALL_VERTICES][3]; /* before it turns */
    uint32_t triangles[CLOTH_MESHES][CLOTH_TRIANGLES][3];
    struct pccd_edge edges[CLOTH_MESHES][CLOTH_EDGES];
    struct cloth_spring springs[6 * CLOTH_VERTICES];
    uint32_t spring_count;
};

/* Return a cloth at rest, above the ball; the caller frees it. NULL: no memory. */
struct cloth *cloth_new(void);

/* Register both meshes in a new scene. Errors: those of pccd_mesh_create and
 * pccd_scene_add. */
int cloth_register(struct cloth *cloth, struct pccd_client *client,
                   struct ctl_error *error);

/* Listener to each answer, before its records are given back; `is_taken`: nothing is met,
 * and the frame goes that way. */
typedef void (*cloth_fn)(void *context, const struct pccd_answer *answer, bool is_taken);
/* Move by one frame. Errors: those of a step. */
int cloth_frame(struct cloth *cloth, cloth_fn tell, void *context,
                struct ctl_error *error);

/* Fill x with the vertices of a mesh at the begin (0) or at the end (1) of the frame. */
void cloth_positions(const struct cloth *cloth, enum cloth_mesh mesh, uint32_t end,
                     float (*x)[3]);
/* Fill in the ball's pose there: rows of [R | t], to be applied to `ball`. */
void cloth_ball_pose(const struct cloth *cloth, uint32_t end, double pose[12]);
/* Find where a contact's second feature is touched, at the begin of the frame. */
void cloth_locate(const struct cloth *cloth, const struct pccd_contact *contact,
                  float at[3]);
/* Push the vertices of a contact so far apart that they do not meet at the end. */
void cloth_push(struct cloth *cloth, const struct pccd_contact *contact);

#endif

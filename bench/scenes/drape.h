/* drape.h - simulates a cloth that falls over a ball, which then spins.
 *
 * Move the particles of a square cloth by position-based dynamics: stretch, shear and
 * bending as distances, the ball and the ground with friction, and particles that keep a
 * distance from each other. In metres and seconds.
 *
 * Threads: one. The same numbers everywhere: sums, products, quotients and roots, each
 * rounded once, in one order; nothing of libm, whose last bits differ.
 * Source: Mueller et al., Position Based Dynamics, 2007; Macklin et al., Small Steps in
 * Physics Simulation, 2019 (one iteration of many short steps).
 */
#ifndef BENCH_DRAPE_H
#define BENCH_DRAPE_H

#include <stdint.h>

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

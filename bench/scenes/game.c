/* game.c - what a game asks in each of sixty frames a second.
 *
 * Lengths are in units of about a body's diameter.
 */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "families.h"
#include "prng.h"
#include "surface.h"
#include "tumble.h"

#define FRAMES       301u
#define FRAME_S      (1.0 / 60)
#define TILES        4u    /* of the landscape, on a side */
#define TILE_LENGTH  10.0  /* in place.. */
#define TILE_GAP     0.001 /* .. of which so much is left between two */
#define TILE_WAVES   0.05
#define ROLL_EVERY   30u  /* frames, .. */
#define ROLL_FRAMES  10u  /* .. of which it rolls so many, .. */
#define ROLL_LENGTH  0.05 /* .. so far in each */
#define BOULDER_SIZE 3.0

struct game {
    uint32_t bodies;
    uint32_t tile;  /* vertices on a side of it */
    uint32_t flag;  /* vertices on a side of it */
    uint32_t rings; /* of the boulder */
    struct surface body;
    double (*at)[3]; /* [bodies]: at frame 0 */
    struct tumble tumble;
};

static void shape_ball(struct surface *ball, uint32_t rings, double size, double bumps)
{
    for (uint32_t v = 0; v < ball->vertex_count; v++) {
        double p;
        double a;
        surface_ball_angles(rings, v, &p, &a);
        double radius = size * (1 + bumps * sin(7 * p) * cos(6 * a) * sin(p));
        ball->x[v][0] = radius * sin(p) * cos(a);
        ball->x[v][1] = radius * sin(p) * sin(a);
        ball->x[v][2] = radius * cos(p);
    }
}

/* Return how far the boulder has rolled. */
static double rolled(uint32_t frame)
{
    uint32_t of_this = frame % ROLL_EVERY;
    uint32_t moved = of_this < ROLL_FRAMES ? of_this : ROLL_FRAMES;
    return ROLL_LENGTH * (double)(frame / ROLL_EVERY * ROLL_FRAMES + moved);
}

static double (*place_tiles(const struct game *game, double (*x)[3]))[3]
{
    for (uint32_t t = 0; t < TILES * TILES; t++) {
        surface_place_ground(x, game->tile, TILE_LENGTH - TILE_GAP, TILE_WAVES);
        for (uint32_t v = 0; v < game->tile * game->tile; v++, x++) {
            (*x)[0] += TILE_LENGTH * (t % TILES - 0.5 * (TILES - 1));
            (*x)[1] += TILE_LENGTH * (t / TILES - 0.5 * (TILES - 1));
        }
    }
    return x;
}

/* It hangs from above among the bodies, and waves. */
static double (*place_flag(const struct game *game, uint32_t frame, double (*x)[3]))[3]
{
    for (uint32_t i = 0; i < game->flag * game->flag; i++, x++) {
        double u = (double)(i % game->flag) / (game->flag - 1);
        double v = (double)(i / game->flag) / (game->flag - 1);
        (*x)[0] = 3 * u;
        (*x)[1] = 0.3 * u * sin(6 * u + v - 4 * FRAME_S * frame);
        (*x)[2] = 0.5 + 2 * v;
    }
    return x;
}

static void place(const struct bench_scene *scene, uint32_t frame, double (*x)[3])
{
    const struct game *game = scene->state;
    const struct tumble_pose *poses = tumble_poses(&game->tumble, frame);
    struct surface boulder;
    x = place_tiles(game, x);
    surface_ball(&boulder, game->rings);
    shape_ball(&boulder, game->rings, BOULDER_SIZE, 0.05);
    for (uint32_t v = 0; v < boulder.vertex_count; v++, x++) {
        (*x)[0] = boulder.x[v][0] - 9 + rolled(frame);
        (*x)[1] = boulder.x[v][1] + 6;
        (*x)[2] = boulder.x[v][2] + BOULDER_SIZE - 0.1;
    }
    surface_deinit(&boulder);
    for (uint32_t i = 0; i < game->bodies; i++) {
        for (uint32_t v = 0; v < game->body.vertex_count; v++, x++) {
            double from[3];
            for (int k = 0; k < 3; k++) {
                from[k] = game->at[i][k] + game->body.x[v][k];
            }
            tumble_apply(&poses[i], from, *x);
        }
    }
    (void)place_flag(game, frame, x);
}

static void free_state(void *state)
{
    struct game *game = state;
    surface_deinit(&game->body);
    tumble_deinit(&game->tumble);
    free(game->at);
    free(game);
}

/* On a lattice above the ground, out of line. */
static void place_bodies(struct game *game)
{
    const struct tumble_settings settings = {.frame_count = FRAMES,
                                             .substeps = 2,
                                             .frame_s = FRAME_S,
                                             .gravity = 9.8,
                                             .pull = 3,
                                             .restitution = 0.5};
    struct tumble_body *bodies = bench_scene_alloc(game->bodies, sizeof *bodies);
    struct prng prng = {47};
    memset(bodies, 0, game->bodies * sizeof *bodies);
    for (uint32_t i = 0; i < game->bodies; i++) {
        const uint32_t cell[3] = {i % 4, i / 4 % 4, i / 16};
        bodies[i].radius = 0.55;
        for (int k = 0; k < 3; k++) {
            bodies[i].centre[k] = 1.3 * ((double)cell[k] - (k < 2 ? 1.5 : -1)) +
                                  prng_between(&prng, -0.1, 0.1);
            bodies[i].velocity[k] = prng_between(&prng, -3, 3);
            bodies[i].spin[k] = prng_between(&prng, -4, 4);
        }
        memcpy(game->at[i], bodies[i].centre, sizeof bodies[i].centre);
    }
    tumble_init(&game->tumble, bodies, game->bodies, &settings);
    free(bodies);
}

void bench_make_game(struct bench_scene *scene, bool small)
{
    /* 16 x 2 x 75 x 75 + 4 x 71 x 70 = 199 880 triangles that stand or stop; 50 x 360
     * and 3 200 that move. */
    struct game *game = bench_scene_alloc(1, sizeof *game);
    struct surface surface;
    *game = (struct game){.bodies = small ? 8 : 50,
                          .tile = small ? 6 : 76,
                          .flag = small ? 6 : 41,
                          .rings = small ? 5 : 71};
    game->at = bench_scene_alloc(game->bodies, sizeof *game->at);
    for (uint32_t t = 0; t < TILES * TILES; t++) {
        surface_sheet(&surface, game->tile);
        surface_add(&surface, scene);
    }
    surface_ball(&surface, game->rings);
    surface_add(&surface, scene);
    surface_ball(&game->body, small ? 4 : 10);
    shape_ball(&game->body, small ? 4 : 10, 0.5, 0.08);
    for (uint32_t i = 0; i < game->bodies; i++) {
        bench_scene_add_mesh(scene, game->body.vertex_count, game->body.triangle_count,
                             (const uint32_t(*)[3])game->body.triangles);
    }
    surface_sheet(&surface, game->flag);
    surface_add(&surface, scene);
    place_bodies(game);
    scene->frame_count = FRAMES;
    scene->place = place;
    scene->state = game;
    scene->free_state = free_state;
}

/* exploding.c - a closed surface of clusters that breathe together, then fly apart.
 *
 * Clusters that were neighbours end far from each other, so boxes made for the whole say
 * nothing any more. Lengths are in units of the ball's radius.
 */
#include <math.h>
#include <stdlib.h>

#include "families.h"
#include "surface.h"

#define FRAMES      50u
#define BREAK_FRAME 10u
#define FRAME_S     (1.0 / 30)
#define GRAVITY     2.0
#define OUTWARDS    1.5 /* lengths a second */
#define AT_RANDOM   2.0
#define SPIN        4.0 /* radians a second */

struct flight {
    double velocity[3];
    double axis[3]; /* unit */
    double spin;
};

struct exploding {
    struct shards shards;
    struct flight *flights; /* [pieces] */
};

static void place_whole(struct surface *ball, uint32_t rings)
{
    for (uint32_t v = 0; v < ball->vertex_count; v++) {
        double polar;
        double azimuth;
        surface_ball_angles(rings, v, &polar, &azimuth);
        double radius = 1 + 0.06 * sin(9 * polar) * cos(8 * azimuth) * sin(polar) +
                        0.015 * sin(31 * polar) * cos(36 * azimuth) * sin(polar);
        ball->x[v][0] = radius * sin(polar) * cos(azimuth);
        ball->x[v][1] = radius * sin(polar) * sin(azimuth);
        ball->x[v][2] = radius * cos(polar);
    }
}

static void random_direction(struct prng *prng, double direction[3])
{
    double z = prng_between(prng, -1, 1);
    double angle = prng_between(prng, 0, 2 * BENCH_PI);
    double across = sqrt(1 - z * z);
    direction[0] = across * cos(angle);
    direction[1] = across * sin(angle);
    direction[2] = z;
}

static void throw_pieces(struct exploding *exploding, struct prng *prng)
{
    for (uint32_t i = 0; i < exploding->shards.count; i++) {
        struct flight *flight = &exploding->flights[i];
        double direction[3];
        double speed = prng_between(prng, 0, AT_RANDOM);
        random_direction(prng, direction);
        random_direction(prng, flight->axis);
        flight->spin = prng_between(prng, -SPIN, SPIN);
        for (int k = 0; k < 3; k++) {
            flight->velocity[k] =
                OUTWARDS * exploding->shards.centre[i][k] + speed * direction[k];
        }
    }
}

/* Rodrigues: `from` turned about the unit `axis`. */
static void rotate(const double axis[3], double angle, const double from[3], double to[3])
{
    double c = cos(angle);
    double s = sin(angle);
    double along = (1 - c) * (axis[0] * from[0] + axis[1] * from[1] + axis[2] * from[2]);
    for (int k = 0; k < 3; k++) {
        int k1 = (k + 1) % 3;
        int k2 = (k + 2) % 3;
        to[k] = c * from[k] + s * (axis[k1] * from[k2] - axis[k2] * from[k1]) +
                along * axis[k];
    }
}

static void place(const struct bench_scene *scene, uint32_t frame, double (*x)[3])
{
    const struct exploding *exploding = scene->state;
    const struct shards *shards = &exploding->shards;
    bool is_whole = frame <= BREAK_FRAME;
    double time = is_whole ? 0 : (frame - BREAK_FRAME) * FRAME_S;
    /* It has its own size again when it breaks. */
    double size = 1 + (is_whole ? 0.05 * sin(2 * BENCH_PI * frame / BREAK_FRAME) : 0);
    for (uint32_t v = 0; v < scene->vertex_count; v++) {
        uint32_t piece = shards->piece_of[v];
        const struct flight *flight = &exploding->flights[piece];
        const double *centre = shards->centre[piece];
        double arm[3];
        double turned[3];
        for (int k = 0; k < 3; k++) {
            arm[k] = shards->surface.x[v][k] - centre[k];
        }
        rotate(flight->axis, flight->spin * time, arm, turned);
        for (int k = 0; k < 3; k++) {
            x[v][k] = size * (centre[k] + turned[k]) + flight->velocity[k] * time;
        }
        x[v][2] -= 0.5 * GRAVITY * time * time;
    }
}

static void free_state(void *state)
{
    struct exploding *exploding = state;
    shards_deinit(&exploding->shards);
    free(exploding->flights);
    free(exploding);
}

void bench_make_exploding(struct bench_scene *scene, bool small)
{
    struct exploding *exploding = bench_scene_alloc(1, sizeof *exploding);
    struct shards *shards = &exploding->shards;
    struct prng prng = {23};
    struct surface ball;
    uint32_t rings = small ? 24 : 159;
    surface_ball(&ball, rings);
    place_whole(&ball, rings);
    shards_init(shards, &ball, ball.triangle_count / 85, NULL, 0.98, &prng);
    surface_deinit(&ball);
    exploding->flights = bench_scene_alloc(shards->count, sizeof *exploding->flights);
    throw_pieces(exploding, &prng);
    bench_scene_add_mesh(scene, shards->surface.vertex_count,
                         shards->surface.triangle_count,
                         (const uint32_t(*)[3])shards->surface.triangles);
    scene->frame_count = FRAMES;
    scene->break_frame = BREAK_FRAME;
    scene->place = place;
    scene->state = exploding;
    scene->free_state = free_state;
}

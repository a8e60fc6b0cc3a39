/* breaking.c - a body hits another, which breaks into pieces.
 *
 * Fly a closed bumpy body with ears into a long knotted one with scales, spikes and thin
 * parts, which writhes a little; at the impact a wave runs through it, behind which it is
 * some 400 closed shards that fly apart, tumble, collide with each other and fall on a
 * ground. Lengths are in units of about half the knot's extent.
 *
 * Source: the breaking dragon of paper section 7, of which only the numbers of triangles,
 * 252 000, and of steps, 480, and the story are published.
 */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "families.h"
#include "surface.h"
#include "tumble.h"

#define FRAMES       481u
#define BREAK_FRAME  20u
#define FRAME_S      (1.0 / 100)
#define SPEED        3.0   /* of the hitting body, lengths a second */
#define WAVE         14.0  /* speed at which the knot comes apart */
#define THICKNESS    0.2   /* of a shard, of the knot's radius there */
#define HAIR         0.994 /* size of a shard in its place: cracks do not touch */
#define HIT_RADIUS   0.36
#define GROUND_SIDE  6.0
#define GROUND_WAVES 0.004

struct sizes {
    uint32_t along; /* the knot */
    uint32_t around;
    uint32_t pieces;
    uint32_t rings;  /* the hitting body */
    uint32_t ground; /* vertices on a side */
};

struct breaking {
    struct sizes sizes;
    struct shards shards; /* of the knot; only when it is not whole */
    struct surface knot;
    double (*inner)[3];
    struct surface hitter; /* where it is at frame 0 */
    double hit_from[3];    /* its centre there */
    struct tumble tumble;  /* body 0: the hitter, then the pieces */
    bool is_whole;
};

/* ---- shapes -------------------------------------------------------------------- */

static void normalise(double v[3])
{
    double length = sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
    for (int k = 0; k < 3; k++) {
        v[k] /= length;
    }
}

static void cross(const double a[3], const double b[3], double out[3])
{
    for (int k = 0; k < 3; k++) {
        int k1 = (k + 1) % 3;
        int k2 = (k + 2) % 3;
        out[k] = a[k1] * b[k2] - a[k2] * b[k1];
    }
}

/* A trefoil lying down, its centre line at `s` of 0 .. 2 pi: point, two directions across
 * and the radius of the body there: thick in one place, a tail in another. */
static double centre_line(double s, double at[3], double side[3], double up[3])
{
    const double vertical[3] = {0, 0, 1};
    double along[3] = {cos(s) + 4 * cos(2 * s), -sin(s) + 4 * sin(2 * s),
                       -3 * cos(3 * s)};
    at[0] = (sin(s) + 2 * sin(2 * s)) / 3;
    at[1] = (cos(s) - 2 * cos(2 * s)) / 3;
    at[2] = 0.65 - sin(3 * s) / 3;
    normalise(along);
    cross(along, vertical, side);
    normalise(side);
    cross(side, along, up);
    return 0.14 + 0.05 * cos(s) - 0.03 * cos(4 * s);
}

static void shape_knot(struct breaking *breaking)
{
    const struct sizes *sizes = &breaking->sizes;
    for (uint32_t i = 0; i < sizes->along; i++) {
        double at[3];
        double side[3];
        double up[3];
        double s = 2 * BENCH_PI * i / sizes->along;
        double radius = centre_line(s, at, side, up);
        for (uint32_t j = 0; j < sizes->around; j++) {
            double angle = 2 * BENCH_PI * j / sizes->around;
            double scale = sin(80 * s + 5 * angle) * sin(80 * s - 5 * angle);
            double crest = pow(0.5 + 0.5 * cos(angle), 40) * pow(sin(45 * s), 6);
            double out = radius * (1 + 0.12 * scale + 0.9 * crest);
            double *x = breaking->knot.x[i * sizes->around + j];
            double *inner = breaking->inner[i * sizes->around + j];
            for (int k = 0; k < 3; k++) {
                double direction = cos(angle) * up[k] + sin(angle) * side[k];
                x[k] = at[k] + out * direction;
                inner[k] = at[k] + (1 - THICKNESS) * out * direction;
            }
        }
    }
}

/* Return how much longer than the body the ears are in a direction. */
static double ears(const double direction[3])
{
    double sum = 0;
    for (int side = -1; side <= 1; side += 2) {
        const double ear[3] = {-0.35, 0.35 * side, 0.869};
        double along =
            ear[0] * direction[0] + ear[1] * direction[1] + ear[2] * direction[2];
        sum += exp(60 * (along - 1));
    }
    return sum;
}

/* About the origin. */
static void shape_hitter(struct surface *hitter, uint32_t rings)
{
    for (uint32_t v = 0; v < hitter->vertex_count; v++) {
        double p;
        double a;
        surface_ball_angles(rings, v, &p, &a);
        const double direction[3] = {sin(p) * cos(a), sin(p) * sin(a), cos(p)};
        double bumps =
            0.05 * sin(5 * p) * sin(4 * a) + 0.02 * sin(23 * p) * cos(24 * a) * sin(p);
        double radius = HIT_RADIUS * (0.92 + bumps + 1.1 * ears(direction));
        for (int k = 0; k < 3; k++) {
            hitter->x[v][k] = radius * direction[k];
        }
    }
}

/* ---- motion -------------------------------------------------------------------- */

static const double approach[3] = {-0.94, 0.2, -0.276}; /* unit */

/* The way that a ball on the line through `from` goes before it meets the knot. */
static double way_to_knot(const struct surface *knot, const double from[3])
{
    double least = 1e9;
    for (uint32_t v = 0; v < knot->vertex_count; v++) {
        double along = 0;
        double square = -HIT_RADIUS * HIT_RADIUS;
        for (int k = 0; k < 3; k++) {
            double way = knot->x[v][k] - from[k];
            along += way * approach[k];
            square += way * way;
        }
        double inside = along * along - square;
        if (inside >= 0 && along - sqrt(inside) < least) {
            least = along - sqrt(inside);
        }
    }
    return least;
}

/* The hitter starts where it reaches the knot at the break frame. */
static void aim(struct breaking *breaking)
{
    const double target[3] = {0.6, 0, 0.65};
    double from[3];
    for (int k = 0; k < 3; k++) {
        from[k] = target[k] - 4 * approach[k];
    }
    double way = way_to_knot(&breaking->knot, from) - SPEED * FRAME_S * BREAK_FRAME;
    for (int k = 0; k < 3; k++) {
        breaking->hit_from[k] = from[k] + way * approach[k];
    }
    for (uint32_t v = 0; v < breaking->hitter.vertex_count; v++) {
        for (int k = 0; k < 3; k++) {
            breaking->hitter.x[v][k] += breaking->hit_from[k];
        }
    }
}

/* The pieces leave the place of the impact, the nearer the faster. */
static void throw_piece(struct tumble_body *body, const double impact[3],
                        struct prng *prng)
{
    double way[3];
    double square = 0;
    for (int k = 0; k < 3; k++) {
        way[k] = body->centre[k] - impact[k];
        square += way[k] * way[k];
    }
    double distance = sqrt(square);
    double speed = 3.5 * exp(-0.7 * distance) * prng_between(prng, 0.5, 1.5);
    body->release = BREAK_FRAME * FRAME_S + distance / WAVE;
    for (int k = 0; k < 3; k++) {
        body->velocity[k] = speed * (way[k] / distance + 0.6 * approach[k]) +
                            prng_between(prng, -0.6, 0.6);
        body->spin[k] = prng_between(prng, -6, 6);
    }
}

static void simulate(struct breaking *breaking, struct prng *prng)
{
    const struct shards *shards = &breaking->shards;
    uint32_t count = breaking->is_whole ? 1 : 1 + shards->count;
    struct tumble_body *bodies = bench_scene_alloc(count, sizeof *bodies);
    const struct tumble_settings settings = {.frame_count = FRAMES,
                                             .substeps = 2,
                                             .frame_s = FRAME_S,
                                             .gravity = 4,
                                             .restitution = 0.2};
    double impact[3];
    memset(bodies, 0, count * sizeof *bodies);
    bodies[0].radius = HIT_RADIUS;
    bodies[0].release = BREAK_FRAME * FRAME_S;
    for (int k = 0; k < 3; k++) {
        bodies[0].centre[k] = breaking->hit_from[k];
        bodies[0].before[k] = bodies[0].velocity[k] = SPEED * approach[k];
        bodies[0].spin[k] = k == 1 ? -3 : 0;
        impact[k] = breaking->hit_from[k] +
                    (SPEED * FRAME_S * BREAK_FRAME + HIT_RADIUS) * approach[k];
    }
    for (uint32_t i = 1; i < count; i++) {
        memcpy(bodies[i].centre, shards->centre[i - 1], sizeof bodies[i].centre);
        bodies[i].radius = 1.6 * shards->radius[i - 1];
        throw_piece(&bodies[i], impact, prng);
    }
    tumble_init(&breaking->tumble, bodies, count, &settings);
    free(bodies);
}

/* The knot's writhing, which has come to rest when it breaks. */
static void sway(uint32_t frame, double x[3])
{
    double share = frame < BREAK_FRAME ? sin(BENCH_PI * frame / BREAK_FRAME) : 0;
    double size = 0.03 * share * share;
    const double was[3] = {x[0], x[1], x[2]};
    x[0] += size * sin(3 * was[2] + 2 * was[1]);
    x[1] += size * sin(4 * was[0]);
    x[2] += size * sin(3 * was[1] + 2 * was[0]);
}

static void place(const struct bench_scene *scene, uint32_t frame, double (*x)[3])
{
    const struct breaking *breaking = scene->state;
    const struct tumble_pose *poses = tumble_poses(&breaking->tumble, frame);
    const struct surface *knot =
        breaking->is_whole ? &breaking->knot : &breaking->shards.surface;
    for (uint32_t v = 0; v < breaking->hitter.vertex_count; v++) {
        tumble_apply(&poses[0], breaking->hitter.x[v], x[v]);
    }
    x += breaking->hitter.vertex_count;
    for (uint32_t v = 0; v < knot->vertex_count; v++) {
        double at[3] = {knot->x[v][0], knot->x[v][1], knot->x[v][2]};
        sway(frame, at);
        if (breaking->is_whole) {
            memcpy(x[v], at, sizeof at);
        } else {
            tumble_apply(&poses[1 + breaking->shards.piece_of[v]], at, x[v]);
        }
    }
    surface_place_ground(x + knot->vertex_count, breaking->sizes.ground, GROUND_SIDE,
                         GROUND_WAVES);
}

/* ---- scene --------------------------------------------------------------------- */

static void free_state(void *state)
{
    struct breaking *breaking = state;
    shards_deinit(&breaking->shards);
    surface_deinit(&breaking->knot);
    surface_deinit(&breaking->hitter);
    tumble_deinit(&breaking->tumble);
    free(breaking->inner);
    free(breaking);
}

static void add_copy(struct bench_scene *scene, const struct surface *surface)
{
    bench_scene_add_mesh(scene, surface->vertex_count, surface->triangle_count,
                         (const uint32_t(*)[3])surface->triangles);
}

static void make(struct bench_scene *scene, const struct sizes *sizes, bool is_whole)
{
    struct breaking *breaking = bench_scene_alloc(1, sizeof *breaking);
    struct surface ground;
    struct prng prng = {31};
    memset(breaking, 0, sizeof *breaking);
    breaking->sizes = *sizes;
    breaking->is_whole = is_whole;
    surface_ring(&breaking->knot, sizes->along, sizes->around);
    breaking->inner =
        bench_scene_alloc(breaking->knot.vertex_count, sizeof *breaking->inner);
    shape_knot(breaking);
    surface_ball(&breaking->hitter, sizes->rings);
    shape_hitter(&breaking->hitter, sizes->rings);
    aim(breaking);
    if (!is_whole) {
        shards_init(&breaking->shards, &breaking->knot, sizes->pieces,
                    (const double(*)[3])breaking->inner, HAIR, &prng);
    }
    simulate(breaking, &prng);
    add_copy(scene, &breaking->hitter);
    add_copy(scene, is_whole ? &breaking->knot : &breaking->shards.surface);
    surface_sheet(&ground, sizes->ground);
    surface_add(&ground, scene);
    scene->frame_count = FRAMES;
    scene->break_frame = BREAK_FRAME;
    scene->place = place;
    scene->state = breaking;
    scene->free_state = free_state;
}

static const struct sizes large = {660, 60, 400, 118, 41};
static const struct sizes tiny = {60, 10, 30, 12, 9};

void bench_make_breaking(struct bench_scene *scene, bool small)
{
    const struct sizes *sizes = small ? &tiny : &large;
    struct bench_scene *before = bench_scene_alloc(1, sizeof *before);
    memset(before, 0, sizeof *before);
    before->name = scene->name;
    make(before, sizes, true);
    make(scene, sizes, false);
    scene->before = before;
    scene->break_object = 1;
}

/* game_balls.c - a game's loop: three balls fall into a cloth that hangs by its corners,
 * and nothing passes through anything.
 *
 * Room:     client/examples. May include: pccd.h.
 * Does:     move all as if nothing were in the way, ask what meets, answer each contact
 *           by an impulse along its normal, ask again; then go as far as is safe. Balls
 *           do not turn. After each frame it looks whether anything is too near.
 * Threads:  one.
 *
 *     game_balls [FRAMES]; with PCCD_RECORD=FILE it is recorded, for pccdctl render
 */
#include "sheet.h"

enum { SIDE = 20, CLOTH = SIDE * SIDE, SHEET = 2 * (SIDE - 1) * (SIDE - 1) };
enum { RINGS = 9, ROUND = 14, BALL = RINGS * ROUND + 2, SKIN = 2 * RINGS * ROUND };
enum { BODIES = 4, TRIES = 12 }; /* the cloth and three balls */
#define SIZE   0.12              /* radius of a ball; the cloth has sides of 1 */
#define FALL   4e-4              /* gravity, in units per frame squared */
#define THICK  4e-3 /* what each body adds to the distance at which it is met */
#define APART  (2 * THICK * 1.05)
#define BOUNCE 0.3  /* part of the speed along the normal with which bodies part */
#define LIGHT  0.05 /* mass of a vertex of the cloth; a ball has 1 */

static struct body {
    double x[CLOTH][3], was[CLOTH][3], end[CLOTH][3], next[CLOTH][3];
} bodies[BODIES];
static struct pccd_motion motions[BODIES];
static void *next[BODIES];
static uint32_t sheet[SHEET][3], skin[SKIN][3];
static struct pccd_edge edges[2][3 * (SHEET + SKIN)]; /* of the sheet and of a ball */

static int is_pinned(uint32_t v)
{
    return v % SIDE % (SIDE - 1) == 0 && v / SIDE % (SIDE - 1) == 0;
}

static void make(struct pccd_client *client, uint32_t scene)
{
    const struct pccd_object_settings r = {.what = PCCD_OBJECT_RADIUS, .radius = THICK};
    struct pccd_mesh_info info;
    uint32_t mesh;
    sheet_triangles(SIDE, sheet);
    for (uint32_t i = 0; i < BODIES; i++) {
        struct body *b = &bodies[i];
        if (i == 0) {
            sheet_flat(SIDE, -0.5, -0.5, 0, b->x);
        } else {
            const double centre[3] = {0.08 * i - 0.15, 0.1 - 0.05 * i, 0.3 * i};
            ball_make(RINGS, ROUND, SIZE, centre, b->x, skin);
        }
        memcpy(b->next, b->x, sizeof b->x);
        next[i] = b->next;
        motions[i].count = i == 0 ? CLOTH : BALL;
        motions[i].format = PCCD_FORMAT_F64;
        motions[i].x0 = b->x;
        motions[i].x1 = b->end;
        if (i < 2) { /* the balls share a mesh */
            ok(client, pccd_mesh_create(client, b->x, PCCD_FORMAT_F64, motions[i].count,
                                        (void *)(i == 0 ? sheet : skin),
                                        i == 0 ? SHEET : SKIN, &mesh, &info));
            ok(client, pccd_mesh_edges(client, mesh, edges[i], info.edge_count));
        }
        ok(client, pccd_scene_add(client, scene, mesh, &motions[i].object));
        ok(client, pccd_object_set(client, scene, motions[i].object, &r));
    }
}

/* Predict where all go if nothing is in the way: on as before, and down. */
static void predict(void)
{
    for (uint32_t i = 0; i < BODIES; i++) {
        struct body *b = &bodies[i];
        memcpy(b->was, b->x, sizeof b->x);
        memcpy(b->x, b->next, sizeof b->x);
        if (i == 0) {
            sheet_predict(SIDE, b->x, b->was, b->end, FALL);
        }
        for (uint32_t v = 0; v < CLOTH; v++) {
            for (int k = 0; k < 3 && (i > 0 || is_pinned(v)); k++) {
                b->end[v][k] =
                    2 * b->x[v][k] - b->was[v][k] - (i > 0 && k == 2 ? FALL : 0);
            }
        }
    }
}

/* An impulse at the point of a contact, along its normal: both sides part. */
static void respond(const struct pccd_contact *c)
{
    double w[4], gap = 0, speed = 0, give = 0;
    uint32_t v[4], a = 0, b = 0;
    for (uint32_t i = 1; i < BODIES; i++) {
        a = motions[i].object == c->object_a ? i : a;
        b = motions[i].object == c->object_b ? i : b;
    }
    int split =
        contact_corners(c, edges[a > 0], edges[b > 0], b == 0 ? sheet : skin, v, w);
    for (int i = 0; i < 4; i++) {
        const struct body *body = &bodies[i < split ? a : b];
        for (int k = 0; k < 3; k++) {
            gap += w[i] * body->end[v[i]][k] * (double)c->normal[k];
            speed +=
                w[i] * (body->end[v[i]][k] - body->x[v[i]][k]) * (double)c->normal[k];
        }
        /* A ball moves as a whole, and the weights of its corners are 1 together. */
        give += body == bodies ? is_pinned(v[i]) ? 0 : w[i] * w[i] / LIGHT : fabs(w[i]);
    }
    double push = fmax(APART - gap, -(1 + BOUNCE) * speed) / give;
    for (int i = 0; i < 4 && gap < APART && give > 0; i++) {
        struct body *body = &bodies[i < split ? a : b];
        uint32_t first = body == bodies ? v[i] : 0, count = body == bodies ? 1 : BALL;
        double part = body != bodies ? w[i] : is_pinned(v[i]) ? 0 : w[i] / LIGHT;
        for (uint32_t k = 3 * first; k < 3 * (first + count); k++) {
            body->end[k / 3][k % 3] += push * part * (double)c->normal[k % 3];
        }
    }
}

int main(int argc, char **argv)
{
    unsigned long long frames = argc > 1 ? strtoull(argv[1], NULL, 10) : 200, met = 0;
    struct pccd_client *client = NULL;
    uint32_t scene;
    ok(client, pccd_connect(&(struct pccd_options){.private_daemon = true}, &client));
    ok(client, pccd_scene_create(client, NULL, &scene));
    make(client, scene);
    for (unsigned long long frame = 0; frame < frames; frame++) {
        struct pccd_answer answer = {.total = 1};
        double part;
        predict();
        for (int try = 0; try < TRIES && answer.total > 0; try++) {
            ok(client, pccd_step(client, scene, motions, BODIES, NULL, &answer));
            for (uint64_t i = 0; i < answer.count; i++) {
                respond(&answer.contacts[i]);
            }
            met += answer.total;
            pccd_answer_release(client, &answer);
        }
        ok(client,
           pccd_step_safe(client, scene, motions, BODIES, NULL, next, &part, &answer));
        pccd_answer_release(client, &answer);
        nothing_is_near(client, scene);
    }
    printf("%llu frames, %llu contacts, nothing nearer than %g\n", frames, met,
           2 * THICK);
    pccd_close(client);
    return met == 0;
}

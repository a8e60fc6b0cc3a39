/* cloth_thick.c - a cloth with a thickness that falls on a ball and never passes through
 * it or through itself.
 *
 * Room:     client/examples. May include: pccd.h.
 * Does:     ask which features come within their distance on the way, move those apart
 *           along the normals, with friction, ask again; then go as far as is safe. After
 *           each frame it looks whether anything is nearer than that, or crosses.
 * Threads:  one.
 *
 *     cloth_thick [FRAMES [FILE]]     FILE: a recording, for pccdctl render
 */
#include "sheet.h"

enum { SIDE = 24, CLOTH = SIDE * SIDE, VERTICES = 2 * CLOTH, ROUNDS = 8 };
enum { SHEET = 2 * (SIDE - 1) * (SIDE - 1), TRIANGLES = 2 * SHEET };
#define RADIUS   0.3
#define FALL     5e-5               /* gravity, in units per frame squared */
#define THICK    2e-3               /* half the cloth's thickness; an edge is 0.043 */
#define APART    (2 * THICK * 1.05) /* where the response brings what meets */
#define FRICTION 0.5                /* of the way past each other that is taken back */

static double x[VERTICES][3], was[VERTICES][3], end[VERTICES][3], next[VERTICES][3];
static uint32_t triangles[TRIANGLES][3];
static struct pccd_edge *edges;

/* Bring the features of a contact to a distance at the end of the frame. The ball does
 * not give way. */
static void push(const struct pccd_contact *c)
{
    double w[4], gap = 0, give = 0;
    double past[3] = {0, 0, 0}, near = 0; /* how they move, and how much of it along n */
    uint32_t v[4];
    contact_corners(c, edges, edges, triangles, v, w);
    for (int i = 0; i < 4; i++) {
        for (int k = 0; k < 3; k++) {
            double n = (double)c->normal[k], way = end[v[i]][k] - x[v[i]][k];
            gap += w[i] * end[v[i]][k] * n;
            past[k] += w[i] * way;
            near += w[i] * way * n;
        }
        give += v[i] < CLOTH ? w[i] * w[i] : 0;
    }
    for (int i = 0; i < 4 && gap < APART && give > 0; i++) {
        for (int k = 0; k < 3 && v[i] < CLOTH; k++) {
            double n = (double)c->normal[k], slide = past[k] - near * n;
            end[v[i]][k] += ((APART - gap) * n - FRICTION * slide) / give * w[i];
        }
    }
}

int main(int argc, char **argv)
{
    const struct pccd_object_settings r = {.what = PCCD_OBJECT_RADIUS, .radius = THICK};
    const unsigned long long frames = argc > 1 ? strtoull(argv[1], NULL, 10) : 200;
    struct pccd_motion motion = {
        .count = VERTICES, .format = PCCD_FORMAT_F64, .x0 = x, .x1 = end};
    struct pccd_mesh_info info;
    struct pccd_client *client = NULL;
    unsigned long long met = 0, short_of = 0;
    uint32_t scene, mesh;
    sheet_and_ball(SIDE, RADIUS, x, triangles);
    memcpy(was, x, sizeof x);
    memcpy(end, x, sizeof x);
    ok(client, pccd_connect(&(struct pccd_options){.private_daemon = true}, &client));
    ok(client, argc > 2 ? pccd_record_start(client, argv[2], NULL) : 0);
    ok(client, pccd_scene_create(client, NULL, &scene));
    ok(client, pccd_mesh_create(client, x, PCCD_FORMAT_F64, VERTICES, (void *)triangles,
                                TRIANGLES, &mesh, &info));
    edges = malloc(info.edge_count * sizeof *edges);
    ok(client, pccd_mesh_edges(client, mesh, edges, info.edge_count));
    ok(client, pccd_scene_add(client, scene, mesh, &motion.object));
    ok(client, pccd_object_set(client, scene, motion.object, &r));
    for (unsigned long long frame = 0; frame < frames; frame++) {
        struct pccd_answer answer = PCCD_ANSWER_INIT;
        double part = 0;
        sheet_predict(SIDE, x, was, end, FALL);
        memcpy(was, x, sizeof x);
        for (int round = 0; round < ROUNDS; round++) {
            ok(client, pccd_step(client, scene, &motion, 1, NULL, &answer));
            for (uint64_t i = 0; i < answer.count; i++) {
                push(&answer.contacts[i]);
            }
            met += answer.count;
            round = answer.count == 0 ? ROUNDS : round;
            pccd_answer_release(client, &answer);
        }
        ok(client, pccd_step_safe(client, scene, &motion, 1, NULL, (void *[]){next},
                                  &part, &answer));
        pccd_answer_release(client, &answer);
        short_of += part < 1;
        memcpy(x, next, sizeof x);
        nothing_is_near(client, scene);
    }
    printf("%llu frames, %llu not the whole way, %llu contacts, nothing nearer than %g\n",
           frames, short_of, met, 2 * THICK);
    free(edges);
    pccd_close(client);
    return met == 0;
}

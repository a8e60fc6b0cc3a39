/* cloth_near.c - a cloth that falls on a ball, by steps that nothing need be tested on.
 *
 * Room:     client/examples. May include: pccd.h.
 * Does:     OGC's trust region. The daemon tells how near each vertex is to what it could
 *           meet; a vertex that moves by less than half of that meets nothing that does
 *           so, too. A way is gone in as many small pieces as fit, and each leads to
 *           where nothing crosses or touches, which is looked at, too.
 * Threads:  one.
 * Source:   "Offset Geometric Contact" (Chen, Hsu, Macklin, Yuksel 2025).
 */
#include "sheet.h"

enum { SIDE = 16, CLOTH = SIDE * SIDE, VERTICES = 2 * CLOTH, FRAMES = 30, PIECES = 4 };
enum { SHEET = 2 * (SIDE - 1) * (SIDE - 1), TRIANGLES = 2 * SHEET };
#define REACH  0.03 /* nobody asks for more: a vertex moves by less than half of it */
#define RADIUS 0.3
#define FALL   1e-3 /* gravity, in units per frame squared */

static double x[VERTICES][3], was[VERTICES][3], end[VERTICES][3], bound[VERTICES];
static uint32_t triangles[TRIANGLES][3];

/* Go on to `end`, each vertex by less than half its bound. Returns how many were held. */
static uint32_t move(void)
{
    uint32_t held = 0;

    for (uint32_t v = 0; v < CLOTH; v++) {
        double d[3] = {end[v][0] - x[v][0], end[v][1] - x[v][1], end[v][2] - x[v][2]};
        double way = sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]);
        double part = way > 0.49 * bound[v] ? 0.49 * bound[v] / way : 1;

        held += part < 1;
        for (int k = 0; k < 3; k++) {
            x[v][k] += part * d[k];
        }
    }
    return held;
}

int main(void)
{
    struct pccd_near_settings settings = PCCD_NEAR_SETTINGS_INIT;
    struct pccd_client *client = NULL;
    struct pccd_motion motion = {.count = VERTICES, .format = PCCD_FORMAT_F64, .x1 = x};
    uint32_t scene, mesh;
    unsigned long long held = 0;

    sheet_and_ball(SIDE, RADIUS, x, triangles);
    memcpy(was, x, sizeof x);
    memcpy(end, x, sizeof x);
    settings.distance = REACH;
    ok(client, pccd_connect(&(struct pccd_options){.private_daemon = true}, &client));
    ok(client, pccd_scene_create(client, NULL, &scene));
    ok(client, pccd_mesh_create(client, x, PCCD_FORMAT_F64, VERTICES, (void *)triangles,
                                TRIANGLES, &mesh, NULL));
    ok(client, pccd_scene_add(client, scene, mesh, &motion.object));
    for (int i = 0; i < FRAMES * PIECES; i++) {
        struct pccd_answer answer = PCCD_ANSWER_INIT;

        if (i % PIECES == 0) {
            sheet_predict(SIDE, x, was, end, FALL);
            memcpy(was, x, sizeof x);
        }
        settings.what = PCCD_NEAR_VERTICES;
        ok(client, pccd_ask_near(client, scene, NULL, 0, &settings, &answer));
        ok(client, answer.count != VERTICES);
        memcpy(bound, answer.vertex_bounds, sizeof bound);
        pccd_answer_release(client, &answer);
        held += move();
        settings.what = PCCD_NEAR_CROSSINGS;
        ok(client, pccd_ask_near(client, scene, &motion, 1, &settings, &answer));
        ok(client, answer.incomplete != 0 || answer.total > 0);
        ok(client, answer.verdict != PCCD_VERDICT_NO);
        pccd_answer_release(client, &answer);
    }
    printf("%d frames, %llu times a vertex was held, nothing touches\n", FRAMES, held);
    pccd_close(client);
    return held == 0;
}

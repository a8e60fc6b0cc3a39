/* cloth.c - a cloth that falls over a table, and passes neither through it nor itself.
 *
 * Room:     client/examples. May include: pccd.h.
 * Does:     position-based dynamics. The way of a frame is taken only when nothing is met
 *           on it. Until then each contact pushes its features apart along its normal; if
 *           that does not do, the way is cut short of the first: up to there it is free.
 * Threads:  one.
 */
#include "sheet.h"

enum { SIDE = 24, CLOTH = SIDE * SIDE, VERTICES = CLOTH + 3, FRAMES = 150, TRIES = 16 };
enum { TRIANGLES = 2 * (SIDE - 1) * (SIDE - 1) + 1, PUSHES = 8 };
#define GAP  3e-3 /* that features are pushed apart to */
#define FALL 5e-4 /* gravity, in units per frame squared */

static double x[VERTICES][3], was[VERTICES][3], end[VERTICES][3];
static uint32_t triangles[TRIANGLES][3];
static struct pccd_edge edges[3 * TRIANGLES];

static void make(void)
{
    const double table[3][3] = {{-.3, -.3, 0}, {.3, -.3, 0}, {0, .3, 0}};

    sheet_flat(SIDE, -0.47, -0.52, 0.05, x);
    sheet_triangles(SIDE, triangles);
    memcpy(triangles[TRIANGLES - 1], (uint32_t[]){CLOTH, CLOTH + 1, CLOTH + 2}, 12);
    memcpy(x[CLOTH], table, sizeof table);
    memcpy(was, x, sizeof x);
    memcpy(end, x, sizeof x);
}

/* Along the normal, which points from b to a. Each is a weighted sum of vertices. */
static void push(const struct pccd_contact *c)
{
    double w[4], gap = -GAP, sum = 0;
    uint32_t v[4];

    contact_corners(c, edges, edges, triangles, v, w);
    for (int i = 0; i < 12; i++) {
        gap += w[i / 3] * end[v[i / 3]][i % 3] * (double)c->normal[i % 3];
        sum += v[i / 3] < CLOTH ? w[i / 3] * w[i / 3] / 3 : 0;
    }
    for (int i = 0; i < 12 && gap < 0; i++) {
        double share = v[i / 3] < CLOTH ? w[i / 3] / sum : 0; /* no table moves */
        end[v[i / 3]][i % 3] -= share * gap * (double)c->normal[i % 3];
    }
}

int main(void)
{
    struct pccd_client *client = NULL;
    uint32_t scene, mesh, object;
    struct pccd_mesh_info info;
    unsigned long long met = 0;

    make();
    ok(client, pccd_connect(&(struct pccd_options){.private_daemon = true}, &client));
    ok(client, pccd_scene_create(client, NULL, &scene));
    ok(client, pccd_mesh_create(client, x, PCCD_FORMAT_F64, VERTICES, (void *)triangles,
                                TRIANGLES, &mesh, &info));
    ok(client, pccd_mesh_edges(client, mesh, edges, info.edge_count));
    ok(client, pccd_scene_add(client, scene, mesh, &object));
    for (int i = 0; i < FRAMES; i++, memcpy(was, x, sizeof x), memcpy(x, end, sizeof x)) {
        struct pccd_answer answer = {.total = 1};
        sheet_predict(SIDE, x, was, end, FALL);
        for (int try = 0; answer.total > 0; met += answer.total, try++) {
            ok(client, try == TRIES);
            ok(client, pccd_step_x0x1(client, scene, object, x, end, PCCD_FORMAT_F64,
                                      VERTICES, NULL, &answer));
            for (uint64_t k = 0; try < PUSHES && k < answer.count; k++) {
                push(&answer.contacts[k]);
            }
            for (int k = 0; try >= PUSHES && answer.total > 0 && k < 3 * CLOTH; k++) {
                double way = end[k / 3][k % 3] - x[k / 3][k % 3];
                end[k / 3][k % 3] = x[k / 3][k % 3] + 0.9 * answer.toi_first * way;
            }
            pccd_answer_release(client, &answer);
        }
    }
    printf("%d frames, %llu contacts, nothing has passed through\n", FRAMES, met);
    pccd_close(client);
    return met == 0;
}

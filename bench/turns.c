/* turns.c - the C side of make bench-python: a client at the URL of its argument.
 *
 * Each line of standard input has it make steps and answer with their nanoseconds:
 * "bodies N", "cloth N"; "check": the hash of a step of the bodies that has contacts.
 */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "clock.h"
#include "pccd.h"
#include "printable.h"

#define BODIES   8u
#define SIDE     216u
#define VERTICES (SIDE * SIDE)

static struct pccd_client *client;
static const struct pccd_step_settings settings = {.threads = 1};
static struct pccd_motion motions[BODIES];
static double poses[3][BODIES][12]; /* the third: all in one place */
static float cloth_x[2][VERTICES][3];
static uint32_t bodies_scene, cloth_scene, cloth;

static void must(int status, const char *what)
{
    if (status != PCCD_OK) {
        fprintf(stderr, "turns: %s: %s\n", what, pccd_error_text(client));
        exit(2);
    }
}

static void make_bodies(void)
{
    static const double x[4][3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    static const uint32_t faces[4][3] = {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {0, 3, 2}};
    uint32_t mesh;
    must(pccd_scene_create(client, NULL, &bodies_scene), "scene");
    must(pccd_mesh_create(client, x, PCCD_FORMAT_F64, 4, faces, 4, &mesh, NULL), "mesh");
    for (uint32_t k = 0; k < BODIES; k++) {
        motions[k].count = 4;
        must(pccd_scene_add(client, bodies_scene, mesh, &motions[k].object), "add");
        for (uint32_t end = 0; end < 3; end++) {
            for (uint32_t i = 0; i < 3; i++) {
                poses[end][k][5 * i] = 1;
            }
            poses[end][k][3] = end < 2 ? 2.0 * k : 0;
            poses[end][k][11] = 0.1 * (end % 2);
        }
    }
}

static void make_cloth(void)
{
    uint32_t(*faces)[3] = malloc(2 * VERTICES * sizeof *faces);
    uint32_t count = 0;
    uint32_t mesh;
    for (uint32_t v = 0; v < VERTICES; v++) {
        for (uint32_t odd = 0; odd < 2; odd++) {
            double u = (v / SIDE) / (SIDE - 1.0);
            cloth_x[odd][v][0] = (float)u;
            cloth_x[odd][v][1] = (float)((v % SIDE) / (SIDE - 1.0));
            cloth_x[odd][v][2] = (float)(0.05 * sin(6 * u + 0.01 * odd));
        }
        if (v / SIDE < SIDE - 1 && v % SIDE < SIDE - 1) {
            const uint32_t cell[2][3] = {{v, v + 1, v + SIDE},
                                         {v + 1, v + SIDE + 1, v + SIDE}};
            memcpy(faces[count], cell, sizeof cell);
            count += 2;
        }
    }
    must(pccd_scene_create(client, NULL, &cloth_scene), "scene");
    must(pccd_mesh_create(client, cloth_x[0], PCCD_FORMAT_F32, VERTICES,
                          (const uint32_t(*)[3])faces, count, &mesh, NULL),
         "mesh");
    must(pccd_scene_add(client, cloth_scene, mesh, &cloth), "add");
    free(faces);
}

static void move_bodies(uint32_t from, uint32_t to, struct pccd_answer *answer)
{
    for (uint32_t k = 0; k < BODIES; k++) {
        motions[k].m0 = poses[from][k];
        motions[k].m1 = poses[to][k];
    }
    must(pccd_step(client, bodies_scene, motions, BODIES, &settings, answer), "step");
}

static void turn(const char *what, uint32_t count)
{
    struct pccd_answer answer = PCCD_ANSWER_INIT;
    for (uint32_t i = 0; i < count; i++) {
        uint64_t begin_ns = common_now_ns();
        if (strcmp(what, "bodies") == 0) {
            move_bodies(i % 2, (i + 1) % 2, &answer);
        } else {
            must(pccd_step_x1(client, cloth_scene, cloth, cloth_x[(i + 1) % 2],
                              PCCD_FORMAT_F32, VERTICES, &settings, &answer),
                 "step");
        }
        pccd_answer_release(client, &answer);
        printf("%llu ", (unsigned long long)(common_now_ns() - begin_ns));
    }
    putchar('\n');
    fflush(stdout);
}

int main(int argc, char **argv)
{
    struct pccd_options options;
    char what[16];
    unsigned count;
    pccd_options_init(&options);
    options.url = argc == 2 ? argv[1] : NULL;
    must(pccd_connect(&options, &client), "connect");
    make_bodies();
    make_cloth();
    while (scanf("%15s", what) == 1) {
        if (strcmp(what, "check") == 0) {
            struct pccd_answer answer = PCCD_ANSWER_INIT;
            move_bodies(0, 2, &answer);
            char hash[PROTO_HASH_BYTES];
            puts(proto_hash_text(PCCD_HASH_VERSION, answer.hash, hash));
            fflush(stdout);
            pccd_answer_release(client, &answer);
        } else if (scanf("%u", &count) == 1) {
            turn(what, count);
        }
    }
    pccd_close(client);
    return 0;
}

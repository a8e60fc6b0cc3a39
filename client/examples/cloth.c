/* cloth.c - a deforming grid, streamed without copies and with several steps in flight.
 *
 * Room:     client/examples. May include: pccd.h.
 * Does:     a cloth with waves on it sinks through a floor. Every step's positions are
 *           written straight into a slot of the upload ring while earlier steps are still
 *           being computed. The vertices that pass the floor are known, so every
 *           answer is checked.
 * Threads:  one.
 */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "pccd.h"

#define SIDE     48u /* vertices along an edge of the cloth */
#define VERTICES (SIDE * SIDE)
#define CELLS    ((SIDE - 1) * (SIDE - 1))
#define STEPS    120u
#define FLYING   3u /* steps in flight; the ring has 4 slots */

static struct pccd_client *client;

static void check(int status, const char *what)
{
    if (status == 0) {
        return;
    }
    fprintf(stderr, "%s: %s: %s\n", what, pccd_status_name(status),
            pccd_error_text(client));
    pccd_close(client);
    exit(1);
}

/* Height of a vertex at the end of a step; never exactly 0. */
static float height(uint32_t step, uint32_t vertex)
{
    float x = (float)(vertex % SIDE) / SIDE;
    float y = (float)(vertex / SIDE) / SIDE;
    float time = (float)step / STEPS;
    float z = 0.6f - 1.2f * time + 0.2f * sinf(9.0f * x + 12.0f * time) * cosf(7.0f * y);

    return fabsf(z) < 1e-6f ? 1e-6f : z;
}

static void write_positions(float (*x)[3], uint32_t step)
{
    for (uint32_t i = 0; i < VERTICES; i++) {
        x[i][0] = (float)(i % SIDE) / SIDE - 0.5f;
        x[i][1] = (float)(i / SIDE) / SIDE - 0.5f;
        x[i][2] = height(step, i);
    }
}

/* Vertices on different sides of the floor before and after the step. */
static uint64_t expected_contacts(uint32_t step)
{
    uint64_t count = 0;

    for (uint32_t i = 0; i < VERTICES; i++) {
        count += (height(step - 1, i) > 0) != (height(step, i) > 0);
    }
    return count;
}

static uint32_t add_cloth(uint32_t scene)
{
    static float x[VERTICES][3];
    static uint32_t triangles[2 * CELLS][3];
    uint32_t mesh = 0;
    uint32_t object = 0;

    write_positions(x, 0);
    for (uint32_t i = 0; i < CELLS; i++) {
        uint32_t corner = i / (SIDE - 1) * SIDE + i % (SIDE - 1);
        const uint32_t quad[6] = {corner,     corner + 1,        corner + SIDE,
                                  corner + 1, corner + SIDE + 1, corner + SIDE};

        for (uint32_t k = 0; k < 6; k++) {
            triangles[2 * i + k / 3][k % 3] = quad[k];
        }
    }
    check(pccd_mesh_create(client, x, PCCD_FORMAT_F32, VERTICES,
                           (const uint32_t(*)[3])triangles, 2 * CELLS, &mesh, NULL),
          "cloth");
    check(pccd_scene_add(client, scene, mesh, &object), "cloth");
    return object;
}

static void add_floor(uint32_t scene)
{
    static const float x[3][3] = {{-9, -9, 0}, {9, -9, 0}, {0, 9, 0}};
    static const uint32_t triangle[1][3] = {{0, 1, 2}};
    uint32_t mesh = 0;
    uint32_t object = 0;

    check(pccd_mesh_create(client, x, PCCD_FORMAT_F32, 3, triangle, 1, &mesh, NULL),
          "floor");
    check(pccd_scene_add(client, scene, mesh, &object), "floor");
}

static uint64_t submit(uint32_t scene, uint32_t cloth, uint32_t step)
{
    struct pccd_frame frame;
    void *x1 = NULL;
    uint64_t number = 0;

    check(pccd_frame_begin(client, scene, 1, sizeof(float[VERTICES][3]), &frame),
          "begin");
    check(pccd_frame_x1(&frame, cloth, PCCD_FORMAT_F32, 0, VERTICES, &x1), "x1");
    write_positions(x1, step); /* into shared memory: the only copy is the daemon's */
    check(pccd_frame_commit(&frame, NULL, &number), "commit");
    return number;
}

/* Take the answer to a step; 1 when it is not what it must be. */
static int finish(uint64_t number, uint32_t step, uint64_t *contacts)
{
    struct pccd_answer answer;
    uint64_t expected = expected_contacts(step);
    int wrong;

    check(pccd_wait(client, number, -1, &answer), "wait");
    wrong = answer.incomplete != PCCD_COMPLETE || answer.vf != expected ||
            answer.ee != 0 || answer.count != expected;
    if (wrong) {
        fprintf(stderr,
                "step %u: %llu vertex-face contacts instead of %llu, %llu edge-edge\n",
                step, (unsigned long long)answer.vf, (unsigned long long)expected,
                (unsigned long long)answer.ee);
    }
    *contacts += answer.count;
    pccd_answer_release(client, &answer);
    return wrong;
}

int main(void)
{
    struct pccd_options options;
    uint64_t numbers[STEPS + 1];
    uint64_t contacts = 0;
    uint32_t scene = 0;
    uint32_t cloth;
    int wrong = 0;

    pccd_options_init(&options);
    options.private_daemon = true;
    check(pccd_connect(&options, &client), "connect");
    check(pccd_scene_create(client, NULL, &scene), "scene");
    add_floor(scene);
    cloth = add_cloth(scene);
    for (uint32_t step = 1; step <= STEPS; step++) {
        numbers[step] = submit(scene, cloth, step);
        if (step >= FLYING) {
            wrong |= finish(numbers[step - FLYING + 1], step - FLYING + 1, &contacts);
        }
    }
    for (uint32_t step = STEPS - FLYING + 2; step <= STEPS; step++) {
        wrong |= finish(numbers[step], step, &contacts);
    }
    printf("%u steps of %u vertices, %llu contacts\n", STEPS, VERTICES,
           (unsigned long long)contacts);
    pccd_close(client);
    return wrong || contacts < VERTICES;
}

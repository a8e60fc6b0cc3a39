/* game_loop.c - a game's loop at 60 Hz: submit now, collect in the next frame.
 *
 * Room:     client/examples. May include: pccd.h.
 * Does:     one poll(2) waits for the clock and the daemon. At each tick the last frame's
 *           contacts are taken, and the next positions written straight into a slot of
 *           the upload ring; nothing blocks on the daemon. Waves run over the cloth,
 *           and which vertices pass the floor in a frame is known, so each is checked.
 * Threads:  one.
 */
#define _POSIX_C_SOURCE 200809L /* for the clock's types, which -std=c11 hides */
#include <math.h>
#include <poll.h>
#include <sys/timerfd.h>
#include <unistd.h>

#include "sheet.h"

enum { SIDE = 32, VERTICES = SIDE * SIDE, CELLS = (SIDE - 1) * (SIDE - 1), FRAMES = 60 };

static struct pccd_client *client;
static uint32_t scene, cloth;

static float height(int frame, int i) /* of vertex i, never exactly 0 */
{
    return 0.3f * sinf(0.4f * (float)(i % SIDE) + 0.2f * (float)frame) + 0.011f;
}

static void fill(float (*x)[3], int frame)
{
    for (int i = 0; i < VERTICES; i++) {
        x[i][0] = (float)(i % SIDE) / (float)SIDE - 0.5f;
        x[i][1] = (float)(i / SIDE) / (float)SIDE - 0.5f;
        x[i][2] = height(frame, i);
    }
}

static void make(void)
{
    const float floor_x[3][3] = {{-9, -9, 0}, {9, -9, 0}, {0, 9, 0}};
    const uint32_t floor_triangle[1][3] = {{0, 1, 2}};
    static uint32_t triangles[2 * CELLS][3];
    static float x[VERTICES][3];
    uint32_t mesh, floor;

    ok(client, pccd_connect(&(struct pccd_options){.private_daemon = true}, &client));
    ok(client, pccd_scene_create(client, NULL, &scene));
    ok(client, pccd_mesh_create(client, floor_x, PCCD_FORMAT_F32, 3, floor_triangle, 1,
                                &mesh, NULL));
    ok(client, pccd_scene_add(client, scene, mesh, &floor));
    sheet_triangles(SIDE, triangles);
    fill(x, 0);
    ok(client, pccd_mesh_create(client, x, PCCD_FORMAT_F32, VERTICES, (void *)triangles,
                                2 * CELLS, &mesh, NULL));
    ok(client, pccd_scene_add(client, scene, mesh, &cloth));
}

static void submit(int frame)
{
    struct pccd_frame step;
    uint64_t number;
    void *x1;

    ok(client, pccd_frame_begin(client, scene, 1, sizeof(float[VERTICES][3]), &step));
    ok(client, pccd_frame_x1(&step, cloth, PCCD_FORMAT_F32, 0, VERTICES, &x1));
    fill(x1, frame);
    ok(client, pccd_frame_commit(&step, NULL, &number));
}

/* The game's part. Here: each vertex that has changed sides has met the floor. */
static void respond(const struct pccd_answer *answer, int frame)
{
    uint64_t passed = 0;

    for (int i = 0; i < VERTICES; i++) {
        passed += height(frame - 1, i) * height(frame, i) < 0;
    }
    ok(client, answer->status != 0 || answer->incomplete != 0 ||
                   answer->counts[PCCD_VF] != passed);
}

int main(void)
{
    const struct itimerspec hz60 = {{0, 16666667}, {0, 1}};
    struct pollfd wait[2] = {{timerfd_create(CLOCK_MONOTONIC, 0), POLLIN, 0},
                             {-1, POLLIN, 0}};
    struct pccd_answer answer = PCCD_ANSWER_INIT;
    int frame = 0, taken = 0, late = 0;
    uint64_t ticks;

    make();
    timerfd_settime(wait[0].fd, 0, &hz60, NULL);
    while (taken < FRAMES) {
        wait[1].fd = pccd_fd(client);
        ok(client, poll(wait, 2, 1000) <= 0);
        while (pccd_poll(client, &answer) == 0) {
            respond(&answer, ++taken);
            pccd_answer_release(client, &answer);
        }
        if ((wait[0].revents & POLLIN) && read(wait[0].fd, &ticks, 8) == 8 &&
            frame < FRAMES) {
            late += frame > taken; /* the last frame's answer is not there yet */
            submit(++frame);
        }
    }
    printf("%d frames at 60 Hz, %d of their answers late\n", taken, late);
    pccd_close(client);
    return 0;
}

/* two_processes.c - one scene, two processes: one moves the cloth, the other obstacles.
 *
 * Room:     client/examples. May include: pccd.h.
 * Does:     the parent starts a private daemon and shares a scene with its child. The
 *           child's floor rises through the parent's triangle: its frames are held until
 *           the parent steps, and go along with that step, so both move over the same
 *           time. Each vertex of the triangle is met once, whichever step it falls into.
 * Threads:  one in each process.
 */
#include <stdio.h>
#include <sys/wait.h>
#include <unistd.h>

#include "pccd.h"

enum { FRAMES = 40 };

static const uint32_t triangle[1][3] = {{0, 1, 2}};

/* Take part in the scene with one triangle of this process. */
static int take_part(const struct pccd_options *options, const float x[3][3],
                     struct pccd_client **client, uint32_t *scene, uint32_t *object)
{
    const struct pccd_scene_settings shared = {.name = "stage", .share = PCCD_SHARE_OPEN};
    uint32_t mesh = 0;
    int rc = pccd_connect(options, client);

    rc = rc ? rc : pccd_scene_create(*client, &shared, scene);
    rc = rc ? rc
            : pccd_mesh_create(*client, x, PCCD_FORMAT_F32, 3, triangle, 1, &mesh, NULL);
    return rc ? rc : pccd_scene_add(*client, *scene, mesh, object);
}

/* The floor from height -1 to 1; every frame waits for a step of the other process. */
static int run_obstacles(const char *url)
{
    const float x0[3][3] = {{-9, -9, -1}, {9, -9, -1}, {0, 9, -1}};
    const struct pccd_step_settings settings = {.hold = true};
    struct pccd_client *client = NULL;
    struct pccd_options options;
    struct pccd_answer answer;
    unsigned long long met = 0;
    uint32_t scene = 0, floor = 0;
    int rc;

    pccd_options_init(&options);
    options.url = url;
    rc = take_part(&options, x0, &client, &scene, &floor);
    for (int i = 1; rc == 0 && i <= FRAMES; i++) {
        const float z = -1 + 2 * (float)i / FRAMES;
        const float x1[3][3] = {{-9, -9, z}, {9, -9, z}, {0, 9, z}};

        rc = pccd_step_x1(client, scene, floor, x1, PCCD_FORMAT_F32, 3, &settings,
                          &answer);
        met += rc == 0 ? answer.vf : 0;
    }
    printf("obstacles: %d frames, %llu vertices met\n", FRAMES, met);
    if (rc != 0) {
        fprintf(stderr, "obstacles: %s\n", pccd_error_text(client));
    }
    pccd_close(client);
    fflush(stdout);
    return rc != 0 || met != 3;
}

int main(void)
{
    const float x[3][3] = {{0, 0, 0.01f}, {1, 0, 0.02f}, {0, 1, 0.04f}};
    struct pccd_client *client = NULL;
    struct pccd_options options;
    struct pccd_answer answer;
    unsigned long long met = 0, steps = 0;
    uint32_t scene = 0, object = 0;
    int status = 0, rc;
    pid_t child;

    pccd_options_init(&options);
    options.private_daemon = true;
    rc = take_part(&options, x, &client, &scene, &object);
    child = rc == 0 ? fork() : -1;
    if (child == 0) { /* the parent's client is the parent's: the child makes its own */
        _exit(run_obstacles(pccd_url(client)));
    }
    /* Step as fast as the daemon answers, until the other process has gone. */
    while (rc == 0 && waitpid(child, &status, WNOHANG) == 0) {
        rc = pccd_step_x1(client, scene, object, x, PCCD_FORMAT_F32, 3, NULL, &answer);
        if (rc == 0) {
            met += answer.vf;
            steps++;
            pccd_answer_release(client, &answer);
        }
    }
    printf("cloth: %llu steps, %llu vertices met: %s\n", steps, met,
           rc == 0 && met == 3 && status == 0 ? "right" : "wrong");
    if (rc != 0) {
        fprintf(stderr, "cloth: %s\n", pccd_error_text(client));
    }
    pccd_close(client);
    return rc != 0 || met != 3 || status != 0;
}

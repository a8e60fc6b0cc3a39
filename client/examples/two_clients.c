/* two_clients.c - two processes, one daemon.
 *
 * Room:     client/examples. May include: pccd.h.
 * Does:     the parent starts a private daemon; its child connects to the same one by its
 *           url. Each has a scene of its own, and neither sees the other's.
 * Threads:  one in each process.
 */
#include <stdio.h>
#include <stdlib.h>
#include <sys/wait.h>
#include <unistd.h>

#include "pccd.h"

#define STEPS 50

/* A triangle that falls by one unit a step, from height 0.5 above a row of floors at
 * whole heights: each of its vertices meets one floor in every step, half-way. With
 * `floors` = 0 there is nothing to meet. Returns 0 when every answer was right. */
static int fall(struct pccd_client *client, int floors, const char *who)
{
    const float x0[3][3] = {{0, 0, 0.5f}, {1, 0, 0.5f}, {0, 1, 0.5f}};
    const uint32_t triangle[1][3] = {{0, 1, 2}};
    uint32_t scene = 0;
    uint32_t mesh = 0;
    uint32_t object = 0;
    uint64_t contacts = 0;
    int rc = pccd_scene_create(client, NULL, &scene);

    for (int i = 0; rc == 0 && i < floors; i++) {
        const float z = (float)-i;
        const float floor_x[3][3] = {{-9, -9, z}, {9, -9, z}, {0, 9, z}};

        rc = pccd_mesh_create(client, floor_x, PCCD_FORMAT_F32, 3, triangle, 1, &mesh,
                              NULL);
        if (rc == 0) {
            rc = pccd_scene_add(client, scene, mesh, &object);
        }
    }
    if (rc == 0) {
        rc = pccd_mesh_create(client, x0, PCCD_FORMAT_F32, 3, triangle, 1, &mesh, NULL);
    }
    if (rc == 0) {
        rc = pccd_scene_add(client, scene, mesh, &object);
    }
    for (int step = 1; rc == 0 && step <= STEPS; step++) {
        const float z = 0.5f - (float)step;
        const float x1[3][3] = {{0, 0, z}, {1, 0, z}, {0, 1, z}};
        struct pccd_answer answer;

        rc = pccd_step_x1(client, scene, object, x1, PCCD_FORMAT_F32, 3, NULL, &answer);
        if (rc == 0 && answer.vf != (step <= floors ? 3u : 0u)) {
            rc = 1;
        }
        if (rc == 0) {
            contacts += answer.count;
        }
        pccd_answer_release(client, &answer);
    }
    printf("%s: %llu contacts%s%s\n", who, (unsigned long long)contacts,
           rc == 0 ? "" : ", ",
           rc == 0   ? ""
           : rc == 1 ? "a wrong answer"
                     : pccd_error_text(client));
    return rc;
}

static int run_child(const char *url)
{
    struct pccd_options options;
    struct pccd_client *client = NULL;
    int rc;

    pccd_options_init(&options);
    options.url = url;
    rc = pccd_connect(&options, &client);
    if (rc != 0) {
        fprintf(stderr, "child: %s\n", pccd_error_text(NULL));
        return rc;
    }
    rc = fall(client, 0, "child");
    pccd_close(client);
    return rc;
}

int main(void)
{
    struct pccd_options options;
    struct pccd_client *client = NULL;
    pid_t child;
    int status = 0;
    int rc;

    pccd_options_init(&options);
    options.private_daemon = true;
    if (pccd_connect(&options, &client) != 0) {
        fprintf(stderr, "parent: %s\n", pccd_error_text(NULL));
        return 1;
    }
    child = fork();
    if (child == 0) { /* the parent's client is the parent's: the child makes its own */
        rc = run_child(pccd_url(client));
        fflush(stdout);
        _exit(rc != 0);
    }
    rc = fall(client, 20, "parent");
    if (child < 0 || waitpid(child, &status, 0) != child || !WIFEXITED(status) ||
        WEXITSTATUS(status) != 0) {
        fprintf(stderr, "the child failed\n");
        rc = 1;
    }
    pccd_close(client);
    return rc != 0;
}

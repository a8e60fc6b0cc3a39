/* hello.c - the smallest whole program: one triangle moves through another.
 *
 * Room:     client/examples. May include: pccd.h.
 * Does:     start a daemon, register two triangles, make one step, print its contacts.
 * Threads:  one.
 */
#include <stdio.h>
#include <stdlib.h>

#include "pccd.h"

static struct pccd_client *client;

static void check(int status)
{
    if (status == 0) {
        return;
    }
    fprintf(stderr, "%s: %s\n", pccd_status_name(status), pccd_error_text(client));
    pccd_close(client); /* exit status 1 */
    exit(1);
}

int main(void)
{
    const float floor_x[3][3] = {{-9, -9, 0}, {9, -9, 0}, {0, 9, 0}};
    const float x0[3][3] = {{0, 0, 1}, {1, 0, 1}, {0, 1, 1}};
    const float x1[3][3] = {{0, 0, -1}, {1, 0, -1}, {0, 1, -1}};
    const uint32_t triangle[1][3] = {{0, 1, 2}};
    struct pccd_options options;
    struct pccd_answer answer = PCCD_ANSWER_INIT;
    uint32_t scene, floor_mesh, mesh, floor_object, object;

    pccd_options_init(&options);
    options.private_daemon = true; /* of our own; without this line: the user's daemon */
    check(pccd_connect(&options, &client));
    check(pccd_scene_create(client, NULL, &scene));
    check(pccd_mesh_create(client, floor_x, PCCD_FORMAT_F32, 3, triangle, 1, &floor_mesh,
                           NULL));
    check(pccd_mesh_create(client, x0, PCCD_FORMAT_F32, 3, triangle, 1, &mesh, NULL));
    check(pccd_scene_add(client, scene, floor_mesh, &floor_object));
    check(pccd_scene_add(client, scene, mesh, &object));
    check(pccd_step_x1(client, scene, object, x1, PCCD_FORMAT_F32, 3, NULL, &answer));
    for (uint64_t i = 0; i < answer.count; i++) {
        bool is_face = answer.contacts[i].kind == PCCD_VF;
        printf("%s %u meets %s %u at t = %.3f\n", is_face ? "vertex" : "edge",
               answer.contacts[i].feature_a, is_face ? "face" : "edge",
               answer.contacts[i].feature_b, answer.contacts[i].toi);
    }
    /* Its three vertices pass through the floor half-way. */
    int wrong = answer.count != 3 || answer.counts[PCCD_VF] != 3 ||
                answer.toi_first > 0.5 || answer.toi_first < 0.499;
    pccd_answer_release(client, &answer);
    pccd_close(client);
    return wrong;
}

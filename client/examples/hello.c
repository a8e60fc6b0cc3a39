/* hello.c - the smallest whole program: a corner of one triangle moves through another.
 *
 * Room:     client/examples. May include: pccd.h.
 * Does:     start a daemon, register a mesh, make one step, print its contact.
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
    const double x0[6][3] = {
        {0, 0, 0},   {1, 0, 0},   {0, 1, 0},    /* lower triangle */
        {.2, .2, 1}, {.3, .2, 4}, {.2, .3, 4}}; /* upper one, before */
    const double x1[6][3] = {
        {0, 0, 0},    {1, 0, 0},   {0, 1, 0},    /* stays */
        {.2, .2, -1}, {.3, .2, 2}, {.2, .3, 2}}; /* has fallen by 2 */
    const uint32_t triangles[2][3] = {{0, 1, 2}, {3, 4, 5}};
    struct pccd_options options;
    struct pccd_answer answer = PCCD_ANSWER_INIT;
    uint32_t scene, mesh, object;

    pccd_options_init(&options);
    options.private_daemon = true; /* of our own; without this line: the user's daemon */
    check(pccd_connect(&options, &client));
    check(pccd_scene_create(client, NULL, &scene));
    check(pccd_mesh_create(client, x0, PCCD_FORMAT_F64, 6, triangles, 2, &mesh, NULL));
    check(pccd_scene_add(client, scene, mesh, &object));
    check(pccd_step_x1(client, scene, object, x1, PCCD_FORMAT_F64, 6, NULL, &answer));
    for (uint64_t i = 0; i < answer.count; i++) {
        bool is_face = answer.contacts[i].kind == PCCD_VF;
        printf("%s %u hits %s %u at t = %.3f\n", is_face ? "vertex" : "edge",
               answer.contacts[i].feature_a, is_face ? "face" : "edge",
               answer.contacts[i].feature_b, answer.contacts[i].toi);
    }
    /* The corner passes through the lower triangle half-way. */
    int wrong = answer.count != 1 || answer.counts[PCCD_VF] != 1 ||
                answer.toi_first > 0.5 || answer.toi_first < 0.499;
    pccd_answer_release(client, &answer);
    pccd_close(client);
    return wrong;
}

/* hinge.c - a door turns about its pin, and stops before the post.
 *
 * Room:     client/examples. May include: pccd.h.
 * Does:     start a daemon, register a pin, a door around it, and a post; turn the door
 *           by 90 degrees, print at which angle it hits, and turn it as far as it goes.
 * Threads:  one.
 */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "pccd.h"

#define QUARTER 1.5707963267948966 /* of a turn, in radians */
#define POST    1.0                /* where the post stands: some 57 degrees */

static struct pccd_client *client;

static void check(int status)
{
    if (status == 0) {
        return;
    }
    fprintf(stderr, "%s: %s\n", pccd_status_name(status),
            pccd_error_text(status == PCCD_E_INVAL && *pccd_error_text(client) == '\0'
                                ? NULL
                                : client));
    pccd_close(client); /* exit status 1 */
    exit(1);
}

static uint32_t add(uint32_t scene, const double (*x)[3], uint32_t vertex_count,
                    const uint32_t (*triangles)[3], uint32_t triangle_count)
{
    uint32_t mesh, object;

    check(pccd_mesh_create(client, x, PCCD_FORMAT_F64, vertex_count, triangles,
                           triangle_count, &mesh, NULL));
    check(pccd_scene_add(client, scene, mesh, &object));
    return object;
}

/* Turn the door about the z axis, and return the safe part of the way. */
static double turn(uint32_t scene, uint32_t door, double angle, uint64_t *hits)
{
    const double pin[3] = {0, 0, 0}, axis[3] = {0, 0, 1};
    struct pccd_step_settings settings = PCCD_STEP_SETTINGS_INIT;
    struct pccd_answer answer = PCCD_ANSWER_INIT;
    struct pccd_joint joints[PCCD_JOINTS_MOST];
    struct pccd_motion motion = {.object = door, .count = 4};
    uint32_t count = 0;

    check(pccd_joints_screw(pin, axis, angle, 0, PCCD_NO_JOINT, joints, PCCD_JOINTS_MOST,
                            &count));
    settings.joints = joints;
    settings.joint_count = count;
    motion.first = count - 1; /* the door hangs on the last of them */
    check(pccd_step(client, scene, &motion, 1, &settings, &answer));
    for (uint64_t i = 0; i < answer.count; i++) {
        printf("%s at %.4f degrees\n",
               (answer.contacts[i].flags & PCCD_PROVED) != 0 ? "hits" : "may hit",
               answer.contacts[i].toi * angle * 90 / QUARTER);
    }
    *hits = answer.count;
    double safe_step = answer.safe_step;
    pccd_answer_release(client, &answer);
    return safe_step;
}

int main(void)
{
    /* The door is a plate from the pin's axis outwards, so that the pin crosses it. */
    const double door_x[4][3] = {{0, 0, 0}, {1, 0, 0}, {1, 0, 2}, {0, 0, 2}};
    const double pin_x[4][3] = {
        {0.02, 0, -1}, {-0.02, 0.02, -1}, {-0.02, -0.02, -1}, {0, 0, 3}};
    const double post_x[3][3] = {{0.8 * cos(POST), 0.8 * sin(POST), -1},
                                 {0.8 * cos(POST), 0.8 * sin(POST), 3},
                                 {cos(POST + 2), sin(POST + 2), 1}};
    const uint32_t door_faces[2][3] = {{0, 1, 2}, {0, 2, 3}};
    const uint32_t pin_faces[4][3] = {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}};
    struct pccd_options options;
    uint32_t scene;
    uint64_t hits = 0, none = 0;

    pccd_options_init(&options);
    options.private_daemon = true; /* of our own; without this line: the user's daemon */
    check(pccd_connect(&options, &client));
    check(pccd_scene_create(client, NULL, &scene));
    uint32_t door = add(scene, door_x, 4, door_faces, 2);
    uint32_t pin = add(scene, pin_x, 4, pin_faces, 4);
    (void)add(scene, post_x, 3, door_faces, 1);
    check(pccd_pair_ignore(client, scene, door, pin, true)); /* they touch by design */

    double safe = turn(scene, door, QUARTER, &hits);
    double again = turn(scene, door, safe * QUARTER, &none);
    printf("the door opens by %.4f degrees\n", 90 * safe * again);
    pccd_close(client);
    return !(hits == 3 && none == 0 && fabs(safe * QUARTER - POST) < 1e-4);
}

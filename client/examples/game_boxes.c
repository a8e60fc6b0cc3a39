/* game_boxes.c - a game's bodies: boxes turn, fall on each other, and come to rest.
 *
 * Room:     client/examples. May include: pccd.h.
 * Does:     each frame, ask what the boxes meet on their true arcs, answer each point by
 *           an impulse, and ask again; then go as far as is safe. Nothing passes through
 *           anything, and in the end all lie on the floor.
 * Threads:  one.
 */
#include "sheet.h"

enum { BODIES = 4, FRAMES = 400, TRIES = 20, ROOM = PCCD_JOINTS_MOST * BODIES };
#define HALF  0.1  /* of a box's edge; body 0 is the floor */
#define FALL  4e-4 /* gravity, in units per frame squared */
#define THICK 2e-3 /* what each body adds to the distance at which it is met */

static uint32_t faces[12][3];
static double x[2][8][3]; /* of the floor and of a box */
static struct pccd_edge edges[2][18];
static double speed[BODIES][3], spin[BODIES][3]; /* in a frame; about the middle */
static double place[BODIES][12];                 /* where they are: rows of [R | t] */
static struct pccd_body bodies[BODIES];

static void make(struct pccd_client *client, uint32_t scene)
{
    const struct pccd_object_settings r = {.what = PCCD_OBJECT_RADIUS, .radius = THICK};
    struct pccd_mesh_info info;
    uint32_t mesh;
    for (uint32_t i = 0; i < BODIES; i++) {
        for (int k = 0; k < 3; k++) {
            place[i][5 * k] = 1;
            place[i][4 * k + 3] = (k == 2 ? 0.4 : 0.04) * i;
            spin[i][k] = 0.01 * i;
        }
        if (i < 2) { /* the boxes share a mesh */
            box_make(i == 0 ? (double[]){1, 1, HALF} : (double[]){HALF, HALF, HALF}, x[i],
                     faces);
            ok(client, pccd_mesh_create(client, x[i], PCCD_FORMAT_F64, 8, (void *)faces,
                                        12, &mesh, &info));
            ok(client, pccd_mesh_edges(client, mesh, edges[i], info.edge_count));
        }
        bodies[i] = (struct pccd_body){
            0,           0,    8,        12,      18, faces[0], edges[i > 0],
            x[i > 0][0], NULL, place[i], place[i]};
        ok(client, pccd_scene_add(client, scene, mesh, &bodies[i].object));
        ok(client, pccd_object_set(client, scene, bodies[i].object, &r));
    }
}

/* An impulse at each point between two bodies: they part there, and slide less. */
static void respond(const struct pccd_manifold *m)
{
    uint32_t of[2] = {m->object_a - bodies[0].object, m->object_b - bodies[0].object};
    for (uint32_t p = 0; p < m->count; p++) {
        const struct pccd_manifold_point *at = &m->points[p];
        double arm[2][3], turn[3], apart[3], along = 0;
        for (int k = 0; k < 6; k++) {
            arm[k / 3][k % 3] = at->point[k % 3] - place[of[k / 3]][4 * (k % 3) + 3];
        }
        for (int s = 0; s < 2; s++) {
            cross(spin[of[s]], arm[s], turn);
            for (int k = 0; k < 3; k++) {
                double v = speed[of[s]][k] + turn[k];
                apart[k] = s == 0 ? -v : apart[k] + v;
                along += (s == 0 ? -v : v) * at->normal[k];
            }
        }
        double push = fmax((2.2 * THICK - at->distance) / 4, 0) - along;
        for (int s = 0; s < 2 && push > 0; s++) {
            double part = (s == 0 ? -1 : 1) * (of[0] > 0 && of[1] > 0 ? 0.2 : 0.4), j[3];
            for (int k = 0; k < 3; k++) {
                double slide = apart[k] - along * at->normal[k];
                j[k] = part * (push * at->normal[k] - 0.3 * slide);
            }
            cross(arm[s], j, turn);
            for (int k = 0; k < 3 && of[s] > 0; k++) {
                speed[of[s]][k] += j[k];
                spin[of[s]][k] += 1.5 / (HALF * HALF) * turn[k]; /* as a cube is turned */
            }
        }
    }
}

/* Ask for a frame, and answer it; go as far as is safe. Return whether that is all. */
static int try_frame(struct pccd_client *client, uint32_t scene,
                     const struct pccd_pose *pose)
{
    struct pccd_joint joints[ROOM];
    struct pccd_motion motions[BODIES]; /* the floor has none */
    struct pccd_manifold points[BODIES * BODIES];
    struct pccd_step_settings settings = {.joints = joints};
    struct pccd_answer answer = PCCD_ANSWER_INIT;
    uint64_t pairs;
    for (uint32_t i = 1; i < BODIES; i++) {
        const double *w = spin[i], *q = pose[i].rotation;
        struct pccd_pose end; /* turned by w, while that is little */
        cross(w, q, end.rotation);
        for (int k = 0; k < 3; k++) {
            end.rotation[k] = q[k] + (end.rotation[k] + q[3] * w[k]) / 2;
            end.position[k] = pose[i].position[k] + speed[i][k];
        }
        end.rotation[3] = q[3] - (w[0] * q[0] + w[1] * q[1] + w[2] * q[2]) / 2;
        ok(NULL, pccd_joints_poses(&pose[i], &end, 0, NULL, PCCD_NO_JOINT, joints, ROOM,
                                   &settings.joint_count));
        motions[i] = (struct pccd_motion){
            .object = bodies[i].object, .first = settings.joint_count - 1, .count = 8};
    }
    ok(client, pccd_step(client, scene, motions + 1, BODIES - 1, &settings, &answer));
    for (uint32_t i = 1; i < BODIES; i++) {
        ok(NULL, pccd_joints_place(joints, settings.joint_count, motions[i].first,
                                   answer.safe_step, place[i]));
    }
    ok(NULL, pccd_manifolds(bodies, BODIES, answer.contacts, answer.count, 1, points,
                            BODIES * BODIES, &pairs));
    pccd_answer_release(client, &answer);
    for (uint64_t i = 0; i < pairs; i++) {
        respond(&points[i]);
    }
    return pairs == 0;
}

int main(void)
{
    struct pccd_client *client = NULL;
    struct pccd_pose pose[BODIES];
    uint32_t scene;
    ok(client, pccd_connect(&(struct pccd_options){.private_daemon = true}, &client));
    ok(client, pccd_scene_create(client, NULL, &scene));
    make(client, scene);
    for (int frame = 0; frame < FRAMES; frame++) {
        for (uint32_t i = 1; i < BODIES; i++) {
            ok(NULL, pccd_rotation_of_matrix(place[i], pose[i].rotation));
            for (int k = 0; k < 3; k++) {
                pose[i].position[k] = place[i][4 * k + 3];
                speed[i][k] = 0.99 * speed[i][k] - (k == 2 ? FALL : 0);
                spin[i][k] *= 0.99; /* in the air */
            }
        }
        for (int try = 0; try < TRIES && !try_frame(client, scene, pose); try++) {
        }
    }
    for (uint32_t i = 1; i < BODIES; i++) { /* each lies on the floor */
        ok(client, !(place[i][11] < 2 * HALF + 3 * THICK));
    }
    nothing_is_near(client, scene);
    printf("%d boxes lie on the floor, none nearer than %g\n", BODIES - 1, 2 * THICK);
    pccd_close(client);
    return 0;
}

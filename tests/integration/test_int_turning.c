/* test_int_turning.c - bodies that turn, through the library and the wire. */
#include "cases.h"

#include <signal.h>

#include "fixture.h"
#include "format.h"
#include "must.h"
#include "raw.h"
#include "recording.h"
#include "run_ctl.h"

#define PI    3.141592653589793
#define QUAD  4u    /* vertices of a door: two triangles */
#define ANGLE 1.125 /* where the post stands, seen from the pin */

/* A door in the plane y = 0, with its pin along z through the origin, and a post beyond:
 * an upright edge at half of the door's width, and a face behind it. It has turned by
 * ANGLE when it meets the post, which is higher than it is: each of its two level edges
 * and its diagonal meet the post's edge then, and nothing else meets before. */
static const double door_x[QUAD][3] = {
    {0.125, 0, -1}, {1, 0, -1}, {1, 0, 1}, {0.125, 0, 1}};
static const uint32_t door_faces[2][3] = {{0, 1, 2}, {0, 2, 3}};
static const uint32_t post_face[1][3] = {{0, 1, 2}};

struct hall {
    struct pccd_client *client;
    uint32_t scene, door, post;
    struct pccd_joint joints[2 * PCCD_JOINTS_MOST];
    uint32_t joint_count;
};

static void make(struct hall *hall)
{
    const double post_x[3][3] = {{0.5 * cos(ANGLE), 0.5 * sin(ANGLE), -2},
                                 {0.5 * cos(ANGLE), 0.5 * sin(ANGLE), 2},
                                 {cos(ANGLE + 1), sin(ANGLE + 1), 0}};

    hall->scene = test_scene(hall->client);
    hall->door = test_object(
        hall->client, hall->scene,
        test_mesh(hall->client, door_x, PCCD_FORMAT_F64, QUAD, door_faces, 2));
    hall->post =
        test_object(hall->client, hall->scene,
                    test_mesh(hall->client, post_x, PCCD_FORMAT_F64, 3, post_face, 1));
}

/* All that turns about the pin, by `angle`. */
static void hinge(struct hall *hall, double angle)
{
    hall->joint_count = 0;
    assert_ok(pccd_joints_screw((double[3]){0, 0, 0}, (double[3]){0, 0, 1}, angle, 0,
                                PCCD_NO_JOINT, hall->joints, 2 * PCCD_JOINTS_MOST,
                                &hall->joint_count));
}

static int turn(struct hall *hall, struct pccd_step_settings settings,
                struct pccd_answer *answer)
{
    const struct pccd_motion motion = {
        .object = hall->door, .first = hall->joint_count - 1, .count = QUAD};

    settings.struct_bytes = sizeof settings;
    settings.joints = hall->joints;
    settings.joint_count = hall->joint_count;
    *answer = (struct pccd_answer)PCCD_ANSWER_INIT;
    return pccd_step(hall->client, hall->scene, &motion, 1, &settings, answer);
}

#define DEFAULTS ((struct pccd_step_settings)PCCD_STEP_SETTINGS_INIT)

/* If this failed, a door would hit its post too early, too late or not at all, or each
 * daemon and number of threads would say another thing. */
CASE(turning__door_meets_the_post_at_its_angle_with_the_same_bytes_everywhere)
{
    struct pccd_contact first[8];
    uint64_t hash[2] = {0, 0}, count = 0;

    for (int round = 0; round < 4; round++) {
        struct hall hall = {
            .client = test_client_at(round % 2 == 0 ? test_shared.url : TEST_DIRECT_URL)};
        struct pccd_step_settings settings = DEFAULTS;
        struct pccd_answer answer;

        make(&hall);
        hinge(&hall, PI / 2);
        settings.threads = round < 2 ? 1 : 2;
        assert_ok(turn(&hall, settings, &answer));
        assert_int_equal(answer.incomplete, PCCD_COMPLETE);
        assert_int_equal(answer.counts[PCCD_EE], 3);
        assert_int_equal(answer.total, 3);
        for (uint64_t i = 0; i < answer.count; i++) {
            const struct pccd_contact *contact = &answer.contacts[i];

            assert_true(contact->toi <= ANGLE / (PI / 2) && contact->toi_hi <= 1);
            assert_true(contact->toi_hi >= ANGLE / (PI / 2));
            assert_true(contact->toi_hi - contact->toi <= 1e-5);
        }
        assert_int_equal(answer.counts[PCCD_EE] - answer.possible, 3);
        assert_true(answer.safe_step > 0 && answer.safe_step <= ANGLE / (PI / 2));
        if (round == 0) {
            count = answer.count;
            memcpy(first, answer.contacts, count * sizeof *first);
            memcpy(hash, answer.hash, sizeof hash);
        }
        assert_memory_equal(answer.contacts, first, count * sizeof *first);
        assert_memory_equal(answer.hash, hash, sizeof hash);
        pccd_answer_release(hall.client, &answer);
        hinge(&hall, ANGLE - 1e-5); /* the door goes back, and nearly as far */
        assert_ok(turn(&hall, settings, &answer));
        assert_int_equal(answer.total, 0);
        assert_true(answer.safe_step == 1);
        pccd_answer_release(hall.client, &answer);
        pccd_close(hall.client);
    }
}

/* If this failed, what moves on one link would be thought to move against another link of
 * the same chain. */
CASE(turning__links_of_a_chain_move_by_the_joints_between_them)
{
    struct hall hall = {.client = test_client_at(test_shared.url)};
    struct pccd_answer answer = PCCD_ANSWER_INIT;
    struct pccd_step_settings settings = DEFAULTS;
    struct pccd_motion motions[2];

    make(&hall);
    hinge(&hall, 100 * PI); /* the room turns, .. */
    uint32_t room = hall.joint_count - 1;
    assert_ok(pccd_joints_screw((double[3]){0, 0, 0}, (double[3]){0, 0, 1}, 1, 0, room,
                                hall.joints, 2 * PCCD_JOINTS_MOST,
                                &hall.joint_count)); /* .. and its door */
    motions[0] = (struct pccd_motion){.object = hall.post, .first = room, .count = 3};
    motions[1] = (struct pccd_motion){
        .object = hall.door, .first = hall.joint_count - 1, .count = QUAD};
    settings.joints = hall.joints;
    settings.joint_count = hall.joint_count;
    assert_ok(pccd_step(hall.client, hall.scene, motions, 2, &settings, &answer));
    assert_int_equal(answer.total, 0);
    pccd_answer_release(hall.client, &answer);
    hall.joints[hall.joint_count - 2].to[0] = 1.25;
    assert_ok(pccd_step(hall.client, hall.scene, motions, 2, &settings, &answer));
    assert_int_equal(answer.total, 3);
    assert_true(answer.toi_first <= ANGLE / 1.25 &&
                answer.toi_first > ANGLE / 1.25 - 1e-5);
    pccd_answer_release(hall.client, &answer);
    pccd_close(hall.client);
}

/* Return what is nearest of door and post, as they stand. */
static struct pccd_near distance(struct hall *hall)
{
    struct pccd_near_settings settings = PCCD_NEAR_SETTINGS_INIT;
    struct pccd_answer answer = PCCD_ANSWER_INIT;

    settings.what = PCCD_NEAR_NEAREST;
    settings.distance = INFINITY;
    assert_ok(pccd_ask_near(hall->client, hall->scene, NULL, 0, &settings, &answer));
    assert_int_equal(answer.count, 1);
    struct pccd_near near = answer.near[0];
    pccd_answer_release(hall->client, &answer);
    return near;
}

/* If this failed, a door that has turned would stand elsewhere afterwards, to the last
 * bit: for the next step, for what is near, or once its daemon has crashed. */
CASE_DAEMON(turning__ends_where_its_joints_end_also_in_the_next_daemon, "--supervise",
            "--threads", "1")
{
    struct hall hall = {.client = NULL};
    struct pccd_answer answer = PCCD_ANSWER_INIT;
    double probe[2][3][3] = {
        {{-0.5, -0.25, 0.5}, {-0.5, -0.5, 0.5}, {-0.25, -0.375, 0.75}}};

    hall.client = test_client_at(test_own.url);
    make(&hall);
    hinge(&hall, -PI / 2);
    assert_ok(turn(&hall, DEFAULTS, &answer));
    pccd_answer_release(hall.client, &answer);
    struct pccd_near before = distance(&hall);
    assert_true(fabs(before.d_lo - hypot(0.5 * cos(ANGLE), 0.5 * sin(ANGLE) + 0.125)) <
                1e-9);
    assert_int_equal(kill((pid_t)pccd_daemon_pid(hall.client), SIGKILL), 0);
    struct pccd_near after = distance(&hall);
    assert_memory_equal(&before, &after, sizeof before);
    /* A body goes straight through where it stands now. */
    memcpy(probe[1], probe[0], sizeof probe[0]);
    for (int v = 0; v < 3; v++) {
        probe[1][v][0] += 1;
    }
    uint32_t body =
        test_object(hall.client, hall.scene,
                    test_mesh(hall.client, probe[0], PCCD_FORMAT_F64, 3, post_face, 1));
    answer = (struct pccd_answer)PCCD_ANSWER_INIT;
    assert_ok(pccd_pair_ignore(hall.client, hall.scene, body, hall.post, true));
    assert_ok(pccd_step_x0x1(hall.client, hall.scene, body, probe[0], probe[1],
                             PCCD_FORMAT_F64, 3, NULL, &answer));
    assert_true(answer.counts[PCCD_VF] == 3 && fabs(answer.toi_first - 0.25) < 1e-5);
    pccd_answer_release(hall.client, &answer);
    pccd_close(hall.client);
    (void)test_daemon_end(&test_own, SIGTERM, 10000);
}

/* If this failed, a session whose bodies turn could not be repeated, or be read by a
 * program that would misread it, or verify would not check them. */
CASE(turning__is_recorded_repeated_and_verified_as_far_as_that_goes)
{
    const struct pccd_record_settings kept = {.contacts = 1};
    struct hall hall = {.client = test_client_at(test_shared.url)};
    struct pccd_step_settings settings = DEFAULTS;
    struct pccd_near_settings near = PCCD_NEAR_SETTINGS_INIT;
    struct pccd_answer answer = PCCD_ANSWER_INIT;
    char said[8192];

    test_recording_clear();
    assert_ok(pccd_record_start(hall.client, test_recording, &kept));
    make(&hall);
    test_still(hall.client, hall.scene, NULL, &answer);
    hinge(&hall, PI / 2);
    assert_ok(turn(&hall, settings, &answer));
    assert_int_equal(answer.total, 3);
    pccd_answer_release(hall.client, &answer);
    settings.mode = PCCD_MODE_ANY;
    settings.resolution = 1e-3;
    hinge(&hall, -1);
    assert_ok(turn(&hall, settings, &answer));
    assert_int_equal(answer.verdict, PCCD_VERDICT_NO);
    near.what = PCCD_NEAR_NEAREST;
    near.distance = INFINITY;
    near.joints = hall.joints;
    near.joint_count = hall.joint_count;
    const struct pccd_motion motion = {
        .object = hall.door, .first = hall.joint_count - 1, .count = QUAD};
    assert_ok(pccd_ask_near(hall.client, hall.scene, &motion, 1, &near, &answer));
    assert_int_equal(answer.count, 1);
    pccd_answer_release(hall.client, &answer);
    test_still(hall.client, hall.scene, NULL, &answer);
    pccd_close(hall.client);
    assert_int_equal(test_recording_repeats("--json", test_recording, 5), 5);
    assert_int_equal(test_recording_repeats("--json --url direct:", test_recording, 5),
                     5);
    assert_int_equal(test_ctl("verify", "--json", test_recording, said, sizeof said), 0);
    assert_int_equal(test_ctl_number(said, "contacts"), 3);
    assert_int_equal(test_ctl_number(said, "turning"), 0);
}

/* Return when the door first comes near the post, seen from the pin; 0: it does not. */
static double first_angle(struct hall *hall)
{
    struct pccd_answer answer = PCCD_ANSWER_INIT;

    hinge(hall, PI / 2);
    assert_ok(turn(hall, DEFAULTS, &answer));
    double angle = answer.total > 0 ? answer.toi_first * PI / 2 : 0;
    pccd_answer_release(hall->client, &answer);
    return angle;
}

/* If this failed, a part that may touch another one would jam before it does, or one that
 * must not come near would; or the next daemon would not know of that. */
CASE_DAEMON(turning__knows_the_clearance_of_two_objects, "--supervise", "--threads", "1")
{
    const struct pccd_object_settings thick = {.what = PCCD_OBJECT_RADIUS, .radius = 0.1};
    const double near = ANGLE - asin(0.04 / 0.5);
    struct hall hall = {.client = NULL};

    hall.client = test_client_at(test_own.url);
    make(&hall);
    assert_ok(pccd_object_set(hall.client, hall.scene, hall.door, &thick));
    assert_true(fabs(first_angle(&hall) - (ANGLE - asin(0.2))) < 1e-5);
    assert_ok(pccd_pair_clearance(hall.client, hall.scene, hall.post, hall.door, 0));
    assert_true(fabs(first_angle(&hall) - ANGLE) < 1e-5);
    assert_ok(pccd_pair_clearance(hall.client, hall.scene, hall.door, hall.post, 0.04));
    assert_true(fabs(first_angle(&hall) - near) < 1e-5);
    assert_int_equal(kill((pid_t)pccd_daemon_pid(hall.client), SIGKILL), 0);
    assert_true(fabs(first_angle(&hall) - near) < 1e-5);
    assert_int_equal(
        pccd_pair_clearance(hall.client, hall.scene, hall.door, hall.post, -0.04),
        PCCD_E_INVAL);
    assert_int_equal(
        pccd_pair_clearance(hall.client, hall.scene, hall.door, hall.post, 1e19),
        PCCD_E_LIMIT);
    assert_int_equal(
        pccd_pair_clearance(hall.client, hall.scene, hall.door, hall.door, 1),
        PCCD_E_INVAL);
    assert_ok(pccd_pair_ignore(hall.client, hall.scene, hall.door, hall.post, true));
    assert_true(first_angle(&hall) == 0);
    assert_ok(pccd_pair_ignore(hall.client, hall.scene, hall.door, hall.post, false));
    assert_true(fabs(first_angle(&hall) - (ANGLE - asin(0.2))) < 1e-5);
    pccd_close(hall.client);
    (void)test_daemon_end(&test_own, SIGTERM, 10000);
}

/* If this failed, a part that turns could not be taken as far as it is free; or would be
 * taken farther, or be elsewhere than it is said to be. */
CASE(turning__goes_as_far_as_nothing_meets)
{
    struct hall hall = {.client = test_client_at(test_shared.url)};
    struct pccd_step_settings settings = DEFAULTS;
    struct pccd_answer answer = PCCD_ANSWER_INIT;
    double m[12], part = 2;
    void *x[1] = {m};

    make(&hall);
    hinge(&hall, PI / 2);
    struct pccd_motion motion = {
        .object = hall.door, .first = hall.joint_count - 1, .count = QUAD};
    settings.joints = hall.joints;
    settings.joint_count = hall.joint_count;
    for (int i = 0; i < 3; i++) { /* about what is possible near the end, too */
        settings.separation = i == 2 ? 0.04 : 0;
        settings.resolution = i == 1 ? 1e-4 : 0;
        const double least = i == 1 ? 1e-2 : 1e-4;
        const double met = (ANGLE - asin(settings.separation / 0.5)) / (PI / 2);
        assert_ok(pccd_step_safe(hall.client, hall.scene, &motion, 1, &settings, x, &part,
                                 &answer));
        assert_true(answer.total > 0);
        pccd_answer_release(hall.client, &answer);
        assert_true(part < met && part > met - least);
        assert_true(fabs(m[0] - cos(part * PI / 2)) < 1e-14 &&
                    fabs(m[4] - sin(part * PI / 2)) < 1e-14);
        struct pccd_near near = distance(&hall); /* it stands there */
        assert_true(fabs(near.d_lo - 0.5 * sin(ANGLE - part * PI / 2)) < 1e-9);
        hinge(&hall, part * (PI / 2));
        assert_ok(turn(&hall, settings, &answer));
        assert_true(answer.total == 0 && answer.safe_step == 1);
        pccd_answer_release(hall.client, &answer);
        hinge(&hall, PI / 2);
    }
    hinge(&hall, 1);
    settings.separation = 0;
    assert_ok(pccd_step_safe(hall.client, hall.scene, &motion, 1, &settings, x, &part,
                             &answer));
    pccd_answer_release(hall.client, &answer);
    assert_true(part == 1 && fabs(m[0] - cos(1)) < 1e-15);
    x[0] = NULL;
    assert_int_equal(
        pccd_step_safe(hall.client, hall.scene, &motion, 1, &settings, x, &part, &answer),
        PCCD_E_INVAL);
    x[0] = m;
    settings.joint_count = 0;
    assert_int_equal(
        pccd_step_safe(hall.client, hall.scene, &motion, 1, &settings, x, &part, &answer),
        PCCD_E_INVAL);
    pccd_close(hall.client);
}

/* If this failed, the bodies of several sessions could not turn over the same time, or a
 * recording of it would be of something else. */
CASE(turning__of_held_frames_goes_along_and_is_recorded)
{
    const struct pccd_scene_settings shared = {.name = "hall", .share = PCCD_SHARE_OPEN};
    struct hall a = {.client = test_client_at(test_shared.url)};
    struct hall b = {.client = test_client_at(test_shared.url)};
    struct pccd_step_settings held = DEFAULTS;
    struct pccd_answer answer = PCCD_ANSWER_INIT;
    struct pccd_frame frame;
    uint64_t step = 0;

    test_recording_clear();
    assert_ok(pccd_record_start(a.client, test_recording, NULL));
    assert_ok(pccd_scene_create(a.client, &shared, &a.scene));
    assert_ok(pccd_scene_create(b.client, &shared, &b.scene));
    a.door =
        test_object(a.client, a.scene,
                    test_mesh(a.client, door_x, PCCD_FORMAT_F64, QUAD, door_faces, 2));
    double wide[QUAD][3];
    for (uint32_t v = 0; v < QUAD; v++) { /* in the plane x = 0 */
        wide[v][0] = door_x[v][1];
        wide[v][1] = door_x[v][0];
        wide[v][2] = 2 * door_x[v][2];
    }
    b.door = test_object(b.client, b.scene,
                         test_mesh(b.client, wide, PCCD_FORMAT_F64, QUAD, door_faces, 2));
    hinge(&a, PI / 4 + 0.1);
    hinge(&b, -PI / 4 + 0.05);
    held.hold = true;
    assert_ok(pccd_frame_begin(b.client, b.scene, 1, 1024, &frame));
    assert_ok(pccd_frame_joints(&frame, b.joints, b.joint_count));
    assert_ok(pccd_frame_turning(&frame, b.door, b.joint_count - 1, QUAD));
    assert_ok(pccd_frame_commit(&frame, &held, &step));
    assert_ok(pccd_wait_held(b.client, step, -1));
    assert_ok(turn(&a, DEFAULTS, &answer));
    assert_true(answer.total > 0);
    pccd_answer_release(a.client, &answer);
    assert_ok(pccd_wait(b.client, step, -1, &answer));
    pccd_answer_release(b.client, &answer);
    assert_ok(pccd_record_stop(a.client, NULL));
    pccd_close(a.client);
    pccd_close(b.client);
    assert_int_equal(test_recording_repeats("--json", test_recording, 1), 1);
}

/* If this failed, a planner that asks for many motions at once would be told of others
 * than one by one, or could not repeat them. */
CASE(turning__of_a_batch_is_that_of_single_steps)
{
    struct hall halls[3];
    struct pccd_batch_part parts[4];
    struct pccd_batch_answer batched = PCCD_BATCH_ANSWER_INIT;
    struct pccd_batch *batch = NULL;
    struct pccd_answer answer;
    uint64_t hashes[3][2];
    const void *x1[4];
    const double post[3][3] = {{5, 0, 0}, {6, 0, 0}, {5, 1, 0}};
    uint32_t counts[3];

    halls[0].client = halls[1].client = halls[2].client = test_client_at(test_shared.url);
    struct pccd_client *client = halls[0].client;
    for (int i = 0; i < 3; i++) {
        make(&halls[i]);
        hinge(&halls[i], 1 + i * 0.25);
        assert_ok(turn(&halls[i], DEFAULTS, &answer));
        memcpy(hashes[i], answer.hash, sizeof hashes[i]);
        assert_int_equal(answer.total, i == 0 ? 0 : 3);
        pccd_answer_release(client, &answer);
        parts[i] = (struct pccd_batch_part){.scene = halls[i].scene,
                                            .object = halls[i].door,
                                            .first = halls[i].joint_count - 1,
                                            .count = QUAD,
                                            .way = PCCD_BATCH_TURNING};
        counts[i] = halls[i].joint_count;
        x1[i] = halls[i].joints;
    }
    assert_int_equal(pccd_batch_create(client, parts, 3, &batch), PCCD_E_INVAL);
    assert_int_equal(pccd_batch_create_turning(client, parts, 3, counts, 2, &batch),
                     PCCD_E_INVAL);
    assert_ok(pccd_batch_create_turning(client, parts, 3, counts, 3, &batch));
    test_recording_clear();
    assert_ok(pccd_record_start(client, test_recording, NULL));
    for (int i = 0; i < 30; i++) { /* its scenes are stepped at the same time */
        assert_ok(pccd_batch_step(batch, NULL, x1, NULL, &batched));
        pccd_batch_release(client, &batched);
    }
    assert_ok(pccd_batch_step(batch, NULL, x1, NULL, &batched));
    for (int i = 0; i < 3; i++) {
        assert_int_equal(batched.scenes[i].status, 0);
        assert_memory_equal(batched.scenes[i].hash, hashes[i], sizeof hashes[i]);
    }
    pccd_batch_release(client, &batched);
    pccd_batch_destroy(batch);
    /* Beside what goes straight, in the memory of the slot. */
    parts[3] = (struct pccd_batch_part){.scene = halls[2].scene,
                                        .object = halls[2].post,
                                        .count = 3,
                                        .format = PCCD_FORMAT_F64};
    assert_ok(pccd_batch_create_turning(client, parts, 4, counts, 3, &batch));
    void *to[4];
    assert_ok(pccd_batch_begin(batch, NULL, to));
    for (int i = 0; i < 3; i++) {
        memcpy(to[i], halls[i].joints, counts[i] * sizeof(struct pccd_joint));
    }
    memcpy(to[3], post, sizeof post);
    uint64_t step = 0;
    assert_ok(pccd_batch_commit(batch, NULL, &step));
    assert_ok(pccd_batch_wait(client, step, -1, &batched));
    assert_int_equal(batched.failed, 0);
    assert_memory_equal(batched.scenes[1].hash, hashes[1], sizeof hashes[1]);
    pccd_batch_release(client, &batched);
    pccd_batch_destroy(batch);
    pccd_close(client);
    assert_int_equal(test_recording_repeats("--json", test_recording, 96), 96);
}

/* If this failed, the table of one part would replace that of another, and an edge that
 * hits would be called free. */
CASE(turning__parts_of_one_scene_have_one_table)
{
    struct hall hall = {.client = test_client_at(test_shared.url)};
    struct pccd_batch_answer batched = PCCD_BATCH_ANSWER_INIT;
    struct pccd_batch *batch = NULL;

    make(&hall);
    hinge(&hall, 1.5);
    const struct pccd_batch_part parts[] = {
        {hall.scene, hall.door, hall.joint_count - 1, QUAD, 0, PCCD_BATCH_TURNING},
        {hall.scene, hall.post, 0, 3, 0, PCCD_BATCH_TURNING}};
    struct hall other = hall;
    const void *x1[] = {hall.joints, other.joints};

    assert_ok(pccd_batch_create_turning(hall.client, parts, 2, &hall.joint_count, 1,
                                        &batch));
    assert_ok(pccd_batch_step(batch, NULL, x1, NULL, &batched));
    assert_int_equal(batched.failed, 0);
    pccd_batch_release(hall.client, &batched);
    other.joints[0].to[0] += 1;
    assert_int_equal(pccd_batch_step(batch, NULL, x1, NULL, &batched), PCCD_E_INVAL);
    assert_non_null(strstr(pccd_error_text(hall.client), "part 1: its table of joints"));
    pccd_batch_destroy(batch);
    pccd_close(hall.client);
}

/* ---- misuse ------------------------------------------------------------------------ */

/* If this failed, what the library can see of a mistake would be told later, of another
 * thing, or never. */
CASE(turning__mistakes_in_a_frame_are_named)
{
    struct hall hall = {.client = test_client_at(test_shared.url)};
    struct pccd_step_settings settings = DEFAULTS;
    struct pccd_answer answer = PCCD_ANSWER_INIT;
    struct pccd_frame frame;
    uint64_t step = 0;

    make(&hall);
    hinge(&hall, 1);
    assert_ok(pccd_frame_begin(hall.client, hall.scene, 2, 8 + 136 * 3, &frame));
    assert_int_equal(pccd_frame_turning(&frame, hall.door, 0, QUAD), PCCD_E_STATE);
    assert_int_equal(pccd_frame_joints(&frame, NULL, 1), PCCD_E_INVAL);
    assert_int_equal(pccd_frame_joints(&frame, hall.joints, 0), PCCD_E_INVAL);
    assert_int_equal(pccd_frame_joints(&frame, hall.joints, 65537), PCCD_E_LIMIT);
    assert_ok(pccd_frame_joints(&frame, hall.joints, 2));
    assert_int_equal(pccd_frame_joints(&frame, hall.joints, 2), PCCD_E_STATE);
    assert_int_equal(pccd_frame_turning(&frame, hall.door, 2, QUAD), PCCD_E_INVAL);
    assert_non_null(strstr(pccd_error_text(hall.client),
                           "): first is 2, its joint; the step has 2 joints, from 0"));
    assert_non_null(strstr(pccd_error_text(hall.client), "motion 0 (object 0x"));
    settings.joints = hall.joints;
    settings.joint_count = 2;
    assert_int_equal(pccd_frame_commit(&frame, &settings, &step), PCCD_E_INVAL);
    assert_non_null(strstr(pccd_error_text(hall.client), "pccd_frame_joints"));
    settings.joints = NULL;
    assert_int_equal(turn(&hall, DEFAULTS, &answer), 0);
    const struct pccd_motion motion = {.object = hall.door, .first = 0, .count = QUAD};
    assert_int_equal(pccd_step(hall.client, hall.scene, &motion, 1, &settings, &answer),
                     PCCD_E_INVAL);
    assert_int_equal(pccd_step(hall.client, hall.scene, &motion, 1, NULL, &answer),
                     PCCD_E_INVAL);
    /* What an answer does not have where bodies turn is refused by name. */
    settings = DEFAULTS;
    settings.mode = PCCD_MODE_PAIRS;
    assert_int_equal(turn(&hall, settings, &answer), PCCD_E_INVAL);
    assert_non_null(strstr(pccd_error_text(hall.client), "mode pairs"));
    settings = DEFAULTS;
    settings.resolution = -1;
    assert_int_equal(turn(&hall, settings, &answer), PCCD_E_INVAL);
    assert_int_equal(turn(&hall, DEFAULTS, &answer), 0);
    pccd_close(hall.client);
}

/* A table with one fault, and the segments that lead to it. */
#define SLOT   65536u
#define FIRST  64u /* where the first table of joints is; the second is behind it */
#define TABLE  (8u + 2 * 136u)
#define SECOND (FIRST + TABLE)

#define TURN                                                                             \
    {                                                                                    \
        1, 0, 1, 1, 1                                                                    \
    }
#define RIGHT                                                                            \
    {                                                                                    \
        1, 3, 1, 1, 3, FIRST, 0                                                          \
    }
#define STRAIGHT                                                                         \
    {                                                                                    \
        1, 0, 1, 0, 3, 0, 4096                                                           \
    }
#define WRONG PCCD_E_SEGMENT

static const struct lie {
    const char *what;
    uint32_t count, zero; /* of the first table */
    struct {
        uint32_t kind, parent;
        double w, axis, to;
    } joint;                          /* its second one */
    struct proto_segment segments[2]; /* of object 1, or none */
    int code;
} lies[] = {
    {"nothing", 2, 0, TURN, {RIGHT}, 0},
    {"no joints", 0, 0, TURN, {{1, 3, 1, 0, 3, FIRST, 0}}, WRONG},
    {"a word that is not 0", 2, 1, TURN, {RIGHT}, WRONG},
    {"too many", 65537, 0, TURN, {RIGHT}, WRONG},
    {"more than the slot has", 482, 0, TURN, {RIGHT}, WRONG},
    {"2^32-1 joints", UINT32_MAX, 0, TURN, {RIGHT}, WRONG},
    {"a table behind the slot", 2, 0, TURN, {{1, 3, 1, 1, 3, SLOT, 0}}, WRONG},
    {"a table in the table", 2, 0, TURN, {{1, 3, 1, 1, 3, 24, 0}}, WRONG},
    {"half a head in the slot", 2, 0, TURN, {{1, 3, 1, 1, 3, SLOT - 4, 0}}, WRONG},
    {"a misaligned table", 2, 0, TURN, {{1, 3, 1, 1, 3, FIRST + 4, 0}}, WRONG},
    {"an offset that overflows", 2, 0, TURN, {{1, 3, 1, 1, 3, UINT64_MAX - 7, 0}}, WRONG},
    {"a second offset", 2, 0, TURN, {{1, 3, 1, 1, 3, FIRST, FIRST}}, WRONG},
    {"floats", 2, 0, TURN, {{1, 3, 0, 1, 3, FIRST, 0}}, WRONG},
    {"a joint that is not there", 2, 0, TURN, {{1, 3, 1, 2, 3, FIRST, 0}}, WRONG},
    {"a joint far away", 2, 0, TURN, {{1, 3, 1, UINT32_MAX, 3, FIRST, 0}}, WRONG},
    {"some of the vertices", 2, 0, TURN, {{1, 3, 1, 1, 2, FIRST, 0}}, WRONG},
    {"more vertices than there are", 2, 0, TURN, {{1, 3, 1, 1, 4, FIRST, 0}}, WRONG},
    {"no vertices", 2, 0, TURN, {{1, 3, 1, 1, 0, FIRST, 0}}, WRONG},
    {"no object", 2, 0, TURN, {{0, 3, 1, 1, 3, FIRST, 0}}, PCCD_E_HANDLE},
    {"an unknown kind of joint", 2, 0, {5, 0, 1, 1, 1}, {RIGHT}, WRONG},
    {"its own parent", 2, 0, {1, 1, 1, 1, 1}, {RIGHT}, WRONG},
    {"a parent after its child",
     2,
     0,
     {1, 2, 1, 1, 1},
     {{1, 3, 1, 0, 3, FIRST, 0}},
     WRONG},
    {"a quaternion of 0", 2, 0, {1, 0, 0, 1, 1}, {RIGHT}, WRONG},
    {"a quaternion that is no number", 2, 0, {1, 0, NAN, 1, 1}, {RIGHT}, WRONG},
    {"an axis of 0", 2, 0, {1, 0, 1, 0, 1}, {RIGHT}, WRONG},
    {"an axis where none belongs", 2, 0, {3, 0, 1, 1, 1}, {RIGHT}, WRONG},
    {"an infinite value", 2, 0, {1, 0, 1, 1, INFINITY}, {RIGHT}, WRONG},
    {"2^20 turns and more", 2, 0, {1, 0, 1, 1, 6588398}, {RIGHT}, WRONG},
    {"a slide beyond 1e18", 2, 0, {2, 0, 1, 1, 9e17}, {RIGHT}, PCCD_E_NOTFINITE},
    {"an object twice", 2, 0, TURN, {RIGHT, {1, 3, 1, 0, 3, FIRST, 0}}, WRONG},
    {"an object that turns and goes straight", 2, 0, TURN, {RIGHT, STRAIGHT}, WRONG},
    {"a table before the last one",
     2,
     0,
     TURN,
     {{1, 3, 1, 1, 3, SECOND, 0}, {2, 3, 1, 1, 3, FIRST, 0}},
     WRONG},
    {"a table within the last one",
     2,
     0,
     TURN,
     {RIGHT, {2, 3, 1, 1, 3, FIRST + 136, 0}},
     WRONG},
    {"two tables", 2, 0, TURN, {RIGHT, {2, 3, 1, 1, 3, SECOND, 0}}, 0},
};

static int submit_lie(struct test_raw *raw, uint32_t scene, const uint32_t objects[2],
                      const struct lie *lie)
{
    struct proto_FRAME_SUBMIT_request request = {.scene = scene, .segments = 1};
    struct proto_FRAME_SUBMIT_result result;
    struct pccd_joint joints[2] = {{.parent = PCCD_NO_JOINT, .rotation = {0, 0, 0, 1}},
                                   {.kind = lie->joint.kind,
                                    .parent = lie->joint.parent,
                                    .rotation = {0, 0, 0, lie->joint.w},
                                    .axis = {lie->joint.axis},
                                    .to = {lie->joint.to}}};
    uint8_t *payload = test_raw_payload(raw, 0);

    joints[0].position[0] = lie->joint.to > 1e17 && lie->joint.to < 1e18 ? 5e17 : 0;
    memset(payload, 0, SLOT);
    for (uint32_t table = FIRST; table <= SECOND; table += TABLE) {
        const struct proto_joints head = {table == FIRST ? lie->count : 2,
                                          table == FIRST ? lie->zero : 0};

        memcpy(payload + table, &head, sizeof head);
        memcpy(payload + table + sizeof head, joints, sizeof joints);
    }
    for (uint32_t i = 0; i < 2; i++) {
        struct proto_segment segment = lie->segments[i];

        segment.object = segment.object == 0 ? 0 : objects[segment.object - 1];
        memcpy(payload + i * sizeof segment, &segment, sizeof segment);
        request.segments = segment.count != 0 && i == 1 ? 2 : request.segments;
    }
    request.seq = test_raw_publish(raw, 0);
    return test_raw_call(raw, PROTO_METHOD_FRAME_SUBMIT, &request, &result);
}

/* If this failed, a table of joints could lead the daemon out of the slot, into a circle,
 * or to numbers that mean nothing. */
CASE(turning__tables_that_lie_are_refused_one_by_one)
{
    const float x[3][3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    struct test_raw raw;
    uint32_t scene, mesh, objects[2];

    assert_ok(test_raw_session(&raw, test_shared.socket, 2, SLOT));
    assert_ok(test_raw_scene(&raw, "", &scene));
    assert_ok(test_raw_mesh(&raw, x, 3, post_face, 1, &mesh));
    assert_ok(test_raw_add(&raw, scene, mesh, &objects[0]));
    assert_ok(test_raw_add(&raw, scene, mesh, &objects[1]));
    for (size_t i = 0; i < sizeof lies / sizeof lies[0]; i++) {
        int status = submit_lie(&raw, scene, objects, &lies[i]);

        if (status != lies[i].code || raw.error.fatal) {
            fail_msg("%s: status %d \"%s\"", lies[i].what, status, raw.error.text);
        }
    }
    assert_int_equal(submit_lie(&raw, scene, objects, &lies[0]), 0);
    test_raw_close(&raw);
}

/* Two scenes of one batch, one object of each, whose tables of joints are at `at`, of
 * `counts` joints as they say, and what becomes of each scene. */
struct parted {
    uint64_t at[2];
    uint32_t counts[2];
    int statuses[2];
};

/* If this failed, a request could make a daemon copy one long table for each of many
 * scenes: more than its slot by as many times. */
CASE(turning__scenes_of_a_batch_share_no_table)
{
    static const struct parted plays[] = {
        {{96, 96 + TABLE}, {2, 2}, {0, 0}},
        {{96, 96}, {2, 2}, {PCCD_E_SEGMENT, 0}},
        {{96 + TABLE, 96}, {2, 2}, {PCCD_E_SEGMENT, 0}},
        {{96, 96 + TABLE}, {3, 2}, {PCCD_E_SEGMENT, 0}},
        {{96, 8}, {2, 2}, {0, PCCD_E_SEGMENT}}, /* is none, in the table of segments */
        {{96, SLOT - TABLE}, {479, 2}, {0, 0}},
    };
    const struct pccd_joint joint = {.parent = PCCD_NO_JOINT, .rotation = {0, 0, 0, 1}};
    const float x[3][3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    uint32_t scene, mesh, object;
    struct proto_batch_scene scenes[2];
    struct proto_segment segments[2];
    struct test_raw raw;

    assert_ok(test_raw_session(&raw, test_shared.socket, 2, SLOT));
    assert_ok(test_raw_mesh(&raw, x, 3, post_face, 1, &mesh));
    for (int i = 0; i < 2; i++) {
        assert_ok(test_raw_scene(&raw, "", &scene));
        assert_ok(test_raw_add(&raw, scene, mesh, &object));
        scenes[i] = (struct proto_batch_scene){scene, 1};
        segments[i] = (struct proto_segment){.object = object,
                                             .kind = PROTO_SEGMENT_TURNING,
                                             .format = PCCD_FORMAT_F64,
                                             .first = 1,
                                             .count = 3};
    }
    for (size_t n = 0; n < sizeof plays / sizeof plays[0]; n++) {
        const struct parted *play = &plays[n];
        uint8_t *payload = test_raw_payload(&raw, 0);
        struct proto_BATCH_SUBMIT_result result;
        struct pccd_scene_answer answers[2];

        for (uint64_t at = 96 + 8; at + sizeof joint <= SLOT; at += sizeof joint) {
            memcpy(payload + at, &joint, sizeof joint);
        }
        for (int i = 0; i < 2; i++) {
            const struct proto_joints head = {play->counts[i], 0};
            uint64_t at = play->at[i];

            segments[i].offset0 = at;
            memcpy(payload + at, &head, sizeof head);
            at += sizeof head;
            for (uint32_t k = 0; i == 1 && at > 96 && k < head.count; k++) {
                memcpy(payload + at + k * sizeof joint, &joint, sizeof joint);
            }
        }
        memcpy(payload, scenes, sizeof scenes);
        memcpy(payload + sizeof scenes, segments, sizeof segments);
        int status =
            RAW_CALL(&raw, BATCH_SUBMIT, &result, .seq = test_raw_publish(&raw, 0),
                     .scenes = 2, .segments = 2);
        if (status != 0) {
            fail_msg("play %zu: status %d \"%s\"", n, status, raw.error.text);
        }
        memcpy(answers, (const uint8_t *)raw.result.base + result.offset, sizeof answers);
        for (int i = 0; i < 2; i++) {
            if (answers[i].status != play->statuses[i]) {
                fail_msg("play %zu, scene %d: status %d \"%s\"", n, i, answers[i].status,
                         answers[i].why);
            }
        }
    }
    test_raw_close(&raw);
}

CASES_WITH(test_recording_start, test_recording_stop);

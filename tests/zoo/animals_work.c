/* animals_work.c - hostile clients: what is asked to be computed. */
#include <math.h>
#include <signal.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

#include "animals.h"
#include "crossing.h"
#include "daemon.h"
#include "joints.h"
#include "oracle_turning.h"

#define SLOT_BYTES  65536u
#define LARGE_BYTES (4u << 20)
#define IN_FLIGHT   32
#define SCENES_MAX  64   /* keeper.c asks for no more of a client */
#define SCENES      1000 /* of an act: a hundred acts are the hundred thousand */

static struct test_raw raw;

/* Keeps as many steps in flight as there may be, and more: right answers, and E_BUSY for
 * what is too many. */
bool zoo_submits_without_end(struct zoo_cage *cage)
{
    struct test_raw_crossing scene;

    EXPECT(cage, zoo_enter(cage, &raw, SLOT_BYTES));
    EXPECT(cage, test_raw_build(&raw, "", test_triangle_x, &scene) == 0);
    for (int round = 0; round < 20; round++) {
        int served = 0;

        for (int i = 0; i < IN_FLIGHT; i++) {
            EXPECT(cage, RAW_SEND(&raw, FRAME_SUBMIT, .scene = scene.scene) != 0);
        }
        for (int i = 0; i < IN_FLIGHT; i++) {
            EXPECT(cage, test_raw_receive(&raw) == 0);
            EXPECT(cage, !raw.envelope.failed || raw.envelope.error.code == PCCD_E_BUSY);
            served += !raw.envelope.failed;
        }
        EXPECT(cage, served >= 2); /* it has two slots */
    }
    test_raw_close(&raw);
    return true;
}

/* Cancels whatever it has begun, and what it has not: every request is answered once,
 * cancelled or not, and the next step is right. */
bool zoo_cancels_everything(struct zoo_cage *cage)
{
    struct test_raw_crossing scene;
    struct proto_FRAME_SUBMIT_request submit;
    struct proto_FRAME_SUBMIT_result answer;

    EXPECT(cage, zoo_enter(cage, &raw, SLOT_BYTES));
    EXPECT(cage, test_raw_build(&raw, "", test_triangle_x, &scene) == 0);
    for (int round = 0; round < 30; round++) {
        uint32_t first = 0;
        uint32_t seen = 0;

        for (uint32_t i = 0; i < 2; i++) {
            submit = test_raw_turn(&raw, i, &scene, i == 0 ? -1 : 1);
            uint32_t id = test_raw_request(&raw, PROTO_METHOD_FRAME_SUBMIT, &submit);
            first = i == 0 ? id : first;
            EXPECT(cage, RAW_SEND(&raw, CANCEL, .id = id) != 0);
            EXPECT(cage, RAW_SEND(&raw, CANCEL, .id = id + 77) != 0); /* there is none */
        }
        for (int i = 0; i < 6; i++) {
            EXPECT(cage, test_raw_receive(&raw) == 0 && !raw.envelope.failed);
            EXPECT(cage, raw.envelope.id - first < 6);
            EXPECT(cage, (seen >> (raw.envelope.id - first) & 1u) == 0);
            seen |= 1u << (raw.envelope.id - first);
        }
        /* Cancelled or not, the triangle is above the floor again. */
        for (uint32_t i = 0; i < 2; i++) {
            submit = test_raw_turn(&raw, 0, &scene, i == 0 ? -1 : 1);
            EXPECT(cage,
                   test_raw_call(&raw, PROTO_METHOD_FRAME_SUBMIT, &submit, &answer) == 0);
            EXPECT(cage, answer.incomplete == PCCD_COMPLETE && answer.vf == 3);
        }
    }
    test_raw_close(&raw);
    return true;
}

/* Makes scenes as fast as it can, and drops some of them: 64 are its own, more are
 * E_LIMIT, or E_BUSY while those it dropped are being freed. */
bool zoo_makes_tiny_scenes(struct zoo_cage *cage)
{
    uint32_t mesh = 0;
    uint32_t made = 0;
    uint32_t refused = 0;

    EXPECT(cage, zoo_enter(cage, &raw, SLOT_BYTES));
    EXPECT(cage, test_raw_mesh(&raw, test_triangle_x, 3, test_triangle, 1, &mesh) == 0);
    for (uint32_t i = 0; i < SCENES; i++) {
        uint32_t scene, object;
        int status = test_raw_scene(&raw, "", &scene);

        EXPECT(cage, status == 0 || status == PCCD_E_LIMIT || status == PCCD_E_BUSY);
        if (status != 0) {
            refused++;
            continue;
        }
        made++;
        EXPECT(cage, test_raw_add(&raw, scene, mesh, &object) == 0);
        EXPECT(cage,
               i % 16 == 0 || RAW_CALL(&raw, SCENE_DESTROY, NULL, .scene = scene) == 0);
    }
    EXPECT(cage, made >= SCENES_MAX && made + refused == SCENES);
    test_raw_close(&raw);
    return true;
}

/* In a child: submit a large upload and die, at another moment each time. */
static void die_copying(struct zoo_cage *cage, unsigned delay_us)
{
    struct proto_MESH_CREATE_result created;

    if (!zoo_enter(cage, &raw, LARGE_BYTES) ||
        RAW_CALL(&raw, MESH_CREATE, &created, .vertex_count = LARGE_BYTES / 12,
                 .triangle_count = 1) != 0 ||
        RAW_SEND(&raw, MESH_DATA, .mesh = created.mesh, .count = LARGE_BYTES / 12,
                 .seq = test_raw_publish(&raw, 0)) == 0) {
        _exit(1);
    }
    (void)usleep(delay_us);
    (void)kill(getpid(), SIGKILL);
}

/* Is killed while the daemon copies from its slot: the daemon finishes, and drops what it
 * had; the keeper sees that nothing stays. */
bool zoo_dies_in_the_middle(struct zoo_cage *cage)
{
    unsigned delay_us = 97 * atomic_load(&cage->acts) % 1500;
    int status = 0;
    pid_t child = fork();

    EXPECT(cage, child >= 0);
    if (child == 0) {
        test_end_with_parent();
        die_copying(cage, delay_us);
    }
    EXPECT(cage, waitpid(child, &status, 0) == child);
    EXPECT(cage, WIFSIGNALED(status) && WTERMSIG(status) == SIGKILL);
    return true;
}

/* In a child: let the animal go on after a while. */
static void wake(pid_t animal, unsigned pause_ms)
{
    test_sleep_ms(pause_ms);
    (void)kill(animal, SIGCONT);
    _exit(0);
}

/* Submits and stops, as a process under a debugger does: nothing of it is lost, and it
 * gets its right answers when it goes on. */
bool zoo_stops_itself(struct zoo_cage *cage)
{
    struct test_raw_crossing scene;
    struct proto_FRAME_SUBMIT_request submit;
    struct proto_FRAME_SUBMIT_result answer;
    uint32_t ids[2];
    pid_t animal = getpid();
    pid_t child;

    EXPECT(cage, zoo_enter(cage, &raw, SLOT_BYTES));
    EXPECT(cage, test_raw_build(&raw, "", test_triangle_x, &scene) == 0);
    for (uint32_t i = 0; i < 2; i++) {
        submit = test_raw_turn(&raw, i, &scene, i == 0 ? -1 : 1);
        ids[i] = test_raw_request(&raw, PROTO_METHOD_FRAME_SUBMIT, &submit);
        EXPECT(cage, ids[i] != 0);
    }
    child = fork();
    EXPECT(cage, child >= 0);
    if (child == 0) {
        wake(animal, cage->pause_ms);
    }
    (void)kill(animal, SIGSTOP);
    EXPECT(cage, waitpid(child, NULL, 0) == child);
    for (int i = 0; i < 2; i++) {
        EXPECT(cage,
               test_raw_answer(&raw, ids[i], PROTO_METHOD_FRAME_SUBMIT, &answer) == 0);
        EXPECT(cage, answer.incomplete == PCCD_COMPLETE && answer.vf == 3);
    }
    test_raw_close(&raw);
    return true;
}

#define CHAIN       64u
#define HURRIED_MAX 400000.0 /* an angle */
#define PATIENCE_MS 120000

/* A triangle above a floor, on a chain of turns about one axis; each by `angle`. */
static const struct turn {
    uint32_t joints;
    double position[3]; /* of the first one */
    double axis[3];
    double angle;
    uint32_t met, possible; /* vertices that come to the floor for certain; that may */
} turns[] = {
    {1, {0, 0, 0}, {0, 0, 1}, COMMON_ANGLE_MAX, 0, 0}, /* level, at height 1 */
    {1, {0, 0, -0.9375}, {0, 0, 1}, -COMMON_ANGLE_MAX, 0, 0},
    {CHAIN, {0, 0, 0}, {1, 0, 0}, -2.0 / CHAIN, 3, 0}, /* at pi / 4 and pi / 2 */
    {CHAIN, {0, 0, 0}, {1, 0, 0}, -0.75 / CHAIN, 0, 0},
    {2, {0, 0, -1}, {0, 0, 3}, 1, 0, 3}, /* in the floor, and slides on it all the time */
};

/* Say what the oracle knows of one vertex of the triangle and the floor. */
static struct oracle_turning_answer judge(const struct pccd_joint *joints, uint32_t count,
                                          uint32_t vertex)
{
    const struct oracle_turning_asked asked = {0, 1, 1e-9, 10000, 1000};
    struct oracle_turning_answer answer;
    double point[1][3], floor[3][3];

    for (int k = 0; k < 3; k++) {
        point[0][k] = (double)test_triangle_x[vertex][k];
        for (int i = 0; i < 3; i++) {
            floor[i][k] = (double)test_floor_x[i][k];
        }
    }
    const struct oracle_turning pair = {
        .joints = joints,
        .side = {
            {1, count - 1, {(const double(*)[3])point, (const double(*)[3])point}},
            {3, PCCD_NO_JOINT, {(const double(*)[3])floor, (const double(*)[3])floor}}}};
    oracle_turning_find(&pair, &asked, &answer);
    return answer;
}

/* Turns a million times, fewer where time is short; on a chain of 64 joints; and so that
 * a floor is touched throughout: each vertex has the record that the oracle says, or
 * none. */
bool zoo_turns_about(struct zoo_cage *cage)
{
    struct test_raw_crossing scene;

    if (cage->patient) { /* 2^20 turns take seconds, beside others more */
        test_raw_wait_ms = PATIENCE_MS;
    }
    EXPECT(cage, zoo_enter(cage, &raw, SLOT_BYTES));
    EXPECT(cage, test_raw_build(&raw, "", test_triangle_x, &scene) == 0);
    for (size_t n = 0; n < sizeof turns / sizeof turns[0]; n++) {
        const struct turn *turn = &turns[n];
        const struct proto_joints head = {.count = turn->joints};
        const struct proto_segment segment = {.object = scene.object,
                                              .kind = PROTO_SEGMENT_TURNING,
                                              .format = PCCD_FORMAT_F64,
                                              .first = turn->joints - 1,
                                              .count = 3,
                                              .offset0 = sizeof segment};
        struct pccd_joint joints[CHAIN];
        struct proto_FRAME_SUBMIT_request submit = {.scene = scene.scene, .segments = 1};
        struct proto_FRAME_SUBMIT_result answer;
        uint8_t *payload = test_raw_payload(&raw, 0);
        uint32_t met = 0, possible = 0;

        memset(joints, 0, sizeof joints);
        for (uint32_t i = 0; i < turn->joints; i++) {
            joints[i].kind = PCCD_JOINT_TURN;
            joints[i].parent = i - 1; /* of the first: none */
            joints[i].rotation[3] = 1;
            memcpy(joints[i].axis, turn->axis, sizeof turn->axis);
            joints[i].to[0] = turn->angle;
            if (!cage->patient && fabs(turn->angle) > HURRIED_MAX) {
                joints[i].to[0] = HURRIED_MAX;
            }
        }
        memcpy(joints[0].position, turn->position, sizeof turn->position);
        memcpy(payload, &segment, sizeof segment);
        memcpy(payload + sizeof segment, &head, sizeof head);
        memcpy(payload + sizeof segment + sizeof head, joints,
               turn->joints * sizeof joints[0]);
        submit.seq = test_raw_publish(&raw, 0);
        EXPECT(cage,
               test_raw_call(&raw, PROTO_METHOD_FRAME_SUBMIT, &submit, &answer) == 0);
        EXPECT(cage, answer.incomplete == PCCD_COMPLETE && answer.count == answer.vf);
        for (uint64_t i = 0; i < answer.count; i++) {
            struct pccd_contact contact;

            memcpy(&contact,
                   (const uint8_t *)raw.result.base + answer.offset + i * sizeof contact,
                   sizeof contact);
            bool is_proved = (contact.flags & PCCD_PROVED) != 0;
            const struct oracle_turning_answer truth =
                judge(joints, turn->joints, contact.feature_a);
            EXPECT(cage, contact.object_a == scene.object && !truth.is_free);
            EXPECT(cage, truth.met_by >= contact.toi);
            EXPECT(cage, !is_proved || truth.free_until <= contact.toi_hi);
            met += is_proved;
            possible += !is_proved;
        }
        EXPECT(cage, met == turn->met && possible == turn->possible);
        for (uint32_t i = 0; i < 3 && met + possible == 0; i++) {
            EXPECT(cage, judge(joints, turn->joints, i).is_free);
        }
    }
    test_raw_close(&raw);
    return true;
}

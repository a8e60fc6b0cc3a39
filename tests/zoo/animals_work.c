/* animals_work.c - hostile clients: what is asked to be computed. */
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include "animals.h"
#include "crossing.h"
#include "daemon.h"

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
    struct zoo_scene scene;
    struct proto_FRAME_SUBMIT_request submit = {0};

    EXPECT(cage, zoo_enter(cage, &raw, SLOT_BYTES));
    EXPECT(cage, zoo_build(cage, &raw, &scene));
    submit.scene = scene.scene;
    for (int round = 0; round < 20; round++) {
        int served = 0;

        for (int i = 0; i < IN_FLIGHT; i++) {
            EXPECT(cage, test_raw_request(&raw, PROTO_METHOD_FRAME_SUBMIT, &submit) != 0);
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
    struct zoo_scene scene;
    struct proto_FRAME_SUBMIT_request submit;
    struct proto_FRAME_SUBMIT_result answer;

    EXPECT(cage, zoo_enter(cage, &raw, SLOT_BYTES));
    EXPECT(cage, zoo_build(cage, &raw, &scene));
    for (int round = 0; round < 30; round++) {
        uint32_t first = 0;
        uint32_t seen = 0;

        for (uint32_t i = 0; i < 2; i++) {
            struct proto_CANCEL_request cancel = {0};

            submit = zoo_write(&raw, &scene, i, i == 0 ? -1 : 1);
            cancel.id = test_raw_request(&raw, PROTO_METHOD_FRAME_SUBMIT, &submit);
            first = i == 0 ? cancel.id : first;
            EXPECT(cage, test_raw_request(&raw, PROTO_METHOD_CANCEL, &cancel) != 0);
            cancel.id += 77; /* nothing of that number */
            EXPECT(cage, test_raw_request(&raw, PROTO_METHOD_CANCEL, &cancel) != 0);
        }
        for (int i = 0; i < 6; i++) {
            EXPECT(cage, test_raw_receive(&raw) == 0 && !raw.envelope.failed);
            EXPECT(cage, raw.envelope.id - first < 6);
            EXPECT(cage, (seen >> (raw.envelope.id - first) & 1u) == 0);
            seen |= 1u << (raw.envelope.id - first);
        }
        /* Cancelled or not, the triangle is above the floor again. */
        for (uint32_t i = 0; i < 2; i++) {
            submit = zoo_write(&raw, &scene, 0, i == 0 ? -1 : 1);
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
    struct proto_SCENE_CREATE_request create = {.want = 0};
    struct proto_SCENE_CREATE_result created;
    struct proto_SCENE_ADD_request add = {0};
    uint32_t made = 0;
    uint32_t refused = 0;

    EXPECT(cage, zoo_enter(cage, &raw, SLOT_BYTES));
    EXPECT(cage,
           test_raw_mesh(&raw, test_triangle_x, 3, test_triangle, 1, &add.mesh) == 0);
    for (uint32_t i = 0; i < SCENES; i++) {
        struct proto_SCENE_DESTROY_request destroy = {0};
        int status = test_raw_call(&raw, PROTO_METHOD_SCENE_CREATE, &create, &created);

        EXPECT(cage, status == 0 || status == PCCD_E_LIMIT || status == PCCD_E_BUSY);
        if (status != 0) {
            refused++;
            continue;
        }
        made++;
        add.scene = destroy.scene = created.scene;
        EXPECT(cage, test_raw_call(&raw, PROTO_METHOD_SCENE_ADD, &add, NULL) == 0);
        EXPECT(cage, i % 16 == 0 || test_raw_call(&raw, PROTO_METHOD_SCENE_DESTROY,
                                                  &destroy, NULL) == 0);
    }
    EXPECT(cage, made >= SCENES_MAX && made + refused == SCENES);
    test_raw_close(&raw);
    return true;
}

/* In a child: submit a large upload and die, at another moment each time. */
static void die_copying(struct zoo_cage *cage, unsigned delay_us)
{
    struct proto_MESH_CREATE_request create = {.vertex_count = LARGE_BYTES / 12,
                                               .triangle_count = 1};
    struct proto_MESH_CREATE_result created;
    struct proto_MESH_DATA_request data = {.count = LARGE_BYTES / 12};

    if (!zoo_enter(cage, &raw, LARGE_BYTES) ||
        test_raw_call(&raw, PROTO_METHOD_MESH_CREATE, &create, &created) != 0) {
        _exit(1);
    }
    data.mesh = created.mesh;
    data.seq = test_raw_publish(&raw, 0);
    if (test_raw_request(&raw, PROTO_METHOD_MESH_DATA, &data) == 0) {
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
    struct zoo_scene scene;
    struct proto_FRAME_SUBMIT_request submit;
    struct proto_FRAME_SUBMIT_result answer;
    uint32_t ids[2];
    pid_t animal = getpid();
    pid_t child;

    EXPECT(cage, zoo_enter(cage, &raw, SLOT_BYTES));
    EXPECT(cage, zoo_build(cage, &raw, &scene));
    for (uint32_t i = 0; i < 2; i++) {
        submit = zoo_write(&raw, &scene, i, i == 0 ? -1 : 1);
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

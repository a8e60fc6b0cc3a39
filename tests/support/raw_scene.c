/* raw_scene.c - the smallest scene of a peer that does without the library. */
#include <stdio.h>
#include <string.h>

#include "crossing.h"
#include "raw.h"

int test_raw_scene(struct test_raw *raw, const char *name, uint32_t *scene)
{
    struct proto_SCENE_CREATE_request request = {
        .share = name[0] != '\0' ? PCCD_SHARE_OPEN : 0};
    struct proto_SCENE_CREATE_result created = {.scene = 0};

    (void)snprintf(request.name, sizeof request.name, "%s", name);
    int status = test_raw_call(raw, PROTO_METHOD_SCENE_CREATE, &request, &created);
    *scene = created.scene;
    return status;
}

int test_raw_add(struct test_raw *raw, uint32_t scene, uint32_t mesh, uint32_t *object)
{
    struct proto_SCENE_ADD_result added = {.object = 0};
    int status = RAW_CALL(raw, SCENE_ADD, &added, .scene = scene, .mesh = mesh);

    *object = added.object;
    return status;
}

int test_raw_build(struct test_raw *raw, const char *name, const float x[3][3],
                   struct test_raw_crossing *crossing)
{
    struct test_raw_crossing *c = crossing;
    int status = test_raw_scene(raw, name, &c->scene);

    status = status != 0
                 ? status
                 : test_raw_mesh(raw, test_floor_x, 3, test_triangle, 1, &c->floor_mesh);
    status = status != 0 ? status : test_raw_mesh(raw, x, 3, test_triangle, 1, &c->mesh);
    status = status != 0 ? status : test_raw_add(raw, c->scene, c->floor_mesh, &c->floor);
    return status != 0 ? status : test_raw_add(raw, c->scene, c->mesh, &c->object);
}

struct proto_FRAME_SUBMIT_request test_raw_move(const struct test_raw *raw, uint32_t slot,
                                                uint32_t scene, uint32_t object,
                                                const float (*x)[3], uint32_t count)
{
    const struct proto_segment segment = {.object = object,
                                          .kind = PROTO_SEGMENT_X1,
                                          .format = PCCD_FORMAT_F32,
                                          .count = count,
                                          .offset1 = sizeof segment};
    uint8_t *payload = test_raw_payload(raw, slot);

    memcpy(payload, &segment, sizeof segment);
    memcpy(payload + sizeof segment, x, count * sizeof *x);
    return (struct proto_FRAME_SUBMIT_request){
        .scene = scene, .slot = slot, .seq = test_raw_publish(raw, slot), .segments = 1};
}

struct proto_FRAME_SUBMIT_request test_raw_turn(const struct test_raw *raw, uint32_t slot,
                                                const struct test_raw_crossing *crossing,
                                                float z)
{
    float x[3][3];

    test_crossing_positions(x, z);
    return test_raw_move(raw, slot, crossing->scene, crossing->object,
                         (const float(*)[3])x, 3);
}

void test_raw_release(const struct test_raw *raw, uint64_t release)
{
    atomic_store(&test_raw_upload(raw)->result_head.value, release);
}

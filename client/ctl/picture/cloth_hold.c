/* cloth_hold.c - a cloth that passes through nothing. */
#include "cloth_scene.h"

#include <stdlib.h>
#include <string.h>

#define RIGID_BYTES (2 * 12 * sizeof(double)) /* payload of a rigid segment */
#define PUSHES      12u /* times that contacts of a frame are pushed apart */
#define TRIES       24u /* then it ends before them; and at last nothing moves at all */
#define CUT         0.9 /* of the time until the first contact */

static int fail(const struct cloth_hold *hold, int status, const char *what,
                struct ctl_error *error)
{
    const char *text = pccd_error_text(hold->client);
    return ctl_error_set(error, status, "%s: %s", what,
                         text[0] != '\0' ? text : pccd_status_text(status));
}

/* ---- registration ------------------------------------------------------------------ */

static int add_object(struct cloth_hold *hold, uint32_t index, const float (*start)[3],
                      struct ctl_error *error)
{
    struct cloth_object *object = &hold->objects[index];
    struct pccd_mesh_info info;
    uint32_t mesh;
    int status =
        pccd_mesh_create(hold->client, start, PCCD_FORMAT_F32, object->vertex_count,
                         object->triangles, object->triangle_count, &mesh, &info);
    if (status != PCCD_OK) {
        return fail(hold, status, "a mesh was not accepted", error);
    }
    object->edges = malloc(info.edge_count * sizeof *object->edges);
    if (object->edges == NULL) {
        return ctl_error_set(error, PCCD_E_NOMEM, "no memory for the edges");
    }
    status = pccd_mesh_edges(hold->client, mesh, object->edges, info.edge_count);
    if (status == PCCD_OK) {
        status = pccd_scene_add(hold->client, hold->scene, mesh, &object->object);
    }
    return status == PCCD_OK ? PCCD_OK
                             : fail(hold, status, "a mesh was not placed", error);
}

int cloth_hold_init(struct cloth_hold *hold, struct pccd_client *client,
                    struct ctl_error *error)
{
    *hold = (struct cloth_hold){.client = client};
    int status = cloth_scene_new(&hold->cloth, error);
    if (status != PCCD_OK) {
        return status;
    }
    const struct cloth_scene *cloth = hold->cloth;
    hold->objects[0] =
        (struct cloth_object){.vertex_count = CLOTH_VERTICES,
                              .triangle_count = CLOTH_TRIANGLES,
                              .triangles = (const uint32_t(*)[3])cloth->cloth_triangles};
    hold->objects[1] =
        (struct cloth_object){.vertex_count = CLOTH_BALL_VERTICES,
                              .triangle_count = CLOTH_BALL_TRIANGLES,
                              .triangles = (const uint32_t(*)[3])cloth->ball_triangles};
    status = pccd_scene_create(client, NULL, &hold->scene);
    if (status != PCCD_OK) {
        return fail(hold, status, "no scene", error);
    }
    status = add_object(hold, 0, (const float(*)[3])cloth->cloth_start, error);
    return status != PCCD_OK
               ? status
               : add_object(hold, 1, (const float(*)[3])cloth->ball_start, error);
}

void cloth_hold_deinit(struct cloth_hold *hold)
{
    cloth_scene_free(hold->cloth);
    free(hold->objects[0].edges);
    free(hold->objects[1].edges);
    *hold = (struct cloth_hold){.client = NULL};
}

/* ---- a frame ----------------------------------------------------------------------- */

/* Ask what is met on the way from the one end of the frame to the other. */
static int ask(struct cloth_hold *hold, struct pccd_answer *answer,
               struct ctl_error *error)
{
    const uint64_t bytes = 2 * sizeof(float[CLOTH_VERTICES][3]) + RIGID_BYTES;
    struct pccd_step_settings settings = {
        .struct_bytes = sizeof(struct pccd_step_settings), .threads = hold->threads};
    struct pccd_frame frame;
    double pose0[12], pose1[12];
    void *x0, *x1;
    uint64_t step;
    cloth_scene_ball_pose(hold->cloth, 0, pose0);
    cloth_scene_ball_pose(hold->cloth, 1, pose1);
    int status = pccd_frame_begin(hold->client, hold->scene, 2, bytes, &frame);
    if (status != PCCD_OK) {
        return fail(hold, status, "no slot for a step", error);
    }
    status = pccd_frame_x0x1(&frame, hold->objects[0].object, PCCD_FORMAT_F32, 0,
                             CLOTH_VERTICES, &x0, &x1);
    if (status == PCCD_OK) {
        status = pccd_frame_rigid(&frame, hold->objects[1].object, 0, CLOTH_BALL_VERTICES,
                                  pose0, pose1);
    }
    if (status != PCCD_OK) {
        pccd_frame_abort(&frame);
        return fail(hold, status, "a step could not be written", error);
    }
    cloth_scene_positions(hold->cloth, 0, x0);
    cloth_scene_positions(hold->cloth, 1, x1);
    status = pccd_frame_commit(&frame, &settings, &step);
    if (status == PCCD_OK) {
        status = pccd_wait(hold->client, step, -1, answer);
    }
    return status == PCCD_OK ? PCCD_OK : fail(hold, status, "a step failed", error);
}

/* The vertices of a feature; false for one that is not in the scene. */
static bool name_feature(const struct cloth_hold *hold, uint32_t handle, uint32_t feature,
                         uint32_t size, bool *is_cloth, uint32_t vertices[3])
{
    *is_cloth = handle == hold->objects[0].object;
    const struct cloth_object *object = &hold->objects[*is_cloth ? 0 : 1];
    if (size == 1) {
        vertices[0] = feature;
        return feature < object->vertex_count;
    }
    if (size == 2) {
        vertices[0] = object->edges[feature].a;
        vertices[1] = object->edges[feature].b;
        return true;
    }
    memcpy(vertices, object->triangles[feature], 3 * sizeof *vertices);
    return true;
}

static void push(struct cloth_hold *hold, const struct pccd_contact *record)
{
    if (record->kind != PCCD_VF && record->kind != PCCD_EE) {
        return; /* what these two leave apart touches nowhere */
    }
    bool is_vf = record->kind == PCCD_VF;
    struct cloth_contact contact = {.is_vf = is_vf};
    uint32_t a[3] = {0, 0, 0};
    for (uint32_t k = 0; k < 3; k++) {
        contact.normal[k] = (double)record->normal[k];
        contact.param[k % 2] = (double)record->param[k % 2];
    }
    if (name_feature(hold, record->object_a, record->feature_a, is_vf ? 1 : 2,
                     &contact.a_is_cloth, a) &&
        name_feature(hold, record->object_b, record->feature_b, is_vf ? 3 : 2,
                     &contact.b_is_cloth, contact.b)) {
        memcpy(contact.a, a, sizeof contact.a);
        cloth_scene_push(hold->cloth, &contact);
    }
}

int cloth_hold_frame(struct cloth_hold *hold, cloth_hold_fn tell, void *context,
                     struct ctl_error *error)
{
    bool is_free = false;
    cloth_scene_predict(hold->cloth);
    for (uint32_t i = 0; !is_free; i++) {
        struct pccd_answer answer = PCCD_ANSWER_INIT;
        int status = ask(hold, &answer, error);
        if (status != PCCD_OK) {
            return status;
        }
        is_free = answer.total == 0 && answer.incomplete == PCCD_COMPLETE;
        for (uint64_t k = 0; i < PUSHES && k < answer.count; k++) {
            push(hold, &answer.contacts[k]);
        }
        if (!is_free && i >= PUSHES) {
            hold->cut += i == PUSHES;
            cloth_scene_shorten(hold->cloth, i < TRIES ? CUT * answer.toi_first : 0.0);
        }
        tell(context, &answer, is_free);
        pccd_answer_release(hold->client, &answer);
        if (!is_free && i > TRIES) { /* the way that does not move was not free */
            return ctl_error_set(error, PCCD_E_INTERNAL,
                                 "what does not move is said to meet something");
        }
    }
    cloth_scene_take(hold->cloth);
    return PCCD_OK;
}

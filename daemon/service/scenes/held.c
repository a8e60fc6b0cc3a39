/* held.c - frames that wait for the next step of their scene. */
#include "held.h"

#include <stdlib.h>

#include "invariant.h"
#include "service.h"
#include "session.h"
#include "staging.h"

int srv_held_frame_charge(struct srv_member *member, uint64_t bytes,
                          struct proto_error *error)
{
    srv_assert_loop();
    PCCD_ASSERT(!member->holds);
    int status =
        srv_quota_charge(member->session->owner.user, SRV_QUOTA_SHM_BYTES, bytes, error);
    member->holds = status == 0;
    return status;
}

void srv_held_frame_refund(struct srv_member *member, uint64_t bytes)
{
    srv_assert_loop();
    srv_quota_refund(member->session->owner.user, SRV_QUOTA_SHM_BYTES, bytes);
    member->holds = false;
}

/* Stage it in the staging that is open. */
static int stage(const struct srv_held_frame *held, struct srv_scene *scene,
                 struct proto_error *error)
{
    struct srv_staging staging = {
        .scene = scene,
        .member = held->member,
        .slot = SRV_SLOT_OF(&held->submit),
        .payload = held->copy,
        .payload_bytes = held->bytes,
        .table =
            srv_workspace_of_thread(held->member->session->service->workspaces)->segments,
        .error = error};
    return srv_stage(&staging);
}

/* Try whether the scene takes it as it is now; nothing moves. */
static int try(struct srv_held_frame *held, struct srv_scene *scene,
               struct proto_error *error)
{
    struct eng_scene *engine = NULL;
    int status = srv_scene_engine(scene, &engine);
    if (status != 0) {
        return proto_error_set(error, status, "no memory for the scene");
    }
    eng_stage_validate(engine);
    srv_sent_end(&scene->sent); /* it has not come to its step */
    status = stage(held, scene, error);
    if (status == 0 && eng_stage_overlaps(engine)) {
        status =
            srv_stage_explain_twice(scene, &(struct srv_staging){.scene = scene}, error);
    }
    eng_stage_abort(engine);
    held->changes = scene->changes;
    return status;
}

int srv_held_frame_add(struct srv_held_frame *held, struct srv_scene *scene,
                       struct proto_error *error)
{
    srv_assert_compute();
    int status = try(held, scene, error);
    if (status != 0) {
        return status;
    }
    struct srv_held_frame **end = &scene->held;
    while (*end != NULL) {
        end = &(*end)->next;
    }
    *end = held;
    return 0;
}

/* Move the entry at *at to *taken. */
static void take(struct srv_held_frame **at, struct srv_held_frame **taken)
{
    struct srv_held_frame *held = *at;
    *at = held->next;
    held->next = *taken;
    *taken = held;
}

void srv_held_frame_check(struct srv_scene *scene, struct srv_held_frame **taken)
{
    srv_assert_compute();
    for (struct srv_held_frame **at = &scene->held; *at != NULL;) {
        struct srv_held_frame *held = *at;
        if (held->changes != scene->changes && try(held, scene, &held->error) != 0) {
            take(at, taken);
        } else {
            at = &held->next;
        }
    }
}

int srv_held_frame_stage(struct srv_scene *scene, struct proto_error *error)
{
    srv_assert_compute();
    int status = 0;
    for (const struct srv_held_frame *held = scene->held; held != NULL && status == 0;
         held = held->next) {
        status = stage(held, scene, error);
    }
    return status;
}

void srv_held_frame_take(struct srv_scene *scene, struct srv_held_frame **taken)
{
    srv_assert_compute();
    while (scene->held != NULL) {
        take(&scene->held, taken);
    }
}

struct srv_held_frame *srv_held_frame_remove(struct srv_scene *scene,
                                             const struct srv_member *member)
{
    srv_assert_compute();
    struct srv_held_frame *removed = NULL;
    for (struct srv_held_frame **at = &scene->held; *at != NULL;) {
        if ((*at)->member == member) {
            take(at, &removed);
        } else {
            at = &(*at)->next;
        }
    }
    return removed;
}

void srv_held_frame_free(struct srv_held_frame *list)
{
    srv_assert_loop();
    while (list != NULL) {
        struct srv_held_frame *next = list->next;
        if (list->request != NULL) { /* its session leaves the scene */
            list->left(list->request);
        }
        srv_held_frame_refund(list->member, list->charge);
        free(list->copy);
        free(list);
        list = next;
    }
}

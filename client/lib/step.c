/* step.c - a verb is asked of scenes: steps, and what is near. */
#include "step.h"

#include <assert.h>
#include <string.h>

#include "attach.h"
#include "connection.h"
#include "recorder.h"
#include "rpc.h"

/* ---- messages ---------------------------------------------------------------------- */

/* A text in the place of a string of a message. */
static int put_tuning(struct pccd_client *client, const char *tuning, char *to)
{
    size_t bytes = strnlen(tuning, PCCD_TUNING_BYTES);

    if (bytes == PCCD_TUNING_BYTES) {
        return cli_fail(client, PCCD_E_INVAL, "tuning: longer than %d bytes",
                        PCCD_TUNING_BYTES - 1);
    }
    memcpy(to, tuning, bytes);
    return 0;
}

/* The settings that a step and a batch of steps are asked with. */
#define STEP_MESSAGE(settings)                                                           \
    .mode = (uint32_t)(settings).mode, .method = (uint32_t)(settings).method,            \
    .threads = (settings).threads, .tolerance = (settings).tolerance,                    \
    .deadline_ns = (settings).deadline_ns, .separation = (settings).separation,          \
    .approach = (settings).approach, .touching = (uint32_t)(settings).touching,          \
    .resolution = (settings).resolution

/* Read settings of a step; NULL: the defaults. */
static int read_settings(struct pccd_client *client, const void *asked,
                         struct pccd_step_settings *settings)
{
    *settings = (struct pccd_step_settings)PCCD_STEP_SETTINGS_INIT;
    return asked == NULL ? 0
                         : cli_struct_read(client, "settings of the step", asked,
                                           settings, sizeof *settings);
}

/* Read settings of what is near; NULL: the defaults. */
static int read_near_settings(struct pccd_client *client, const void *asked,
                              struct pccd_near_settings *settings)
{
    *settings = (struct pccd_near_settings)PCCD_NEAR_SETTINGS_INIT;
    return asked == NULL ? 0
                         : cli_struct_read(client, "settings of scene.near", asked,
                                           settings, sizeof *settings);
}

/* Read the joints of the settings of a verb, which a frame and a batch do not have. */
static int read_joints(struct pccd_client *client, int verb, const void *asked,
                       bool may_have, struct cli_joints *joints)
{
    struct pccd_step_settings step = {.joints = NULL};
    struct pccd_near_settings near = {.joints = NULL};
    bool is_near = verb == PROTO_METHOD_SCENE_NEAR;
    int status = is_near ? read_near_settings(client, asked, &near)
                         : read_settings(client, asked, &step);

    *joints = is_near ? (struct cli_joints){near.joints, near.joint_count}
                      : (struct cli_joints){step.joints, step.joint_count};
    if (status == 0 && joints->count > 0 && (joints->items == NULL || !may_have)) {
        status = cli_fail(client, PCCD_E_INVAL, "joints: %s",
                          may_have ? "NULL, and some are counted"
                                   : "a frame has them by pccd_frame_joints, and a batch "
                                     "none");
    }
    return status;
}

static int describe_step(struct pccd_client *client, const void *asked, uint32_t scene,
                         struct proto_FRAME_SUBMIT_request *message)
{
    struct pccd_step_settings settings;
    int status = read_settings(client, asked, &settings);

    if (status != 0) {
        return status;
    }
    *message = (struct proto_FRAME_SUBMIT_request){.scene = scene,
                                                   STEP_MESSAGE(settings),
                                                   .hold = settings.hold,
                                                   .tells_start = settings.tells_start};
    if (settings.tuning != NULL) {
        status = put_tuning(client, settings.tuning, message->tuning);
    }
    return status;
}

/* As of a step, but for what waits for others, or has no place in a scene's answer. */
static int describe_batch(struct pccd_client *client, const void *asked,
                          struct proto_BATCH_SUBMIT_request *message)
{
    struct proto_FRAME_SUBMIT_request step;
    struct cli_joints none;
    int status = read_joints(client, PROTO_METHOD_BATCH_SUBMIT, asked, false, &none);

    status = status != 0 ? status : describe_step(client, asked, 0, &step);
    if (status == 0 && step.hold) {
        status = cli_fail(client, PCCD_E_INVAL, "hold: a batch waits for nobody");
    }
    if (status == 0 && step.tells_start) {
        status = cli_fail(client, PCCD_E_INVAL,
                          "tells_start: a batch has no place for what it tells");
    }
    if (status == 0) {
        *message = (struct proto_BATCH_SUBMIT_request){STEP_MESSAGE(step)};
        memcpy(message->tuning, step.tuning, sizeof message->tuning);
    }
    return status;
}

static int describe_near(struct pccd_client *client, const void *asked, uint32_t scene,
                         struct proto_SCENE_NEAR_request *message)
{
    struct pccd_near_settings settings;
    int status = read_near_settings(client, asked, &settings);

    if (status != 0) {
        return status;
    }
    *message =
        (struct proto_SCENE_NEAR_request){.scene = scene,
                                          .what = (uint32_t)settings.what,
                                          .end = settings.at_begin ? 0 : 1,
                                          .distance = settings.distance,
                                          .gap = settings.gap,
                                          .object_a = settings.object_a,
                                          .object_b = settings.object_b,
                                          .method = (uint32_t)settings.method,
                                          .threads = settings.threads,
                                          .deadline_ns = settings.deadline_ns,
                                          .tells_crossings = settings.tells_crossings};
    return put_tuning(client, settings.tuning, message->tuning);
}

int cli_step_describe(struct pccd_client *client, int verb, const void *settings,
                      uint32_t scene, union cli_params *message)
{
    switch (verb) {
    case PROTO_METHOD_FRAME_SUBMIT:
        return describe_step(client, settings, scene, &message->FRAME_SUBMIT);
    case PROTO_METHOD_SCENE_NEAR:
        return describe_near(client, settings, scene, &message->SCENE_NEAR);
    default:
        assert(verb == PROTO_METHOD_BATCH_SUBMIT);
        return describe_batch(client, settings, &message->BATCH_SUBMIT);
    }
}

/* ---- sending ----------------------------------------------------------------------- */

int cli_step_check(struct pccd_client *client)
{
    uint32_t count = 0;
    int status;

    for (uint32_t i = 0; i < client->calls_end; i++) {
        const struct cli_call *call = &client->calls[i];

        count += call->step != 0 &&
                 (call->state == CLI_CALL_SENT || call->state == CLI_CALL_DONE);
    }
    if (count >= CLI_STEPS) {
        return cli_fail(client, PCCD_E_BUSY, "%u steps wait to be taken: poll or wait",
                        count);
    }
    status = cli_page_check(client);
    return status != 0 ? status : cli_alive(client);
}

/* Give a message its number, and the slot that is begun, which is the daemon's then.
 * Returns how many steps it numbers: every scene of a batch has one of its own. */
static uint32_t publish(struct pccd_client *client, int verb, union cli_params *message,
                        uint32_t slot)
{
    bool moves = slot != CLI_SLOT_NONE;
    uint32_t segments = moves ? client->ring.slots[slot].segment_count : 0;
    uint64_t seq = moves ? cli_slot_publish(&client->ring, slot) : 0;

#define PUT(to)                                                                          \
    do {                                                                                 \
        (to).step = client->next_step;                                                   \
        (to).slot = moves ? slot : 0;                                                    \
        (to).segments = segments;                                                        \
        (to).seq = seq;                                                                  \
    } while (0)
    switch (verb) {
    case PROTO_METHOD_FRAME_SUBMIT:
        PUT(message->FRAME_SUBMIT);
        return 1;
    case PROTO_METHOD_SCENE_NEAR:
        PUT(message->SCENE_NEAR);
        return 1;
    default:
        PUT(message->BATCH_SUBMIT);
        message->BATCH_SUBMIT.scenes = client->ring.slots[slot].scene_count;
        return message->BATCH_SUBMIT.scenes;
    }
#undef PUT
}

int cli_step_send(struct pccd_client *client, int verb, union cli_params *message,
                  uint32_t slot, uint64_t *step)
{
    uint32_t steps = publish(client, verb, message, slot);
    struct cli_call *call = NULL;
    int status =
        cli_call_send(client, verb, message, slot, cli_deadline(client, -1), &call);

    if (status != 0) {
        if (slot != CLI_SLOT_NONE) {
            cli_slot_abort(&client->ring, slot);
        }
        return status;
    }
    assert(call->step == 0 && client->next_step > 0);
    call->step = client->next_step;
    *step = client->next_step;
    client->next_step += steps;
    if (client->recorder != NULL) {
        cli_record_frame(client, call);
    }
    return 0;
}

/* ---- one scene --------------------------------------------------------------------- */

/* The question of a caller about a scene. */
struct asked {
    int verb;             /* of one scene: FRAME_SUBMIT or SCENE_NEAR */
    const void *settings; /* that go with it; NULL: the defaults */
    uint32_t scene;
    const struct pccd_motion *motions;
    uint32_t motion_count; /* 0: nothing moves */
};

static int submit(struct pccd_client *client, const struct asked *asked, uint64_t *step)
{
    uint32_t slot = CLI_SLOT_NONE;
    struct cli_joints joints = {NULL, 0};
    union cli_params message;
    int status;

    if (step == NULL || (asked->motions == NULL && asked->motion_count > 0)) {
        return cli_fail(client, PCCD_E_INVAL, "%s is NULL",
                        step == NULL ? "step" : "motions");
    }
    status =
        cli_step_describe(client, asked->verb, asked->settings, asked->scene, &message);
    status = status != 0
                 ? status
                 : read_joints(client, asked->verb, asked->settings, true, &joints);
    if (status == 0 && asked->motion_count > 0) {
        status = cli_frame_write(client, asked->scene, asked->motions,
                                 asked->motion_count, joints, &slot);
    } else if (status == 0) {
        status = cli_ring_ensure(client);
        status = status != 0 ? status : cli_step_check(client);
    }
    return status != 0 ? status
                       : cli_step_send(client, asked->verb, &message, slot, step);
}

static int submit_and_wait(struct pccd_client *client, const struct asked *asked,
                           struct pccd_answer *answer)
{
    uint64_t step = 0;
    int status = cli_answer_check(client, answer, false);

    status = status != 0 ? status : submit(client, asked, &step);
    return status != 0 ? status : cli_answer_finish(client, step, false, answer);
}

/* Send what a frame moves, which is over then. */
static int commit(struct pccd_frame *frame, int verb, const void *settings,
                  uint64_t *step)
{
    struct pccd_client *client = frame->client;
    uint32_t scene = 0;
    uint32_t slot = CLI_SLOT_NONE;
    struct cli_joints none;
    union cli_params message;
    int status = cli_frame_take(frame, step, &scene, &slot);

    if (status != 0) {
        return status;
    }
    status = read_joints(client, verb, settings, false, &none);
    status =
        status != 0 ? status : cli_step_describe(client, verb, settings, scene, &message);
    if (status != 0) {
        cli_slot_abort(&client->ring, slot);
        return status;
    }
    return cli_step_send(client, verb, &message, slot, step);
}

#define STEP_OF(settings, scene, motions, count)                                         \
    &(const struct asked)                                                                \
    {                                                                                    \
        PROTO_METHOD_FRAME_SUBMIT, settings, scene, motions, count                       \
    }
#define NEAR_OF(settings, scene, motions, count)                                         \
    &(const struct asked)                                                                \
    {                                                                                    \
        PROTO_METHOD_SCENE_NEAR, settings, scene, motions, count                         \
    }

int pccd_submit(struct pccd_client *client, uint32_t scene,
                const struct pccd_motion *motions, uint32_t motion_count,
                const struct pccd_step_settings *settings, uint64_t *step)
{
    CLI_ENTER_OR_RETURN(client);
    return submit(client, STEP_OF(settings, scene, motions, motion_count), step);
}

int pccd_submit_still(struct pccd_client *client, uint32_t scene,
                      const struct pccd_step_settings *settings, uint64_t *step)
{
    CLI_ENTER_OR_RETURN(client);
    return submit(client, STEP_OF(settings, scene, NULL, 0), step);
}

int pccd_submit_near(struct pccd_client *client, uint32_t scene,
                     const struct pccd_motion *motions, uint32_t motion_count,
                     const struct pccd_near_settings *settings, uint64_t *step)
{
    CLI_ENTER_OR_RETURN(client);
    return submit(client, NEAR_OF(settings, scene, motions, motion_count), step);
}

int pccd_frame_commit(struct pccd_frame *frame, const struct pccd_step_settings *settings,
                      uint64_t *step)
{
    CLI_ENTER_OR_RETURN(frame != NULL ? frame->client : NULL);
    return commit(frame, PROTO_METHOD_FRAME_SUBMIT, settings, step);
}

int pccd_frame_commit_near(struct pccd_frame *frame,
                           const struct pccd_near_settings *settings, uint64_t *step)
{
    CLI_ENTER_OR_RETURN(frame != NULL ? frame->client : NULL);
    return commit(frame, PROTO_METHOD_SCENE_NEAR, settings, step);
}

int pccd_step(struct pccd_client *client, uint32_t scene,
              const struct pccd_motion *motions, uint32_t motion_count,
              const struct pccd_step_settings *settings, struct pccd_answer *answer)
{
    CLI_ENTER_OR_RETURN(client);
    return submit_and_wait(client, STEP_OF(settings, scene, motions, motion_count),
                           answer);
}

int pccd_ask_near(struct pccd_client *client, uint32_t scene,
                  const struct pccd_motion *motions, uint32_t motion_count,
                  const struct pccd_near_settings *settings, struct pccd_answer *answer)
{
    CLI_ENTER_OR_RETURN(client);
    return submit_and_wait(client, NEAR_OF(settings, scene, motions, motion_count),
                           answer);
}

int pccd_step_x1(struct pccd_client *client, uint32_t scene, uint32_t object,
                 const void *x1, enum pccd_format format, uint32_t vertex_count,
                 const struct pccd_step_settings *settings, struct pccd_answer *answer)
{
    const struct pccd_motion motion = {
        .object = object, .count = vertex_count, .format = format, .x1 = x1};

    CLI_ENTER_OR_RETURN(client);
    if (x1 == NULL) {
        return cli_fail(client, PCCD_E_INVAL, "x1 is NULL");
    }
    return submit_and_wait(client, STEP_OF(settings, scene, &motion, 1), answer);
}

int pccd_step_x0x1(struct pccd_client *client, uint32_t scene, uint32_t object,
                   const void *x0, const void *x1, enum pccd_format format,
                   uint32_t vertex_count, const struct pccd_step_settings *settings,
                   struct pccd_answer *answer)
{
    const struct pccd_motion motion = {
        .object = object, .count = vertex_count, .format = format, .x0 = x0, .x1 = x1};

    CLI_ENTER_OR_RETURN(client);
    if (x0 == NULL || x1 == NULL) {
        return cli_fail(client, PCCD_E_INVAL, "%s is NULL", x0 == NULL ? "x0" : "x1");
    }
    return submit_and_wait(client, STEP_OF(settings, scene, &motion, 1), answer);
}

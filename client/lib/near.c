/* near.c - ask what is near. */
#include <string.h>

#include "attach.h"
#include "client.h"
#include "connection.h"
#include "frame.h"
#include "step.h"
#include "submit.h"

/* Whether it can be asked at all, and the settings of a program that may know a later
 * struct. NULL: the defaults. */
static int read_settings(struct pccd_client *client,
                         const struct pccd_near_settings *asked,
                         struct pccd_near_settings *settings)
{
    const struct pccd_near_settings defaults = PCCD_NEAR_SETTINGS_INIT;
    int status;

    if ((client->link.features & PROTO_FEATURE_NEAR) == 0) {
        return cli_fail(client, PCCD_E_VERSION,
                        "scene.near: the daemon at %s is older than this", client->url);
    }
    status =
        cli_struct_read(client, "settings of scene.near",
                        asked != NULL ? asked : &defaults, settings, sizeof *settings);
    if (status == 0 && settings->tells_crossings) {
        status = cli_check_tells(client, "scene.near");
    }
    if (status == 0 &&
        strnlen(settings->tuning, PCCD_TUNING_BYTES) == PCCD_TUNING_BYTES) {
        return cli_fail(client, PCCD_E_INVAL, "tuning: longer than %d bytes",
                        PCCD_TUNING_BYTES - 1);
    }
    return status;
}

/* A `slot` that is begun is published with it, as cli_step_send does. */
static int send_near(struct pccd_client *client, uint32_t scene, uint32_t slot,
                     const struct pccd_near_settings *settings, uint64_t *step)
{
    struct proto_SCENE_NEAR_request request = {.scene = scene,
                                               .what = (uint32_t)settings->what,
                                               .end = settings->end,
                                               .distance = settings->distance,
                                               .gap = settings->gap,
                                               .object_a = settings->object_a,
                                               .object_b = settings->object_b,
                                               .method = (uint32_t)settings->method,
                                               .threads = settings->threads,
                                               .deadline_ns = settings->deadline_ns,
                                               .step = client->next_step,
                                               .tells_crossings =
                                                   settings->tells_crossings};

    memcpy(request.tuning, settings->tuning, sizeof settings->tuning);
    if (slot != CLI_SLOT_NONE) {
        request.slot = slot;
        request.segments = client->ring.slots[slot].segment_count;
        request.seq = cli_slot_publish(&client->ring, slot);
    }
    return cli_step_call(client, PROTO_METHOD_SCENE_NEAR, &request, slot, step);
}

int pccd_submit_near(struct pccd_client *client, uint32_t scene,
                     const struct pccd_motion *motions, uint32_t motion_count,
                     const struct pccd_near_settings *settings, uint64_t *step)
{
    struct pccd_near_settings known;
    uint32_t slot = CLI_SLOT_NONE;
    int status;

    CLI_ENTER_OR_RETURN(client);
    if (step == NULL || (motions == NULL && motion_count > 0)) {
        return cli_fail(client, PCCD_E_INVAL, "%s is NULL",
                        step == NULL ? "step" : "motions");
    }
    status = read_settings(client, settings, &known);
    if (status == 0 && motion_count > 0) {
        status = cli_frame_write(client, scene, motions, motion_count, &slot);
    } else if (status == 0) {
        status = cli_ring_ensure(client);
        status = status != 0 ? status : cli_step_check(client);
    }
    return status != 0 ? status : send_near(client, scene, slot, &known, step);
}

int pccd_frame_commit_near(struct pccd_frame *frame,
                           const struct pccd_near_settings *settings, uint64_t *step)
{
    struct pccd_near_settings known;
    struct pccd_client *client = frame != NULL ? frame->client : NULL;
    uint32_t scene = 0;
    uint32_t slot = CLI_SLOT_NONE;
    int status;

    CLI_ENTER_OR_RETURN(client);
    status = cli_frame_take(frame, step, &scene, &slot);
    if (status != 0) {
        return status;
    }
    status = read_settings(client, settings, &known);
    if (status != 0) {
        cli_slot_abort(&client->ring, slot);
        return status;
    }
    return send_near(client, scene, slot, &known, step);
}

int pccd_ask_near(struct pccd_client *client, uint32_t scene,
                  const struct pccd_motion *motions, uint32_t motion_count,
                  const struct pccd_near_settings *settings, struct pccd_answer *answer)
{
    uint64_t step = 0;
    int status;

    CLI_ENTER_OR_RETURN(client);
    status = cli_answer_check(client, answer);
    if (status == 0) {
        status = pccd_submit_near(client, scene, motions, motion_count, settings, &step);
    }
    return status != 0 ? status : cli_step_finish(client, step, answer);
}

/* submit.c - send a step whose positions, if it has any, are written. */
#include "submit.h"

#include <assert.h>
#include <string.h>

#include "attach.h"
#include "client.h"
#include "connection.h"
#include "recorder.h"
#include "rpc.h"

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

int cli_step_settings(struct pccd_client *client, const struct pccd_step_settings *asked,
                      struct pccd_step_settings *settings)
{
    int status;

    *settings = (struct pccd_step_settings){.struct_bytes = sizeof *settings};
    if (asked == NULL) {
        return 0;
    }
    status = cli_struct_read(client, "settings of the step", asked, settings,
                             sizeof *settings);
    if (status == 0 && settings->tuning != NULL &&
        strnlen(settings->tuning, PCCD_TUNING_BYTES) == PCCD_TUNING_BYTES) {
        return cli_fail(client, PCCD_E_INVAL, "tuning: longer than %d bytes",
                        PCCD_TUNING_BYTES - 1);
    }
    if (status == 0 && (settings->separation != 0.0 || settings->approach != 0.0)) {
        status = cli_check_thick(client, "frame.submit");
    }
    if (status == 0 && settings->tells_start) {
        status = cli_check_tells(client, "frame.submit");
    }
    return status;
}

int cli_step_call(struct pccd_client *client, int method, const void *request,
                  uint32_t slot, uint64_t *step)
{
    struct cli_call *call = NULL;
    int status =
        cli_call_send(client, method, request, slot, cli_deadline(client, -1), &call);

    if (status != 0) {
        if (slot != CLI_SLOT_NONE) {
            cli_slot_abort(&client->ring, slot);
        }
        return status;
    }
    assert(call->step == 0 && client->next_step > 0);
    call->step = client->next_step;
    *step = client->next_step;
    /* Every scene of a batch has a step of its own. */
    client->next_step +=
        method == PROTO_METHOD_BATCH_SUBMIT ? call->params.BATCH_SUBMIT.scenes : 1;
    if (client->recorder != NULL) {
        cli_record_frame(client, call);
    }
    return 0;
}

int cli_step_send(struct pccd_client *client, uint32_t scene, uint32_t slot,
                  const struct pccd_step_settings *asked, uint64_t *step)
{
    struct pccd_step_settings settings;
    struct proto_FRAME_SUBMIT_request request = {.scene = scene,
                                                 .step = client->next_step};
    int status = cli_step_settings(client, asked, &settings);

    if (status == 0) {
        request.mode = (uint32_t)settings.mode;
        request.method = (uint32_t)settings.method;
        request.threads = settings.threads;
        if (settings.tuning != NULL) {
            memcpy(request.tuning, settings.tuning, strlen(settings.tuning));
        }
        request.tolerance = settings.tolerance;
        request.deadline_ns = settings.deadline_ns;
        request.hold = settings.hold;
        request.separation = settings.separation;
        request.approach = settings.approach;
        request.tells_start = settings.tells_start;
    }
    if (status == 0 && slot != CLI_SLOT_NONE) {
        request.slot = slot;
        request.segments = client->ring.slots[slot].segment_count;
        request.seq = cli_slot_publish(&client->ring, slot);
    }
    if (status != 0 && slot != CLI_SLOT_NONE) {
        cli_slot_abort(&client->ring, slot);
    }
    return status != 0
               ? status
               : cli_step_call(client, PROTO_METHOD_FRAME_SUBMIT, &request, slot, step);
}

int pccd_submit_still(struct pccd_client *client, uint32_t scene,
                      const struct pccd_step_settings *settings, uint64_t *step)
{
    int status;

    CLI_ENTER_OR_RETURN(client);
    if (step == NULL) {
        return cli_fail(client, PCCD_E_INVAL, "step is NULL");
    }
    status = cli_ring_ensure(client);
    status = status != 0 ? status : cli_step_check(client);
    if (status != 0) {
        return status;
    }
    return cli_step_send(client, scene, CLI_SLOT_NONE, settings, step);
}

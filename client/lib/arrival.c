/* arrival.c - who is told of what has arrived from the daemon. */
#include "arrival.h"

#include "keep.h"
#include "near_number.h"
#include "page.h"
#include "positions.h"
#include "recorder_events.h"
#include "rpc.h"
#include "shared.h"
#include "watch.h"

void cli_arrival_answered(struct pccd_client *client, struct cli_call *call)
{
    if (call->status == 0 && !call->recovery) {
        cli_keep_answer(client, call);
        if (client->keeps && cli_call_is_step(call->method) &&
            call->slot != CLI_SLOT_NONE) {
            if (call->method == PROTO_METHOD_BATCH_SUBMIT) {
                cli_positions_leave_out(client, call->slot,
                                        cli_batch_answers(client, call));
            }
            cli_positions_answered(client, call->slot, call->step);
        }
        if (call->method == PROTO_METHOD_SCENE_NEAR) {
            cli_near_answered(client, &call->params.SCENE_NEAR);
        }
    }
    if (client->recorder != NULL) {
        cli_record_answer(client, call);
    }
}

void cli_arrival_notified(struct pccd_client *client,
                          const struct proto_envelope *envelope)
{
    switch (envelope->method) {
    case PROTO_NOTE_SCENE_STEP:
        cli_shared_note(client, envelope);
        break;
    case PROTO_NOTE_SCENE_HELD:
        cli_shared_held(client, envelope);
        break;
    case PROTO_NOTE_STEP:
        cli_watch_take(client, envelope);
        break;
    default: /* of a newer protocol */
        break;
    }
}
